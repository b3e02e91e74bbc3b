"""What stands between the true state and the controller: readings with noise and steps, and an observer."""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Reading
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.impact import impact
from frontal_biped.simulation.disturbances import Disturbances

OBSERVER_FREQUENCY = 80.0
"""Natural frequency of the observer's error, critically damped [rad/s]."""


class Sensors:
    """Encoders, inertial unit and foot contacts, in URDF joint order; the same for every engine.

    Args:
        disturbances: of the run.

    Attributes:
        disturbances: of the run.
        generator: of the noise.
    """

    def __init__(self, disturbances: Disturbances) -> None:
        self.disturbances = disturbances
        self.generator = disturbances.generator("sensors")
        self._exact = not (disturbances.noisy_sensors or disturbances.imu_noise or disturbances.gyro_noise)

    def joints(self, positions: FloatArray) -> FloatArray:
        """Readings of joint angles, (n,) each [rad]: noise, then the steps of the encoder."""
        d = self.disturbances
        read = positions
        if d.encoder_noise:
            read = read + d.encoder_noise * self.generator.standard_normal(len(positions))
        if d.quantisation:
            read = d.quantisation * np.round(read / d.quantisation)
        return read

    def read(self, true: Reading) -> Reading:
        """What the sensors make of the true values; rates are left out where they must be estimated."""
        if self._exact:
            return true
        d = self.disturbances
        joints = self.joints(true.joint_positions)
        base_roll, base_roll_rate = true.base_roll, true.base_roll_rate
        if d.imu_noise:
            base_roll += d.imu_noise * float(self.generator.standard_normal())
        if d.gyro_noise:
            base_roll_rate += d.gyro_noise * float(self.generator.standard_normal())
        velocities = None if d.noisy_sensors else true.joint_velocities
        return Reading(true.time, joints, velocities, base_roll, base_roll_rate, true.contact)


class NoisyEncoders:
    """Joint readings with noise, and the state a robot would make of them.

    A Luenberger observer: the model predicts with the commanded torques, the readings correct position and velocity.
    An impact is known from the foot's contact, so the estimate jumps by the impact map.

    Args:
        biped: the robot as the controller knows it.
        sensors: its encoders.
        q: (4,) configuration at the start [rad].
        dq: (4,) velocities at the start [rad/s].
    """

    def __init__(self, biped: FrontalBiped, sensors: Sensors, q: FloatArray, dq: FloatArray) -> None:
        self.biped, self.sensors = biped, sensors
        self.q, self.dq = q.copy(), dq.copy()

    def advance(self, u: FloatArray, h: float) -> None:
        """Predict over h [s] under the commanded torques (4,) [N m], by a midpoint step."""
        ddq = self.biped.forward_dynamics(self.q, self.dq, u)
        middle = self.biped.forward_dynamics(self.q + 0.5 * h * self.dq, self.dq + 0.5 * h * ddq, u)
        self.q = self.q + h * self.dq + 0.5 * h**2 * ddq
        self.dq = self.dq + h * middle

    def read(self, q: FloatArray, period: float) -> tuple[FloatArray, FloatArray]:
        """Take a reading of the true q (4,) [rad]; returns the corrected estimate of q and dq."""
        error = self.sensors.joints(q) - self.q
        self.q = self.q + 2.0 * OBSERVER_FREQUENCY * period * error
        self.dq = self.dq + OBSERVER_FREQUENCY**2 * period * error
        return self.q, self.dq

    def land(self, q_plus: FloatArray) -> None:
        """Pass an impact; the landed foot's sole is flat, which the contact tells."""
        landed = impact(self.biped, self.q, self.dq)
        self.q, self.dq = landed.q_plus, landed.dq_plus
        # the flat sole fixes the orientation of the new stance leg
        self.q[0] = self.sensors.joints(q_plus)[0]
