"""A motion of the whole robot, sampled in time: every joint of the URDF, the base, both feet.

It is what a planar run, the periodic orbit of a gait and a walk in space have in common once every joint is told, and
what is handed over to drivers, to Pinocchio and to MuJoCo.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError
from frontal_biped.model.robot import Robot
from frontal_biped.model.space.free_robot import BASE
from frontal_biped.model.space.joint_arrays import ROOT, JointArrays, joint_positions, to_mujoco
from frontal_biped.numerics.by_name import Columns

FOOT_NAMES = ("left", "right")
"""Order of both feet in arrays."""


@dataclass(frozen=True, eq=False)
class WholeMotion:
    """A motion of every joint of a URDF, time first. World: X forward, Y left, Z up, ground z = 0.

    ``q``, ``v`` and ``tau`` are those of ``robot.model``: Pinocchio's reading of the URDF with a free-flyer root.

    Attributes:
        robot: whose motion it is.
        t: (T,) time [s]; an event has two samples at one time, before and after.
        q: (T, nq) configurations: xyz [m] and quaternion xyzw of the root link, then the joints [rad, m]; a continuous
            joint takes two numbers, cosine and sine.
        v: (T, nv) velocities: root link linear [m/s] and angular [rad/s] in its own axes, then the joints [rad/s, m/s].
        tau: (T, nv - 6) joint torques [N m, N].
        contact: (T, 2) 1 where the left, the right foot stands on the ground, else 0.
        wrench: (T, 2, 6) ground on sole: force [N], moment about the origin of the sole's frame [N m]; world axes.
        phase: (T,) +1 rising, -1 falling.
        stance: (T,) +1 left, -1 right.
        step: (T,) index of the step.
        held: names of the joints of one freedom that stay at the posture all the time; those of more all do.
    """

    robot: Robot
    t: FloatArray
    q: FloatArray
    v: FloatArray
    tau: FloatArray
    contact: FloatArray
    wrench: FloatArray
    phase: FloatArray
    stance: FloatArray
    step: FloatArray
    held: tuple[str, ...]

    def __repr__(self) -> str:
        return (
            f"WholeMotion of {self.robot.name!r}: {len(self.t)} samples in {float(self.t[-1] - self.t[0]):.2f} s,"
            f" {len(self.joint_names)} joints; positions, velocities, torques by joint; pinocchio, mujoco"
        )

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """(n) every joint of the URDF that has one freedom, in Pinocchio's order."""
        return one_freedom(self.robot)

    @property
    def root_link(self) -> str:
        """Name of the link whose pose leads ``q``."""
        return self.robot.model.frames[2].name

    @property
    def base_pose(self) -> FloatArray:
        """(T, 7) of the root link: xyz [m] and quaternion xyzw [-]."""
        return self.q[:, :ROOT]

    @property
    def base_velocity(self) -> FloatArray:
        """(T, 6) of the root link: linear [m/s] and angular [rad/s], in its own axes."""
        return self.v[:, :BASE]

    @cached_property
    def angles(self) -> FloatArray:
        """(T, n) joint positions, one number each, in the order of `joint_names` [rad, m]."""
        model = self.robot.model
        return np.stack([joint_positions(model, name, self.q) for name in self.joint_names], axis=1)

    @cached_property
    def rates(self) -> FloatArray:
        """(T, n) joint velocities in the order of `joint_names` [rad/s, m/s]."""
        return self.v[:, self._rows]

    @cached_property
    def efforts(self) -> FloatArray:
        """(T, n) joint torques in the order of `joint_names` [N m, N]."""
        return self.tau[:, [row - BASE for row in self._rows]]

    @property
    def _rows(self) -> list[int]:
        model = self.robot.model
        return [model.joints[model.getJointId(name)].idx_v for name in self.joint_names]

    @cached_property
    def positions(self) -> Columns:
        """(T,) positions of every joint by its URDF name [rad, m]."""
        return Columns(self.joint_names, self.angles)

    @cached_property
    def velocities(self) -> Columns:
        """(T,) velocities of every joint by its URDF name [rad/s, m/s]."""
        return Columns(self.joint_names, self.rates)

    @cached_property
    def torques(self) -> Columns:
        """(T,) torques of every joint by its URDF name [N m, N]."""
        return Columns(self.joint_names, self.efforts)

    @property
    def pinocchio(self) -> JointArrays:
        """For the URDF read by Pinocchio with a free-flyer root.

        Raises:
            RobotError: a joint has more than one freedom, so that no name or number stands for it; one line.
        """
        for name in self.robot.joint_names:
            if name not in self.joint_names:
                raise RobotError(
                    f"{self.robot.description.urdf}: joint {name!r} has more than one freedom, for which Pinocchio and"
                    ' MuJoCo have no common array; export CSV, or make it type="fixed": they free the root link anyway'
                )
        return JointArrays(self.q, self.v, self.tau, self.joint_names)

    @cached_property
    def mujoco(self) -> JointArrays:
        """For the URDF read by MuJoCo, a free joint on its root link: qpos, qvel and the joints' qfrc_applied.

        Raises:
            RobotError: a joint has more than one freedom; one line.
        """
        return to_mujoco(self.robot, self.pinocchio)


def one_freedom(robot: Robot) -> tuple[str, ...]:
    """Joints of a robot with one freedom: one number tells where they are."""
    model = robot.model
    return tuple(name for name in robot.joint_names if model.joints[model.getJointId(name)].nv == 1)
