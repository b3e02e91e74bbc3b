"""What a simulated robot is up against: noisy encoders, noisy torques, pushes at the pelvis. Seeded, so repeatable."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.impact import impact
from frontal_biped.model.stance_map import Stance

OBSERVER_FREQUENCY = 80.0
"""Natural frequency of the observer's error, critically damped [rad/s]."""


@dataclass(frozen=True)
class Push:
    """A constant lateral force at the middle of the hip line for a while.

    Attributes:
        start: time from the start of the run [s].
        duration: [s].
        impulse: force times duration, positive to the robot's left [N s].
    """

    start: float
    duration: float
    impulse: float

    def force(self, t: float) -> float:
        """Force to the left at time t [N]."""
        # a hair early, so that a push that starts on a tick acts in it
        return self.impulse / self.duration if self.start - 1e-9 <= t < self.start + self.duration - 1e-9 else 0.0


@dataclass(frozen=True)
class Disturbances:
    """Everything that disturbs a sampled run.

    Attributes:
        encoder_noise: standard deviation of each joint reading [rad]; the velocities then come from an observer.
        torque_noise: standard deviation of each torque, relative to the commanded one [-].
        pushes: forces at the pelvis.
        seed: of both noises.
    """

    encoder_noise: float = 0.0
    torque_noise: float = 0.0
    pushes: tuple[Push, ...] = ()
    seed: int = 0

    @property
    def any(self) -> bool:
        """Is there anything at all?"""
        return bool(self.encoder_noise or self.torque_noise or self.pushes)

    def lateral_force(self, t: float, stance: Stance) -> float:
        """Force along h, from the stance foot towards the swing foot [N]."""
        to_the_left = sum(push.force(t) for push in self.pushes)
        return -to_the_left if stance is Stance.LEFT else to_the_left


class PelvisForce:
    """A horizontal force at the middle of the hip line, as the robot feels it.

    Args:
        biped: the robot.
    """

    def __init__(self, biped: FrontalBiped) -> None:
        self.biped = biped
        self._data = biped.pinned.createData()

    def torques(self, q: FloatArray, force: float) -> FloatArray:
        """(4,) generalized forces [N m] of a force along h [N]."""
        model, data = self.biped.pinned, self._data
        pin.computeJointJacobians(model, data, q)
        ends = [pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED)[0] for joint in (2, 3)]
        return 0.5 * force * (ends[0] + ends[1])

    def height(self, q: FloatArray) -> float:
        """Height of the point where it acts [m]."""
        return float(self.biped.joint_positions(q)[1:3, 1].mean())


class NoisyEncoders:
    """Joint readings with white noise, and the state a robot would make of them.

    A Luenberger observer: the model predicts with the commanded torques, the readings correct position and velocity.
    An impact is known from the foot's contact, so the estimate jumps by the impact map.

    Args:
        biped: the robot.
        noise: standard deviation of a reading [rad].
        generator: of the noise.
        q: (4,) configuration at the start [rad].
        dq: (4,) velocities at the start [rad/s].
    """

    def __init__(
        self, biped: FrontalBiped, noise: float, generator: np.random.Generator, q: FloatArray, dq: FloatArray
    ) -> None:
        self.biped, self.noise, self.generator = biped, noise, generator
        self.q, self.dq = q.copy(), dq.copy()

    def advance(self, u: FloatArray, h: float) -> None:
        """Predict over h [s] under the commanded torques (4,) [N m], by a midpoint step."""
        ddq = self.biped.forward_dynamics(self.q, self.dq, u)
        middle = self.biped.forward_dynamics(self.q + 0.5 * h * self.dq, self.dq + 0.5 * h * ddq, u)
        self.q = self.q + h * self.dq + 0.5 * h**2 * ddq
        self.dq = self.dq + h * middle

    def read(self, q: FloatArray, period: float) -> tuple[FloatArray, FloatArray]:
        """Take a reading of the true q (4,) [rad]; returns the corrected estimate of q and dq."""
        error = q + self.noise * self.generator.standard_normal(4) - self.q
        self.q = self.q + 2.0 * OBSERVER_FREQUENCY * period * error
        self.dq = self.dq + OBSERVER_FREQUENCY**2 * period * error
        return self.q, self.dq

    def land(self, q_plus: FloatArray) -> None:
        """Pass an impact; the landed foot's sole is flat, which the contact tells."""
        landed = impact(self.biped, self.q, self.dq)
        self.q, self.dq = landed.q_plus, landed.dq_plus
        # the flat sole fixes the orientation of the new stance leg
        self.q[0] = q_plus[0] + self.noise * float(self.generator.standard_normal())
