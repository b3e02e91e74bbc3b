"""The whole robot on a free base: what walks in space, every joint of the URDF but the lightest."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError
from frontal_biped.files.shown import ShownAsPage
from frontal_biped.model.chain import GRAVITY
from frontal_biped.model.robot import JointLimits, Robot, Soles
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.urdf.whole_model import ROOT

LIGHT = 2e-3
"""A joint that moves less than this share of the robot's mass, and no foot, is held at its posture: fingers, grippers.

A free finger is dearer than a leg: it is a variable of every control tick and nothing of it is felt at the feet.
"""

BASE = 6
"""Velocities of the free base, before those of the joints: linear, then angular, in the axes of the root link."""


@dataclass(frozen=True, eq=False)
class FreeRobot(ShownAsPage):
    """A robot on a free base.

    Configurations are q = (x, y, z, qx, qy, qz, qw, joints) of the root link in the world, velocities
    v = (linear, angular) of the root link in its own axes, then the joint rates: Pinocchio's free-flyer.

    Attributes:
        robot: of which this is the motion in space.
        model: Pinocchio's, the light joints locked. Not to be changed.
        locked: names of the joints that are held at the posture.
        posture: (nq,) the robot at its posture, soles on z = 0, the middle between the ankles above x = y = 0.
        sole_frames: frames of ``model`` at the left and the right `FootSole.placement`.

    Raises:
        RobotError: a joint has more than one freedom.
    """

    robot: Robot
    model: pin.Model = field(init=False, repr=False)
    locked: tuple[str, ...] = field(init=False)
    posture: FloatArray = field(init=False, repr=False)
    sole_frames: tuple[int, int] = field(init=False, repr=False)

    def __repr__(self) -> str:
        held = f", {len(self.locked)} held" if self.locked else ""
        return f"FreeRobot {self.name!r}: {self.mass:.1f} kg, {len(self.joint_names)} joints that move{held}"

    def __post_init__(self) -> None:
        full, posture = self.robot.model, self.robot.posture
        light = _light_joints(self.robot)
        model, q = pin.buildReducedModel(full, [full.getJointId(name) for name in light], posture), posture
        if light:
            q = pin.neutral(model)
            for name in model.names[1:]:
                old, new = full.joints[full.getJointId(name)], model.joints[model.getJointId(name)]
                q[new.idx_q : new.idx_q + new.nq] = posture[old.idx_q : old.idx_q + old.nq]
        for name in model.names[2:]:
            joint = model.joints[model.getJointId(name)]
            if joint.nq != 1:
                raise RobotError(
                    f"{self.robot.description.urdf}: joint {name!r} is no revolute or prismatic joint with limits;"
                    ' in space every joint has one freedom: make it type="revolute" with limits, or type="fixed"'
                )
        frames = []
        for sole in self.robot.soles:
            joint = model.getJointId(sole.joint)
            frames.append(model.addFrame(pin.Frame(f"{sole.side.value}_sole", joint, sole.placement, pin.OP_FRAME)))
        q = np.array(q)
        data = model.createData()
        pin.framesForwardKinematics(model, data, q)
        left, right = (data.oMf[frame].translation for frame in frames)
        q[:3] -= 0.5 * (left + right)
        q.setflags(write=False)
        object.__setattr__(self, "model", model)
        object.__setattr__(self, "locked", light)
        object.__setattr__(self, "posture", q)
        object.__setattr__(self, "sole_frames", tuple(frames))

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle by what it is made of."""
        return FreeRobot, (self.robot,)

    @property
    def name(self) -> str:
        """What the description calls the robot."""
        return self.robot.name

    @property
    def mass(self) -> float:
        """Total mass [kg]."""
        return self.robot.mass

    @property
    def weight(self) -> float:
        """M g [N]."""
        return self.mass * GRAVITY

    @property
    def soles(self) -> Soles:
        """Both soles."""
        return self.robot.soles

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """(n) the joints, in Pinocchio's order, without the root."""
        return tuple(name for name in self.model.names[1:] if name != ROOT)

    @cached_property
    def limits(self) -> JointLimits:
        """What the joints can do, in the order of `joint_names`; inf where the URDF writes a torque or speed of 0.

        Exporters write 0 where they know none; a joint that can neither move nor hold would be no joint.
        """
        lower, upper, velocity, effort = (row[self._rows] for row in self.robot.limits)
        return JointLimits(lower, upper, _none_as_inf(velocity), _none_as_inf(effort))

    @cached_property
    def armature(self) -> FloatArray:
        """(n,) reflected rotor inertia [kg m^2]."""
        return np.array(self.model.armature[BASE:])

    @cached_property
    def _rows(self) -> list[int]:
        names = self.robot.joint_names
        return [names.index(name) for name in self.joint_names]

    def sole_frame(self, side: Stance) -> int:
        """Frame of ``model`` on a foot's sole."""
        return self.sole_frames[0] if side is Stance.LEFT else self.sole_frames[1]

    def leg(self, side: Stance) -> tuple[int, ...]:
        """Indices, among the joints, of a leg from the hip to the ankle roll joint."""
        model, ankle = self.model, self.model.getJointId(self.robot.description.joints[f"{side.value}_ankle"])
        return tuple(model.joints[joint].idx_v - BASE for joint in model.supports[ankle] if joint > 1)


def _none_as_inf(limits: FloatArray) -> FloatArray:
    return np.where(limits > 0.0, limits, np.inf)


def _light_joints(robot: Robot) -> tuple[str, ...]:
    model = robot.model
    data = model.createData()
    pin.forwardKinematics(model, data, robot.posture)
    pin.computeSubtreeMasses(model, data)
    carrying: set[int] = set()
    for name in robot.description.joints.values():
        carrying.update(model.supports[model.getJointId(name)])
    return tuple(
        name
        for name in model.names[2:]
        if (joint := model.getJointId(name)) not in carrying and data.mass[joint] < LIGHT * robot.mass
    )
