"""`frontal-biped trial`: run scenarios, the verdict first, exit 0 only if all expectations hold."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from frontal_biped.cli.arguments import add_jobs, add_json, add_verbose, file_ending, folder, positive_int, whole_number
from frontal_biped.cli.exit_status import SUCCESS, TASK_FAILED
from frontal_biped.cli.output import emit, report, require_output
from frontal_biped.cli.progress import Progress

if TYPE_CHECKING:
    from frontal_biped.scenarios.run import TrialResult

SUMMARY = "Run scenarios: disturbed walks with expectations; exit status 1 if one does not hold."
EXAMPLE = "frontal-biped trial examples/scenarios/wrong_masses.scenario.toml --repeat 4 --seed 1 --save runs"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Scenarios, which trials of them, where to write, how to print."""
    parser.add_argument("scenarios", metavar="SCENARIO.toml", type=Path, nargs="+", help="scenario files")
    parser.add_argument("--repeat", metavar="N", type=positive_int, help="trials of each; default: what its file says")
    parser.add_argument("--seed", metavar="S", type=whole_number, help="of all trials; default: what each file says")
    parser.add_argument("--only", metavar="K", type=whole_number, help="only trial K, from 0, of each scenario")
    add_jobs(parser)
    parser.add_argument("--junit", metavar="FILE.xml", type=file_ending(".xml"), help="write JUnit XML")
    parser.add_argument(
        "--save", metavar="DIR", type=folder, help="keep a run file of every trial, for `view` and `plot`"
    )
    shown = parser.add_mutually_exclusive_group()
    shown.add_argument("--markdown", action="store_true", help="print the table as Markdown")
    add_json(shown)
    add_verbose(parser)


def run(arguments: argparse.Namespace) -> int:
    """Read all scenarios first, so that a bad one is told before the first step is walked."""
    from contextlib import redirect_stdout
    from dataclasses import replace

    from frontal_biped.cli.workers import workers
    from frontal_biped.exceptions import ScenarioError
    from frontal_biped.files.atomic import require_folder
    from frontal_biped.scenarios.file import load_scenario
    from frontal_biped.scenarios.monte_carlo import run_trials
    from frontal_biped.scenarios.report import markdown, table, verdict, write_junit

    scenarios = [load_scenario(path) for path in arguments.scenarios]
    if arguments.repeat is not None:
        for scenario in scenarios:
            if arguments.repeat > 1 and not scenario.random:
                raise ScenarioError(
                    f"{scenario.path}: --repeat {arguments.repeat}: nothing in the scenario is random, all trials would"
                    " be the same; leave --repeat out"
                )
    if arguments.only is not None:
        scenarios = [replace(scenario, expect=replace(scenario.expect, survival=1.0)) for scenario in scenarios]
    gaits = [scenario.gait for scenario in scenarios if isinstance(scenario.gait, Path)]
    require_output(arguments.junit, *arguments.scenarios, *gaits)
    if arguments.save is not None:
        require_folder(arguments.save)
    trials = len(scenarios) if arguments.only is not None else sum(arguments.repeat or s.repeat for s in scenarios)
    with Progress("walking: trial", trials) as progress, workers(min(arguments.jobs, trials)) as executor:
        finished: list[TrialResult] = []

        def on_trial(done: int, total: int, result: "TrialResult") -> None:
            finished.append(result)
            failed = sum(not each.passed for each in finished)
            progress.update(f"{result.scenario}{f', {failed} failed' if failed else ''}", done)

        def on_step(step: int) -> None:
            progress.update(f"step {step}", len(finished))

        progress.update("robot and gait", 0)
        with redirect_stdout(sys.stderr):  # what a controller prints is no part of the report
            results = run_trials(
                scenarios,
                repeat=arguments.repeat,
                seed=arguments.seed,
                numbers=None if arguments.only is None else [arguments.only],
                executor=executor,
                save=arguments.save,
                on_trial=on_trial,
                on_step=on_step,
            )
    passed = all(result.passed for result in results)
    if arguments.junit is not None:
        write_junit(results, arguments.junit)
    written = [str(path) for path in (arguments.junit, arguments.save) if path is not None]
    content = {"passed": passed, "scenarios": [result.as_dict() for result in results], "written": written}
    shown = (
        markdown(results) if arguments.markdown else report(arguments, [verdict(results)], [table(results)], written)
    )
    emit(arguments, content, shown)
    if arguments.save is not None and not arguments.json:
        sys.stderr.write(f"runs in {arguments.save}; watch one with `frontal-biped view {arguments.save}/NAME-0.npz`\n")
    return SUCCESS if passed else TASK_FAILED
