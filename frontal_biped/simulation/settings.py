"""What a simulation is told: how it runs."""

from dataclasses import dataclass, field

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import SimulationError
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.hybrid_system import FLAT_LANDING

PERIOD = 1e-3
"""Control period of a walker where the settings name none [s]."""


@dataclass(frozen=True)
class SimulationSettings:
    """Settings of the simulator.

    Attributes:
        steps: impacts after which to stop.
        period: control period [s]; None: continuous control.
        rtol: relative tolerance of the integrator (continuous control).
        atol: absolute tolerance of the integrator (continuous control).
        record_rate: samples per second of the recording [1/s].
        disturbances: what the robot is up against; they need a period.
        flat_landing: rotation of the swing foot up to which it settles flat at impact [rad]; steeper is a stumble.

    Raises:
        SimulationError: no whole number of steps, a period that is none, or disturbances under continuous control.
    """

    steps: int = 20
    period: float | None = None
    rtol: float = 1e-9
    atol: float = 1e-11
    record_rate: float = 250.0
    disturbances: Disturbances = field(default_factory=Disturbances)
    flat_landing: float = FLAT_LANDING

    def __post_init__(self) -> None:
        if isinstance(self.steps, bool) or not isinstance(self.steps, int | np.integer) or self.steps < 1:
            raise SimulationError(f"steps = {self.steps!r} is not a whole number of at least 1")
        if self.period is not None and not 0.0 < self.period < float("inf"):
            raise SimulationError(f"period = {self.period!r} s is not positive; None for continuous control")
        if self.disturbances.any and self.period is None:
            raise SimulationError("disturbances act on sampled control; give a control period")

    @property
    def landing_heights(self) -> FloatArray:
        """(steps + 1,) heights of the ground under the footholds [m]."""
        return self.disturbances.landing_heights(self.steps + 1)
