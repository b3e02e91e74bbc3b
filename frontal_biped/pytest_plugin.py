"""A pytest plugin: ``*.scenario.toml`` files are tests where that is wanted, and the fixture `trial` runs one.

A scenario may name a Python module, which runs with it, so a project says that its scenarios are tests::

    [tool.pytest.ini_options]
    frontal_biped_scenarios = true

or, for one run, ``pytest --scenarios``. A scenario file that is named on the command line is a test anyway. Otherwise
the plugin, which comes with the package, leaves a project as it is, and imports nothing but pytest until a scenario
runs; ``-p no:frontal_biped`` leaves it out altogether. The fixture is there with or without the setting:

    def test_my_controller_survives_a_push(trial):
        result = trial("push.scenario.toml", controller=MyController)
        assert result.measured["torque"] < 0.8
"""

import tomllib
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from frontal_biped.scenarios.monte_carlo import ScenarioResult
    from frontal_biped.scenarios.run import TrialResult

SUFFIX = ".scenario.toml"

SETTING = "frontal_biped_scenarios"
"""In the configuration of pytest: are scenario files tests?"""

MOST_TOLD = 3
"""Failed trials that a failure describes in full."""


class ExpectationsFailedError(AssertionError):
    """A scenario is not as expected; the message is the report."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Options of scenarios."""
    group = parser.getgroup("frontal-biped", "scenarios of frontal-biped")
    parser.addini(SETTING, "collect *.scenario.toml files, and run the modules that they name", "bool", default=False)
    group.addoption("--scenarios", action="store_true", help=f"collect scenario files, as {SETTING} = true does")
    group.addoption("--scenario-repeat", type=int, metavar="N", help="trials of each scenario that draws anything")
    group.addoption("--scenario-seed", type=int, metavar="S", help="seed of all scenarios")
    group.addoption("--scenario-save", type=Path, metavar="DIR", help="keep a run file of every trial, for `view`")


def pytest_configure(config: pytest.Config) -> None:
    """Markers, also for --strict-markers."""
    config.addinivalue_line("markers", "scenario: a scenario file of frontal-biped")
    if not any(line.split(":")[0].strip() == "slow" for line in config.getini("markers")):
        config.addinivalue_line("markers", "slow: takes more than a few seconds")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collect scenario files where the project or the command line asks for it."""
    if not file_path.name.endswith(SUFFIX):
        return None
    config = parent.config
    if not (config.getini(SETTING) or config.getoption("--scenarios") or parent.session.isinitpath(file_path)):
        return None
    collector: pytest.Collector = ScenarioFile.from_parent(parent, path=file_path)
    return collector


class ScenarioFile(pytest.File):
    """A scenario file."""

    def collect(self) -> Iterable["ScenarioItem"]:
        """One test; what is wrong in the file is told when it runs."""
        item: ScenarioItem = ScenarioItem.from_parent(self, name=self.path.name.removesuffix(SUFFIX))
        item.add_marker("scenario")
        try:
            slow = tomllib.loads(self.path.read_text(encoding="utf-8")).get("slow")
        except (tomllib.TOMLDecodeError, UnicodeDecodeError, OSError, RecursionError):
            slow = False
        if slow is True:
            item.add_marker("slow")
        yield item


class ScenarioItem(pytest.Item):
    """All trials of a scenario."""

    def runtest(self) -> None:
        """Walk, and fail unless all expectations hold."""
        from frontal_biped.scenarios.file import load_scenario
        from frontal_biped.scenarios.monte_carlo import run_trials
        from frontal_biped.scenarios.report import table

        option = self.config.getoption
        scenario = load_scenario(self.path)
        (result,) = run_trials(
            [scenario],
            repeat=option("--scenario-repeat") if scenario.random else None,
            seed=option("--scenario-seed"),
            save=option("--scenario-save"),
        )
        self.user_properties.append(("survival", f"{result.survival.passed}/{result.survival.trials}"))
        if not result.passed:
            raise ExpectationsFailedError(_explain(result))
        self.add_report_section("call", "scenario", table([result]))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """The report or the one-line complaint; a traceback only for what nobody foresaw."""
        from frontal_biped.exceptions import FrontalBipedError

        if isinstance(excinfo.value, ExpectationsFailedError | FrontalBipedError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Where the test is."""
        return self.path, None, f"scenario {self.name}"


@pytest.fixture
def trial(request: pytest.FixtureRequest) -> "Callable[..., TrialResult]":
    """Run a scenario: ``trial("push.scenario.toml", controller=MyController)``.

    Called with the path of a scenario file, relative to the test's own, and the keyword arguments of `run_scenario`.
    The test fails, with a report, if an expectation does not hold, unless ``check=False`` is given. Returns the
    `TrialResult`; its ``run`` holds what was recorded.
    """

    def run(path: Path | str, *, check: bool = True, **arguments: Any) -> "TrialResult":
        from frontal_biped.exceptions import FrontalBipedError
        from frontal_biped.scenarios.file import load_scenario
        from frontal_biped.scenarios.run import run_scenario

        __tracebackhide__ = True
        try:
            result = run_scenario(load_scenario(request.path.parent / path), **arguments)
        except FrontalBipedError as error:
            pytest.fail(str(error), pytrace=False)
        if check and not result.passed:
            pytest.fail(str(result), pytrace=False)
        return result

    return run


def _explain(result: "ScenarioResult") -> str:
    survived, scenario = result.survival, result.scenario
    share = scenario.expect.survival
    wanted = "all" if share == 1.0 else f"a share of {share:g}"
    failed = [trial for trial in result.results if not trial.passed]
    lines = [f"{scenario.path.name}: {survived.passed} of {survived.trials} trials passed, expected {wanted}"]
    lines += [str(trial) for trial in failed[:MOST_TOLD]]
    if len(failed) > MOST_TOLD:
        lines.append(f"... and {len(failed) - MOST_TOLD} more")
    first = failed[0]
    again = f"frontal-biped trial {scenario.path} --seed {first.seed} --only {first.number} --save runs"
    return "\n".join([*lines, f"again, and to be watched: {again}"])
