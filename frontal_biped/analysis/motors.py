"""What a gait needs of the motors: the largest torques and speeds along its orbit, as shares of the robot's limits."""

from dataclasses import dataclass

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.gait.check import DENSE_POINTS
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import JOINTS
from frontal_biped.zero_dynamics.orbit import resample
from frontal_biped.zero_dynamics.poincare import StepOrbit
from frontal_biped.zero_dynamics.restricted import TORQUES


@dataclass(frozen=True)
class Peak:
    """The joint that comes nearest to its limit.

    Attributes:
        joint: its name.
        value: largest size over a step [N m or rad/s].
        limit: of the robot; infinite where it has none.
        share: of the limit that is used [-]; 0 without one.
    """

    joint: str
    value: float
    limit: float
    share: float

    def text(self, unit: str) -> str:
        """In words."""
        if not np.isfinite(self.limit):
            return f"{self.value:.3g} {unit} at the {self.joint}, which has no limit"
        return (
            f"{100.0 * self.share:.0f} % of the limit: {self.value:.3g} of {self.limit:.3g} {unit} at the {self.joint}"
        )


@dataclass(frozen=True)
class MotorDemand:
    """What a step asks of the motors, impacts left out.

    Attributes:
        torque: of the joint whose torque is the largest share of its limit [N m].
        speed: of the joint whose speed is the largest share of its limit [rad/s]; where no joint has one, the fastest.
    """

    torque: Peak
    speed: Peak

    def __str__(self) -> str:
        return f"torque {self.torque.text('N m')}; speed {self.speed.text('rad/s')}"


def motor_demand(biped: FrontalBiped, gait: Gait, step: StepOrbit) -> MotorDemand:
    """The largest torque and speed of a gait on the grid of its constraints.

    Args:
        biped: the robot.
        gait: the gait.
        step: the integrated step.
    """
    tau = np.linspace(0.0, 1.0, DENSE_POINTS)
    phases = ((gait.rising, step.rising), (gait.falling, step.falling))
    orbits = [resample(biped, phase, orbit, tau) for phase, orbit in phases]
    torques = [np.max(np.abs(orbit.generalized_forces[TORQUES]), axis=1) for orbit in orbits]
    speeds = [np.max(np.abs(orbit.motion.dq * orbit.dbeta[:, None]), axis=0) for orbit in orbits]
    return MotorDemand(
        _peak(np.max(torques, axis=0), biped.max_torque), _peak(np.max(speeds, axis=0), biped.joint_max_velocity)
    )


def _peak(values: FloatArray, limits: FloatArray) -> Peak:
    shares = np.where(np.isfinite(limits), values / limits, 0.0)
    most = int(np.argmax(shares if np.any(np.isfinite(limits)) else values))
    return Peak(JOINTS[most], float(values[most]), float(limits[most]), float(shares[most]))
