"""Many trials of many scenarios, on any executor; what a trial yields depends on scenario, seed and number alone."""

import pickle
import threading
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from scipy.stats import binomtest

from frontal_biped.exceptions import ScenarioError
from frontal_biped.files.atomic import require_folder
from frontal_biped.scenarios.preparation import Prepared, prepare
from frontal_biped.scenarios.run import OnStep, TrialResult, run_trial
from frontal_biped.scenarios.scenario import Scenario
from frontal_biped.simulation.space.run import SpatialRun, save_spatial_run
from frontal_biped.simulation.trajectory import save_trajectory

CONFIDENCE = 0.95
"""Of the interval of the survival rate."""

POLL = 0.5  # [s] between two looks at what has been finished

OnTrial = Callable[[int, int, TrialResult], None]


class Survival(NamedTuple):
    """How many trials passed.

    Attributes:
        passed: trials in which every expectation held.
        trials: in all.
        low: lower end of the Wilson interval of the rate at `CONFIDENCE` [-].
        high: its upper end [-].
    """

    passed: int
    trials: int
    low: float
    high: float

    @property
    def rate(self) -> float:
        """Share that passed [-]."""
        return self.passed / self.trials


def survival(passed: int, trials: int) -> Survival:
    """Rate with its Wilson interval; it stays inside [0, 1], and 100 of 100 does not claim certainty."""
    interval = binomtest(passed, trials).proportion_ci(CONFIDENCE, method="wilson")
    return Survival(passed, trials, float(interval.low), float(interval.high))


@dataclass(frozen=True, eq=False)
class ScenarioResult:
    """All trials of one scenario.

    Attributes:
        scenario: what was asked.
        results: of the trials, in order.
    """

    scenario: Scenario
    results: tuple[TrialResult, ...]

    @property
    def survival(self) -> Survival:
        """How many passed."""
        return survival(sum(result.passed for result in self.results), len(self.results))

    @property
    def passed(self) -> bool:
        """Did the share of the trials pass that the scenario expects?"""
        return self.survival.rate >= self.scenario.expect.survival

    @property
    def seconds(self) -> float:
        """Wall time of all trials together [s]."""
        return sum(result.seconds for result in self.results)

    def worst(self, key: str) -> float:
        """Largest size of a measure over the trials; nan where there was nothing to measure."""
        values = [abs(result.measured[key]) for result in self.results]
        return max(values, key=lambda value: (value == value, value))

    def least(self, key: str) -> float:
        """Smallest value of a measure over the trials; nan where there was nothing to measure."""
        values = [result.measured[key] for result in self.results]
        return min(values, key=lambda value: (value == value, value))

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "scenario": self.scenario.name,
            "file": str(self.scenario.path),
            "simulator": self.scenario.simulator,
            "seed": self.results[0].seed,
            "passed": self.passed,
            "survival": {**self.survival._asdict(), "rate": self.survival.rate, "confidence": CONFIDENCE},
            "trials": [result.as_dict() for result in self.results],
        }


def run_trials(
    scenarios: Sequence[Scenario],
    *,
    repeat: int | None = None,
    seed: int | None = None,
    numbers: Sequence[int] | None = None,
    executor: Executor | None = None,
    save: Path | None = None,
    on_trial: OnTrial | None = None,
    on_step: OnStep | None = None,
) -> tuple[ScenarioResult, ...]:
    """Run trials of scenarios.

    Args:
        scenarios: from `load_scenario`.
        repeat: trials of each; default: what the scenario says.
        seed: of all trials; default: the scenario's.
        numbers: only these trials, from 0, instead of the first ``repeat`` ones.
        executor: any `concurrent.futures.Executor` whose workers see the robot and gait files. Default: one trial after
            another in this process.
        save: folder to which every trial writes its run file, ``NAME-NUMBER.npz``.
        on_trial: called with trials finished, trials in all, and the result of the last.
        on_step: called with the number of completed steps; without an executor only.

    Returns:
        One result for each scenario, in order; the runs themselves are not kept.

    Raises:
        ScenarioError: as `run_scenario`; before the first trial where that can be known. Or a worker is lost.
    """
    if save is not None:
        require_folder(save)
        save.mkdir(parents=True, exist_ok=True)
    refuse_equal_names(scenarios)
    prepared = [prepare(scenario) for scenario in scenarios]
    tasks = [
        (i, number)
        for i, scenario in enumerate(scenarios)
        for number in (range(repeat or scenario.repeat) if numbers is None else numbers)
    ]
    found: dict[tuple[int, int], TrialResult] = {}

    def finish(task: tuple[int, int], result: TrialResult) -> None:
        found[task] = result
        if on_trial is not None:
            on_trial(len(found), len(tasks), result)

    if executor is None:
        for i, number in tasks:
            finish((i, number), _trial(prepared[i], number, seed, save, on_step))
    else:
        futures = {
            executor.submit(_trial_elsewhere, pickle.dumps(scenarios[i]), number, seed, save): (i, number)
            for i, number in tasks
        }
        try:
            for future in _as_completed(futures):
                finish(futures[future], future.result())
        except BrokenExecutor:
            raise ScenarioError(
                f"{', '.join(str(scenario.path) for scenario in scenarios)}: a worker ended before its trial, killed,"
                " out of memory, or ended by the controller; run it again, in one process to see which trial it is"
            ) from None
    return tuple(
        ScenarioResult(scenario, tuple(found[task] for task in tasks if task[0] == i))
        for i, scenario in enumerate(scenarios)
    )


def refuse_equal_names(scenarios: Sequence[Scenario]) -> None:
    """Raise `ScenarioError` if two scenarios have one name: reports and run files are told apart by it."""
    seen: dict[str, Path] = {}
    for scenario in scenarios:
        if scenario.name in seen:
            raise ScenarioError(
                f"{scenario.path}: name = {scenario.name!r}: {seen[scenario.name]} has it too; give it another one"
            )
        seen[scenario.name] = scenario.path


def _as_completed(futures: Iterable[Future[TrialResult]]) -> Iterable[Future[TrialResult]]:
    """The futures as they finish; all are cancelled when one fails or the caller stops."""
    waiting = set(futures)
    try:
        while waiting:
            done, waiting = wait(waiting, timeout=POLL, return_when=FIRST_COMPLETED)
            yield from done
    finally:
        for future in waiting:
            future.cancel()


def _trial(
    prepared: Prepared, number: int, seed: int | None, save: Path | None, on_step: OnStep | None = None
) -> TrialResult:
    result = run_trial(prepared, number, seed, on_step=on_step)
    if save is not None and result.run is not None:
        path = save / f"{prepared.scenario.name}-{number}.npz"
        if isinstance(result.run, SpatialRun):
            save_spatial_run(result.run, path)
        else:
            save_trajectory(result.run, path)
    return replace(result, run=None)


def _trial_elsewhere(scenario: bytes, number: int, seed: int | None, save: Path | None) -> TrialResult:
    """What a worker runs; the scenario comes pickled, so that equal ones are known to be equal."""
    return _trial(_prepared(scenario, threading.get_ident()), number, seed, save)


@lru_cache(maxsize=128)
def _prepared(scenario: bytes, thread: int) -> Prepared:
    """A scenario made ready by and for one thread of a worker."""
    return prepare(pickle.loads(scenario))
