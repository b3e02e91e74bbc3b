"""Run one trial of a scenario, in our simulator or in MuJoCo, and judge it."""

import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from frontal_biped.control.interface import Contract
from frontal_biped.exceptions import ControllerError
from frontal_biped.files.shown import html_table
from frontal_biped.gait.file import gait_to_dict
from frontal_biped.scenarios.controllers import Factory, make_controller
from frontal_biped.scenarios.expectations import Finding, judge, measures
from frontal_biped.scenarios.measured import AnyRun
from frontal_biped.scenarios.preparation import Conditions, Prepared, conditions, prepare, trial_seed
from frontal_biped.scenarios.scenario import Scenario
from frontal_biped.scenarios.space_measures import spatial_measures
from frontal_biped.scenarios.space_run import spatial_conditions, spatial_walker, walk_trial
from frontal_biped.scenarios.user_code import folder_kept
from frontal_biped.simulation.event_driven import simulate_walk
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.walking import ENGINES, start_state

OnStep = Callable[[int], None]


@dataclass(frozen=True, eq=False)
class TrialResult:
    """One trial.

    Attributes:
        scenario: name of the scenario.
        number: which of its trials, from 0.
        seed: of the scenario's trials.
        simulator: "ours" or "mujoco".
        outcome: "completed", or what made the robot fall.
        findings: every expectation, met or not.
        measured: see `measures`.
        drawn: numbers drawn for this trial.
        seconds: wall time.
        run: the recorded walk; None in a trial whose run was not kept.
    """

    scenario: str
    number: int
    seed: int
    simulator: str
    outcome: str
    findings: tuple[Finding, ...]
    measured: Mapping[str, float]
    drawn: Mapping[str, float]
    seconds: float
    run: AnyRun | None = None

    @property
    def passed(self) -> bool:
        """Do all expectations hold?"""
        return all(finding.held for finding in self.findings)

    @property
    def failures(self) -> tuple[Finding, ...]:
        """The expectations that do not hold."""
        return tuple(finding for finding in self.findings if not finding.held)

    def __str__(self) -> str:
        drawn = ", ".join(f"{name} = {value:.4g}" for name, value in self.drawn.items())
        head = f"{self.scenario} ({self.simulator}), trial {self.number} of seed {self.seed}"
        lines = [head + (f": {drawn}" if drawn else "")]
        lines += [f"  {'held  ' if finding.held else 'FAILED'}  {finding.text}" for finding in self.findings]
        return "\n".join(lines)

    def __repr__(self) -> str:
        held = sum(finding.held for finding in self.findings)
        return (
            f"TrialResult of {self.scenario!r}, trial {self.number} of seed {self.seed}, in {self.simulator!r}:"
            f" {self.outcome}, {held} of {len(self.findings)} expectations hold"
        )

    def _repr_html_(self) -> str:
        rows = [("held" if finding.held else "FAILED", finding.text) for finding in self.findings]
        return html_table(rows, ("", repr(self)))

    def as_dict(self) -> dict[str, Any]:
        """For JSON; numbers that are not finite become None."""
        return {
            "number": self.number,
            "passed": self.passed,
            "outcome": self.outcome,
            "findings": [{**asdict(finding), "value": _plain(finding.value)} for finding in self.findings],
            "measured": {key: _plain(value) for key, value in self.measured.items()},
            "drawn": dict(self.drawn),
            "seconds": self.seconds,
        }


def run_scenario(
    scenario: Scenario,
    *,
    number: int = 0,
    seed: int | None = None,
    controller: Factory | object | None = None,
    on_step: OnStep | None = None,
) -> TrialResult:
    """Run one trial.

    Args:
        scenario: from `load_scenario`.
        number: which of the scenario's trials, from 0; each draws its own noise, errors and pushes.
        seed: of the trials; default: the scenario's.
        controller: your own in place of the scenario's: an object with ``tick`` and ``reset`` as `Walker`, or with
            ``begin`` and ``command`` as `QpController`, or a factory of one, called as (robot, gait, period=...); in
            space with ``reset``, ``tick`` and ``command`` as `SpatialWalker`, called as (free, robot, gait,
            period=...); in either a function of (t, q, v) that returns torques by joint name, as `joint_law` says.
        on_step: called with the number of completed steps.

    Returns:
        What was found; a fall is an outcome, not an error. The same scenario, number and seed give the same run.

    Raises:
        ScenarioError: robot, gait or controller cannot be had, or the controller raised something; one line with file,
            field, value and remedy.
        ControllerError: an answer of the controller cannot be used; one line likewise.
        MissingExtraError: the scenario asks for MuJoCo, which is not installed.
    """
    return run_trial(prepare(scenario), number, seed, controller, on_step)


def run_trial(
    prepared: Prepared,
    number: int = 0,
    seed: int | None = None,
    controller: Factory | object | None = None,
    on_step: OnStep | None = None,
) -> TrialResult:
    """One trial of a scenario whose robot and gait are in place; arguments as `run_scenario`."""
    began = time.perf_counter()
    scenario = prepared.scenario
    chosen_seed = scenario.seed if seed is None else seed
    try:
        with folder_kept():
            run, measured, drawn = _walked(prepared, trial_seed(chosen_seed, number), controller, on_step)
    except ControllerError as error:
        given = "the controller given" if controller is not None else f"controller = {scenario.controller.kind!r}"
        raise ControllerError(f"{scenario.path}: {given}: {error}") from None
    marked = {"scenario": scenario.name, "trial": number, "seed": chosen_seed, "drawn": dict(drawn)}
    run = replace(run, settings={**run.settings, "trial": marked})
    return TrialResult(
        scenario.name,
        number,
        chosen_seed,
        scenario.simulator,
        run.outcome,
        judge(prepared, run, measured),
        measured,
        drawn,
        time.perf_counter() - began,
        run,
    )


def _walked(
    prepared: Prepared, seed: np.random.SeedSequence, controller: Factory | object | None, on_step: OnStep | None
) -> tuple[AnyRun, dict[str, float], Mapping[str, float]]:
    """A run, its measures and what was drawn for it, in the plane or in space."""
    if prepared.scenario.space is not None:
        against = spatial_conditions(prepared, seed)
        walk = walk_trial(prepared, against, spatial_walker(prepared, against, controller), on_step)
        return walk, spatial_measures(prepared, walk), against.drawn
    drawn = conditions(prepared, seed)
    run = _walk(prepared, drawn, *make_controller(prepared, drawn, controller), on_step)
    return run, measures(prepared, run), drawn.drawn


def _walk(
    prepared: Prepared, drawn: Conditions, controller: Any, contract: Contract, on_step: OnStep | None
) -> Trajectory:
    scenario, biped, gait = prepared.scenario, prepared.biped, prepared.gait
    settings = SimulationSettings(
        steps=scenario.steps, period=scenario.controller.period, disturbances=drawn.disturbances
    )
    if scenario.flat_landing is not None:
        settings = replace(settings, flat_landing=scenario.flat_landing)
    walk = ENGINES[scenario.simulator] if contract is Contract.SENSED else simulate_walk
    run = walk(
        biped,
        controller,
        start_state(gait, drawn.speed_error),
        settings,
        errors=drawn.errors,
        stance=scenario.stance,
        on_step=on_step,
        gait=gait_to_dict(gait),
    )
    if contract is Contract.SENSED:
        return run
    reported = {
        key: int(getattr(controller, key)) for key in ("ticks", "unsolved", "declined") if hasattr(controller, key)
    }
    return replace(run, settings={**run.settings, "controller": {"kind": scenario.controller.kind, **reported}})


def _plain(value: float) -> float | None:
    return value if abs(value) < float("inf") else None
