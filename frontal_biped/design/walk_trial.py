"""Does a gait walk? Its walker, on sensor readings and with torques held, in our simulator and in MuJoCo."""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np

from frontal_biped.files.counted import counted
from frontal_biped.gait.sideways import AnyGait, steps_in_turn
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.falls import OFF_SPEED
from frontal_biped.simulation.mid_fall import speed_errors
from frontal_biped.simulation.settings import PERIOD
from frontal_biped.simulation.trajectory import COMPLETED, Trajectory
from frontal_biped.simulation.walking import walk

STEPS = 20
"""Steps that a gait must walk."""

SPEED = 0.15
"""Largest mean error of the speed half-way down that still counts as walking the gait [-]; beyond it is `OFF_SPEED`."""

TIME = 0.1
"""Largest error of the mean step time that does: a foot that bounces counts steps without making them [-]."""


@dataclass(frozen=True)
class EngineWalk:
    """A walk in one engine.

    Attributes:
        engine: "ours" or "mujoco".
        steps: completed.
        outcome: "completed", how the robot fell, or `OFF_SPEED`.
        step_time: mean duration of a step [s]; None without two landings.
        speed_error: speed half-way down relative to the closed form, minus one, mean over the steps [-]; None where no
            step got there.
        cost_ratio: J of the walk over the gait's [-]; None without a step.
    """

    engine: str
    steps: int
    outcome: str
    step_time: float | None
    speed_error: float | None
    cost_ratio: float | None

    @property
    def walked(self) -> bool:
        """Did it walk?"""
        return self.outcome == COMPLETED

    def __str__(self) -> str:
        if not self.walked and self.outcome != OFF_SPEED:
            return f"{self.engine}: fell after {counted(self.steps, 'step')}, {self.outcome}"
        off = "" if self.speed_error is None else f", speed half-way down {100.0 * self.speed_error:+.1f} %"
        cost = "" if self.cost_ratio is None else f", J {self.cost_ratio:.2f} times the gait's"
        return f"{self.engine}: {counted(self.steps, 'step')}{off}{cost}"


@dataclass(frozen=True)
class WalkTrial:
    """The walks of one gait, up to the first that failed.

    Attributes:
        walks: one for each engine.
    """

    walks: tuple[EngineWalk, ...]

    @property
    def walked(self) -> bool:
        """Did it walk in every engine?"""
        return all(walk.walked for walk in self.walks)

    @property
    def failure(self) -> EngineWalk | None:
        """The walk that failed."""
        return next((walk for walk in self.walks if not walk.walked), None)

    def as_dict(self) -> dict[str, Any]:
        """For a gait file."""
        return {
            walk.engine: {key: value for key, value in asdict(walk).items() if key != "engine"} for walk in self.walks
        }

    def __str__(self) -> str:
        return "; ".join(str(walk) for walk in self.walks)


def engines() -> tuple[str, ...]:
    """Engines that are installed: ours, which takes less time and comes first, and MuJoCo."""
    return ("ours",) if find_spec("mujoco") is None else ("ours", "mujoco")


def try_walk(
    biped: FrontalBiped, gait: AnyGait, steps: int = STEPS, on_step: Callable[[str, int], None] | None = None
) -> WalkTrial:
    """Walk a gait in every engine that is installed, until it fails in one.

    Args:
        biped: the robot.
        gait: the gait.
        steps: to walk.
        on_step: called with the engine and the number of completed steps.
    """
    walks = []
    for engine in engines():
        told = None if on_step is None else (lambda done, engine=engine: on_step(engine, done))
        walks.append(
            _walked(biped, gait, engine, walk(biped, gait, engine=engine, steps=steps, period=PERIOD, on_step=told))
        )
        if not walks[-1].walked:
            break
    return WalkTrial(tuple(walks))


def _walked(biped: FrontalBiped, gait: AnyGait, engine: str, run: Trajectory) -> EngineWalk:
    times = np.diff(run.event_t[run.events("IMPACT")])
    speeds = speed_errors(biped, gait, run)
    speed = float(np.mean(speeds)) if len(speeds) else None
    of_steps = [(step.orbit.step_duration, step.orbit.cost * step.step_width) for step in steps_in_turn(gait)]
    planned_time, planned_effort = np.mean(of_steps, axis=0)
    effort = run.settings.get("measured", {}).get("effort")
    cost = None if effort is None else float(effort["mean"] / planned_effort)
    time = float(times.mean()) if len(times) else None
    off = run.outcome == COMPLETED and (
        speed is None or abs(speed) > SPEED or (time is not None and abs(time / planned_time - 1.0) > TIME)
    )
    return EngineWalk(
        engine,
        run.steps_completed,
        OFF_SPEED if off else run.outcome,
        time,
        speed,
        cost,
    )
