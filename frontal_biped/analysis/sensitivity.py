"""The paper's sensitivity experiment: what an error of the reversal point costs in invariance, in the full model.

The robot starts after an impact with the speed that, in closed form, reverses at the planned point plus an error. With
the paper's fixed transitions the falling phase then starts off its virtual constraints; re-anchored, it does not.
Re-anchored as it comes, that is: "adaptive" transitions look ahead and would move the reversal that is asked for.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from frontal_biped.control.settings import ControllerSettings
from frontal_biped.control.stabilisers.by_name import make_stabiliser
from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions, Stabiliser
from frontal_biped.exceptions import ReversalError
from frontal_biped.files.counted import counted
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.trajectory import COMPLETED
from frontal_biped.simulation.walking import simulate
from frontal_biped.zero_dynamics.half_steps import rising_energy

LATE = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
SHIFTS = tuple(-shift for shift in reversed(LATE)) + LATE  # [rad]
SETTINGS = SimulationSettings(rtol=1e-9, atol=1e-11)


@dataclass(frozen=True)
class LossOfInvariance:
    """One run of the experiment.

    Attributes:
        stabiliser: by name.
        shift: error of the reversal asked for [rad].
        actual: error of the simulated reversal [rad]; nan without one.
        worst_output_error: largest |q_b - h_d| over the step [rad].
        outcome: "completed", or what made the robot fall.
    """

    stabiliser: str
    shift: float
    actual: float
    worst_output_error: float
    outcome: str


@dataclass(frozen=True)
class SensitivityExperiment:
    """All runs.

    Attributes:
        runs: by stabiliser, then by shift.
    """

    runs: tuple[LossOfInvariance, ...]

    def of(self, stabiliser: str) -> tuple[LossOfInvariance, ...]:
        """The runs of one stabiliser."""
        return tuple(run for run in self.runs if run.stabiliser == stabiliser)

    def as_dict(self) -> dict[str, Any]:
        """For JSON; what was not reached is null."""
        rows = [asdict(run) for run in self.runs]
        return {"runs": [{k: None if v != v else v for k, v in row.items()} for row in rows]}


def reversal_sensitivity(
    biped: FrontalBiped,
    gait: Gait,
    *,
    shifts: Sequence[float] = SHIFTS,
    stabilisers: Sequence[str] = ("fixed", "re-anchored"),
) -> SensitivityExperiment:
    """Walk one step for each reversal error.

    Args:
        biped: the robot.
        gait: the gait.
        shifts: errors of the reversal [rad], positive where it is late; those the gait cannot reach are left out.
        stabilisers: by name.
    """
    energy = rising_energy(biped, ReanchoringTransitions(biped, gait).planned_rising)
    runs = []
    for name in stabilisers:
        chosen = make_stabiliser(name, biped, gait)
        for shift in shifts:
            reversal = gait.beta_reversal + shift
            if not gait.rising.beta_start < reversal < energy.end:
                continue
            try:
                speed = energy.speed(reversal)
            except ReversalError:
                continue
            error = speed / gait.orbit.beta_dot_after_impact - 1.0
            run = simulate(
                biped, gait, steps=1, period=None, speed_error=error, stabiliser=chosen, simulation_settings=SETTINGS
            )
            reversals = run.events("REVERSAL")
            actual = run.event_state[reversals[0], 0] - gait.beta_reversal if len(reversals) else np.nan
            worst = float(np.max(np.abs(run.output_error)))
            runs.append(LossOfInvariance(name, float(shift), float(actual), worst, run.outcome))
    return SensitivityExperiment(tuple(runs))


def simulated_multiplier(biped: FrontalBiped, gait: Gait, relative_step: float = 1e-4) -> float:
    """Slope of the return map of the full model at its fixed point, by a central difference of two simulated steps.

    With the paper's fixed transitions, under which the map is smooth; re-anchored ones have the same slope at the gait,
    but another curvature on either side of it. The post-impact speed is the coordinate; at a fixed point its slope
    equals that of zeta, which is proportional to its square.

    Args:
        biped: the robot.
        gait: the gait.
        relative_step: of the post-impact speed [-].
    """
    speed = []
    for sign in (+1.0, -1.0):
        run = simulate(biped, gait, steps=1, period=None, speed_error=sign * relative_step, stabiliser="fixed")
        speed.append(run.post_impact_speeds[-1] if not run.fell else np.nan)
    return float((speed[0] - speed[1]) / (2.0 * relative_step * gait.orbit.beta_dot_after_impact))


@dataclass(frozen=True)
class SpeedErrorOutcome:
    """What an error in the post-impact speed does to a gait with the paper's fixed transition.

    Attributes:
        speed_error: relative [-].
        steps_completed: of those asked for.
        outcome: "completed", or what made the robot fall.
        reversal_shift: first reversal minus the planned one [rad]; nan without a reversal.
        worst_output_error: largest |q_b - h_d| [rad].
        final_speed_error: relative error of the last post-impact speed [-].
    """

    speed_error: float
    steps_completed: int
    outcome: str
    reversal_shift: float
    worst_output_error: float
    final_speed_error: float

    def __str__(self) -> str:
        after = counted(self.steps_completed, "step")
        end = f"walks {after}" if self.outcome == COMPLETED else f"falls after {after}: {self.outcome}"
        return (
            f"a {100 * self.speed_error:+.3g} % error in the post-impact speed moves the first reversal by"
            f" {self.reversal_shift:+.2e} rad and costs {self.worst_output_error:.1e} rad of invariance;"
            f" the robot {end}, speed error then {100 * self.final_speed_error:+.3g} %"
        )


def speed_error_outcome(
    biped: FrontalBiped,
    gait: Gait,
    speed_error: float,
    *,
    steps: int = 10,
    stabiliser: Stabiliser | str = "fixed",
    controller_settings: ControllerSettings | None = None,
) -> SpeedErrorOutcome:
    """Start with an error in the post-impact speed, control continuously, and see what becomes of the gait.

    Args:
        biped: the robot.
        gait: the gait.
        speed_error: relative [-].
        steps: to try.
        stabiliser: a stabiliser, or one of `STABILISERS` by name; default: the paper's fixed transitions.
        controller_settings: gains and limits.
    """
    settings = SimulationSettings(rtol=1e-8, atol=1e-10)
    run = simulate(
        biped,
        gait,
        steps=steps,
        period=None,
        speed_error=speed_error,
        stabiliser=stabiliser,
        controller_settings=controller_settings,
        simulation_settings=settings,
    )
    reversals = run.events("REVERSAL")
    shift = run.event_state[reversals[0], 0] - gait.beta_reversal if len(reversals) else float("nan")
    return SpeedErrorOutcome(
        speed_error=speed_error,
        steps_completed=run.steps_completed,
        outcome=run.outcome,
        reversal_shift=float(shift),
        worst_output_error=float(np.max(np.abs(run.output_error))),
        final_speed_error=float(run.post_impact_speeds[-1] / gait.orbit.beta_dot_after_impact - 1.0),
    )
