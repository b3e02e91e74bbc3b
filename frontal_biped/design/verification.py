"""Before a design is called a gait: a step of the full model in closed loop must return to where it began.

The optimiser works on the closed form. Here the four-joint dynamics is integrated under the walking controller with
event detection and the rigid impact: another code path, from the post-impact state to the next one.
"""

from dataclasses import dataclass

import numpy as np

from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.trajectory import COMPLETED
from frontal_biped.simulation.walking import simulate

RETURN_TOLERANCE = 1e-4
"""Largest difference of the states after two impacts [rad, rad/s]; the integrator is set to keep a tenth of it."""

SETTINGS = SimulationSettings(rtol=1e-5, atol=1e-7, record_rate=20.0)


@dataclass(frozen=True)
class Verification:
    """One simulated step.

    Attributes:
        outcome: "completed", or what made the robot fall.
        return_error: largest difference of the post-impact states [rad, rad/s]; inf without a second one.
        duration_error: simulated minus closed-form step duration [s].
    """

    outcome: str
    return_error: float
    duration_error: float

    @property
    def passed(self) -> bool:
        """Did the step return to where it began?"""
        return self.outcome == COMPLETED and self.return_error < RETURN_TOLERANCE


def verify(biped: FrontalBiped, gait: Gait) -> Verification:
    """Simulate one step of the gait in the full model, control in continuous time."""
    run = simulate(biped, gait, steps=1, period=None, simulation_settings=SETTINGS, stabiliser="fixed")
    states = run.post_impact_states()
    if run.fell or len(states) < 1:
        return Verification(run.outcome, float("inf"), float("inf"))
    before = np.concatenate(gait.state_after_impact())
    error = float(np.max(np.abs(states[-1] - before)))
    return Verification(run.outcome, error, float(run.t[-1] - gait.orbit.step_duration))
