"""The paper's sensitivity experiment: what an error of the reversal point costs in invariance, in the full model.

The robot starts after an impact with the speed that, in closed form, reverses at the planned point plus an error. With
the paper's fixed transitions the falling phase then starts off its virtual constraints; with adaptive ones it does not.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from frontal_biped.control.stabilisers import make_stabiliser
from frontal_biped.control.transitions import AdaptiveTransitions
from frontal_biped.exceptions import ReversalError
from frontal_biped.gait import Gait
from frontal_biped.half_steps import rising_energy
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.walking import simulate

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
    stabilisers: Sequence[str] = ("fixed", "adaptive"),
) -> SensitivityExperiment:
    """Walk one step for each reversal error.

    Args:
        biped: the robot.
        gait: the gait.
        shifts: errors of the reversal [rad], positive where it is late; those the gait cannot reach are left out.
        stabilisers: by name.
    """
    energy = rising_energy(biped, AdaptiveTransitions(biped, gait).planned_rising)
    runs = []
    for name in stabilisers:
        # plain re-anchoring: looking ahead would move the reversal that is asked for
        plain = name == "adaptive"
        chosen = AdaptiveTransitions(biped, gait, anticipate=False) if plain else make_stabiliser(name, biped, gait)
        for shift in shifts:
            reversal = gait.beta_reversal + shift
            if not gait.rising.beta_start < reversal < energy.end:
                continue
            try:
                speed = energy.speed(reversal)
            except ReversalError:
                continue
            error = speed / gait.orbit.beta_dot_after_impact - 1.0
            run = simulate(biped, gait, steps=1, speed_error=error, stabiliser=chosen, simulation_settings=SETTINGS)
            reversals = run.events("REVERSAL")
            actual = run.event_state[reversals[0], 0] - gait.beta_reversal if len(reversals) else np.nan
            worst = float(np.max(np.abs(run.output_error)))
            runs.append(LossOfInvariance(name, float(shift), float(actual), worst, run.outcome))
    return SensitivityExperiment(tuple(runs))
