"""A controller that stands: both feet on the ground, every joint held at the posture. No walker, but a tickable."""

import numpy as np
import pinocchio as pin

from frontal_biped.control.spatial_walker.interface import SpatialCommand
from frontal_biped.model.stance_map import Stance
from frontal_biped.virtual_constraints.phase import StepPhase

LEG_STIFFNESS, LEG_DAMPING = 30.0, 0.6
"""Of the legs, times the mass in kg [N m/rad, N m s/rad]: far beyond what tips an upright robot."""

OTHER_FREQUENCY = 20.0  # [rad/s], of every other joint on its own, critically damped


def standing_torques(free):
    """(n,) [N m] at which the robot stands still at its posture: gravity, and what both soles carry of it."""
    model, data, q = free.model, free.model.createData(), free.posture
    gravity = pin.computeGeneralizedGravity(model, data, q)
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    J = np.vstack([pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED) for frame in free.sole_frames])
    wrenches = np.linalg.lstsq(J[:, :6].T, gravity[:6])[0]
    return gravity[6:] - J[:, 6:].T @ wrenches


class Stander:
    """Holds the posture.

    Args:
        free: the robot.
        stiffness: scales that of the legs.
    """

    def __init__(self, free, stiffness=1.0):
        self.free = free
        model, data = free.model, free.model.createData()
        inertia = np.diag(pin.crba(model, data, free.posture))[6:]
        self.kp, self.kd = OTHER_FREQUENCY**2 * inertia, 2.0 * OTHER_FREQUENCY * inertia
        for side in Stance:
            legs = list(free.leg(side))
            self.kp[legs], self.kd[legs] = LEG_STIFFNESS * free.mass, LEG_DAMPING * free.mass
        self.kp *= stiffness
        self.feed_forward = standing_torques(free)
        self.readings, self.commanded = [], []

    def reset(self, stance, q, v):
        self.stance = stance

    def torques(self, reading):
        rates = reading.joint_velocities if reading.joint_velocities is not None else np.zeros(len(self.kp))
        return self.feed_forward + self.kp * (self.free.posture[7:] - reading.joint_positions) - self.kd * rates

    def tick(self, reading, event=None, phase=StepPhase.RISING):
        self.readings.append(reading)
        return SpatialCommand(
            joint_torques=self.torques(reading),
            phase=phase,
            stance=self.stance,
            event=event,
            q=np.full(4, -0.5 * np.pi),
            dq=np.zeros(4),
            y=np.zeros(3),
            p_fri_target=0.0,
            cop_target_x=0.0,
            foothold=np.zeros(3),
            wrench=np.zeros(6),
            speed_target=0.0,
            solved=True,
            given_way="",
        )

    def command(self, speed=None, lateral=None, turn=None):
        self.commanded.append((len(self.readings), speed, lateral, turn))
