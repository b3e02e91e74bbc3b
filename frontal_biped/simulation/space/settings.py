"""What a walk in space is told: how long, how it is sampled and recorded, what disturbs it, what it is commanded."""

from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import SimulationError
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.settings import PERIOD
from frontal_biped.simulation.space.pushes import SpatialPush


@dataclass(frozen=True)
class SpeedChange:
    """A command to walk otherwise; the walker follows it from its next step on.

    Attributes:
        speed: forwards [m/s]; None: as before.
        lateral: to the left [m/s]; None: as before.
        turn: to the left [rad/s]; None: as before.
        step: given as this step begins, from 0; or
        time: given at this time [s].

    Raises:
        SimulationError: neither step nor time is given, or both are.
    """

    speed: float | None = None
    lateral: float | None = None
    turn: float | None = None
    step: int | None = None
    time: float | None = None

    def __post_init__(self) -> None:
        if (self.step is None) is (self.time is None):
            raise SimulationError("a change of speed has either a step or a time; give step = 0 for the start")

    def due(self, t: float, step: int) -> bool:
        """Is it to be given by time t [s], in a step from 0?"""
        return step >= self.step if self.step is not None else t >= (self.time or 0.0)


@dataclass(frozen=True)
class SpatialSettings:
    """Settings of a walk in space.

    Attributes:
        steps: landings after which to stop.
        period: control period [s].
        record_rate: samples per second of the recording [1/s].
        disturbances: noise, delay, ground and friction. ``imu_noise`` turns the root link's axes by random angles about
            each of them, ``gyro_noise`` is that of each rate. Their pushes and torque limits are those of the plane and
            stay empty.
        velocity_noise: standard deviation of the joint rates that are read [rad/s]; None: they are exact, and where the
            encoders are noisy left out, to be estimated.
        pushes: on any link.
        commands: changes of speed, in the order in which they come.

    Raises:
        SimulationError: a value that makes no walk.
    """

    steps: int = 20
    period: float = PERIOD
    record_rate: float = 250.0
    disturbances: Disturbances = field(default_factory=Disturbances)
    velocity_noise: float | None = None
    pushes: tuple[SpatialPush, ...] = ()
    commands: tuple[SpeedChange, ...] = ()

    def __post_init__(self) -> None:
        if isinstance(self.steps, bool) or not isinstance(self.steps, int | np.integer) or self.steps < 1:
            raise SimulationError(f"steps = {self.steps!r} is not a whole number of at least 1")
        for key in ("period", "record_rate"):
            if not 0.0 < getattr(self, key) < float("inf"):
                raise SimulationError(f"{key} = {getattr(self, key)!r} is not positive")
        if self.velocity_noise is not None and not self.velocity_noise >= 0.0:
            raise SimulationError(f"velocity_noise = {self.velocity_noise!r} must not be negative; 0 for none")
        if self.disturbances.pushes:
            raise SimulationError("pushes of the plane in a walk in space; give SpatialSettings(pushes=...) instead")
        if self.disturbances.torque_limits is not None:
            raise SimulationError("torque_limits are for the four joints of the plane; in space the URDF's hold")

    @property
    def landing_heights(self) -> FloatArray:
        """(steps + 1,) heights of the ground under the footholds [m]."""
        return self.disturbances.landing_heights(self.steps + 1)

    def as_dict(self) -> dict[str, Any]:
        """As a run file keeps it."""
        plain = asdict(self)
        plain["disturbances"] = self.disturbances.as_dict()
        plain["pushes"] = [asdict(push) for push in self.pushes]
        plain["commands"] = [asdict(change) for change in self.commands]
        return plain
