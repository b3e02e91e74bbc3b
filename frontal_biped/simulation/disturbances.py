"""What a simulated robot is up against: noise, delay, weak motors, pushes, ground that is uneven or slippery.

Everything is seeded, so a run can be repeated. The torques, the ground and the sensors draw from streams of their own:
switching one disturbance on leaves the draws of the others as they were.
"""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import SimulationError
from frontal_biped.simulation.pushes import Push

_STREAMS = ("sensors", "torques", "ground")


@dataclass(frozen=True)
class Disturbances:
    """Everything that disturbs a sampled run.

    Attributes:
        encoder_noise: standard deviation of each joint reading [rad]; the velocities are then estimated.
        torque_noise: standard deviation of each torque, relative to the commanded one [-].
        pushes: forces at the pelvis.
        seed: of everything random.
        delay: from a reading to the torques it leads to, rounded to whole control periods [s].
        quantisation: step of the joint readings [rad]; the velocities are then estimated.
        imu_noise: standard deviation of the pelvis roll that an inertial unit tells [rad].
        gyro_noise: standard deviation of the pelvis roll rate [rad/s].
        ground: heights of the ground under the first landings, above the level on which the feet start [m].
        ground_height: further landings are uniform within plus and minus this [m].
        friction: coefficient of the ground [-]; None: the foot never slips (rigid engine), the engine's own (MuJoCo).
        rolls: does the stance foot roll over its edge where the FRI leaves the sole, a fall? Otherwise it stays
            flat whatever is asked of it (rigid engine; in MuJoCo feet roll in any case).
        torque_limits: what the motors of ankles and hips give at most, whatever is commanded [N m].

    Raises:
        SimulationError: a negative size, or a friction or torque limit that is not positive.
    """

    encoder_noise: float = 0.0
    torque_noise: float = 0.0
    pushes: tuple[Push, ...] = ()
    seed: int = 0
    delay: float = 0.0
    quantisation: float = 0.0
    imu_noise: float = 0.0
    gyro_noise: float = 0.0
    ground: tuple[float, ...] = ()
    ground_height: float = 0.0
    friction: float | None = None
    rolls: bool = False
    torque_limits: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        for key in (
            "encoder_noise",
            "torque_noise",
            "delay",
            "quantisation",
            "imu_noise",
            "gyro_noise",
            "ground_height",
        ):
            if not getattr(self, key) >= 0.0:
                raise SimulationError(f"{key} = {getattr(self, key)!r} must not be negative; 0 for none")
        if self.friction is not None and not self.friction > 0.0:
            raise SimulationError(f"friction = {self.friction!r} must be positive; leave it out for a foot that sticks")
        if self.torque_limits is not None and not min(self.torque_limits) > 0.0:
            raise SimulationError(f"torque_limits = {self.torque_limits!r} must be positive: (ankle, hip) in N m")

    @property
    def any(self) -> bool:
        """Is there anything at all?"""
        nothing = Disturbances(seed=self.seed)
        return self != nothing

    @property
    def noisy_sensors(self) -> bool:
        """Do the joint readings differ from the joints? Their rates then have to be estimated."""
        return bool(self.encoder_noise or self.quantisation)

    def generator(self, stream: str) -> np.random.Generator:
        """Random numbers of "sensors", "torques" or "ground"; always from the start of the stream."""
        return np.random.default_rng(np.random.SeedSequence([self.seed, _STREAMS.index(stream)]))

    def landing_heights(self, count: int) -> FloatArray:
        """(count,) heights of the ground under the next landings [m]; the feet start at 0."""
        uneven = self.ground_height * self.generator("ground").uniform(-1.0, 1.0, count)
        given = np.array(self.ground[:count], dtype=float)
        return np.concatenate([given, uneven[len(given) :]])

    def delay_ticks(self, period: float) -> int:
        """The delay in whole control periods."""
        return round(self.delay / period)

    def chain_torque_limits(self) -> FloatArray:
        """(4,) largest torques of the motors [N m]; ankle, hip, hip, ankle for either stance foot. inf: no limit."""
        ankle, hip = self.torque_limits or (np.inf, np.inf)
        return np.array([ankle, hip, hip, ankle])

    def as_dict(self) -> dict[str, Any]:
        """As a run file keeps it: lists, numbers and names."""
        return {key: list(value) if isinstance(value, tuple) else value for key, value in asdict(self).items()}
