"""What scenarios came to: a verdict and a table for people, Markdown for a README, JUnit XML for integration."""

import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from pathlib import Path

from frontal_biped.files.atomic import write_text
from frontal_biped.files.counted import counted
from frontal_biped.scenarios.expectations import AT_MOST
from frontal_biped.scenarios.monte_carlo import CONFIDENCE, ScenarioResult

MOST_LISTED = 5
"""Failed trials of one scenario that a table names."""

_COLUMNS = (
    "scenario",
    "simulator",
    "steps",
    "trials",
    "passed",
    "output error",
    "step time",
    "torque",
    "F_h/F_v",
    "FRI",
    "",
)
_UNITS = ("", "", "each", "", f"{100 * CONFIDENCE:g} % interval", "rad", "off by", "of limit", "", "mm inside", "")


def verdict(results: Sequence[ScenarioResult]) -> str:
    """Three lines: is all as expected, which bound was nearest, what it needed of the motors."""
    failed = [result for result in results if not result.passed]
    trials, passed = (sum(getattr(result.survival, key) for result in results) for key in ("trials", "passed"))
    scenarios = counted(len(results), "scenario")
    if failed:
        reached = f"FAILED: {len(failed)} of {scenarios}: " + "; ".join(_why(result) for result in failed)
    else:
        reached = f"as expected: {scenarios}, {passed} of {trials} trials passed"
    return "\n".join([reached, f"tightest  {_tightest(results)}", f"motors    {_motors(results)}"])


def _why(result: ScenarioResult) -> str:
    """The first trial of a scenario that failed, and how many did."""
    first = next(trial for trial in result.results if not trial.passed)
    missed = "; ".join(finding.text for finding in first.failures)
    trials = result.survival.trials
    count = "" if trials == 1 else f"{trials - result.survival.passed} of {trials} trials, the first of them "
    return f"{result.scenario.name}, {count}trial {first.number} of seed {first.seed}: {missed}"


def _tightest(results: Sequence[ScenarioResult]) -> str:
    """The upper bound of which most was used; where none is expected, the torque limit."""
    found = []
    for result in results:
        for key, (label, unit) in AT_MOST.items():
            bound = getattr(result.scenario.expect, key)
            if bound:
                value = result.worst(key)
                of = f"{bound:g}{' ' + unit if unit else ''}"
                found.append((value / bound, f"{label} {value:.3g} of {of}", result.scenario.name))
    used = [each for each in found if not math.isnan(each[0])]  # infinite: never back on the orbit
    if not used:
        return _motors(results)
    share, what, name = max(used)
    return f"{what}, {100.0 * share:.0f} %, in {name}"


def _motors(results: Sequence[ScenarioResult]) -> str:
    """The largest shares of the motors' limits over all trials."""
    told = []
    for key, what in (("torque", "torque"), ("joint_speed", "speed")):
        shares = [(result.worst(key), result.scenario.name) for result in results if key in result.results[0].measured]
        shares = [each for each in shares if math.isfinite(each[0])]
        if shares:
            most, name = max(shares)
            told.append(f"{what} {100.0 * most:.0f} % of the limit, in {name}")
    return "; ".join(told) or "nothing was measured"


def table(results: Sequence[ScenarioResult]) -> str:
    """One line a scenario: trials passed with the interval of the rate, the largest measures over all trials, verdict.

    Below it every expectation that did not hold.
    """
    rows = [_COLUMNS, _UNITS, *(_row(result) for result in results)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(_COLUMNS))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    for result in results:
        failed = [trial for trial in result.results if not trial.passed]
        for trial in failed[:MOST_LISTED]:
            why = "; ".join(finding.text for finding in trial.failures)
            lines.append(f"{result.scenario.name}, trial {trial.number} of seed {trial.seed}: {why}")
        if len(failed) > MOST_LISTED:
            lines.append(f"{result.scenario.name}: and {counted(len(failed) - MOST_LISTED, 'more trial')}")
        if failed and result.passed:
            lines.append(f"{result.scenario.name}: that is as expected, survival = {result.scenario.expect.survival:g}")
    return "\n".join(lines)


def markdown(results: Sequence[ScenarioResult]) -> str:
    """The table of a README: what each scenario shows, and what it came to."""
    head = "| scenario | what it is up against | simulator | trials passed | step time off by | torque, of limit |"
    lines = [head, "|---|---|---|---|---|---|"]
    for result in results:
        scenario, row = result.scenario, _row(result)
        cells = (scenario.name, scenario.about, f"{row[1]}, {counted(scenario.steps, 'step')}", row[4], row[6], row[7])
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _row(result: ScenarioResult) -> tuple[str, ...]:
    survived = result.survival
    rate = f"{survived.passed} of {survived.trials}"
    if survived.trials > 1:
        rate += f" ({100 * survived.low:.1f}..{100 * survived.high:.1f} %)"
    return (
        result.scenario.name,
        result.scenario.simulator,
        str(result.scenario.steps),
        str(survived.trials),
        rate,
        f"{result.worst('output_error'):.2g}",
        f"{100 * result.worst('step_time_error'):.2g} %",
        f"{result.worst('torque'):.2f}",
        f"{result.worst('friction'):.2f}",
        f"{1e3 * result.least('fri_margin'):.3g}",
        "as expected" if result.passed else "FAILED",
    )


def write_junit(results: Sequence[ScenarioResult], path: Path) -> None:
    """Write JUnit XML: one test suite a scenario, one test case a trial.

    A scenario that expects only a share of its trials to pass is one test case.
    """
    root = ElementTree.Element("testsuites", name="frontal-biped trial")
    for result in results:
        scenario = result.scenario
        partial = scenario.expect.survival < 1.0
        suite = ElementTree.SubElement(root, "testsuite", name=scenario.name, time=f"{result.seconds:.3f}")
        suite.set("tests", str(1 if partial else len(result.results)))
        failures = 0
        if partial:
            case = ElementTree.SubElement(suite, "testcase", name="survival", classname=scenario.name)
            case.set("time", f"{result.seconds:.3f}")
            text = f"{result.survival.passed} of {result.survival.trials} trials passed"
            if not result.passed:
                failures = 1
                message = f"{text}, expected a share of {scenario.expect.survival:g}"
                ElementTree.SubElement(case, "failure", message=message).text = table([result])
            ElementTree.SubElement(case, "system-out").text = text
        for trial in () if partial else result.results:
            case = ElementTree.SubElement(suite, "testcase", name=f"trial {trial.number}", classname=scenario.name)
            case.set("time", f"{trial.seconds:.3f}")
            if not trial.passed:
                failures += 1
                why = "; ".join(finding.text for finding in trial.failures)
                ElementTree.SubElement(case, "failure", message=why).text = str(trial)
            ElementTree.SubElement(case, "system-out").text = str(trial)
        suite.set("failures", str(failures))
        suite.set("errors", "0")
    ElementTree.indent(root)
    write_text(path, '<?xml version="1.0" encoding="utf-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n")
