"""The whole robot in space: all that a URDF and its description say, before anything is reduced to a plane."""

import sys
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.urdf.description import RobotDescription
from frontal_biped.model.urdf.read import read_urdf
from frontal_biped.model.urdf.whole_model import ROOT, build_described_model, posture_configuration


class JointLimits(NamedTuple):
    """What the joints can do; a row for each velocity of the model behind the root's six, in its order.

    A joint of one freedom has one row, so the rows are those of `Robot.joint_names` unless a URDF has planar or
    floating joints.

    Attributes:
        lower: (n,) lowest position [rad or m]; -inf where the URDF sets none, and for joints whose position is no
            single number.
        upper: (n,) highest position [rad or m]; inf likewise.
        velocity: (n,) largest speed [rad/s or m/s].
        effort: (n,) largest torque [N m] or force [N]; the description's ``[limits]`` at the four roll joints.
    """

    lower: FloatArray
    upper: FloatArray
    velocity: FloatArray
    effort: FloatArray


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot in space: every joint of its URDF on a free-flying root, upright at the posture of its description.

    It holds no work data, so threads may share it, and it pickles by content: a robot of a changed description is
    still that robot in another process, whatever has become of the files.

    Attributes:
        description: what the description file says, or that changed since.
        urdf_text: the URDF itself, already checked by `read_urdf`.
        model: 3D Pinocchio model with a free-flyer root and every joint; torque limits and reflected rotor inertia of
            the four roll joints are the description's. Not to be changed.
        posture: (nq,) configuration of ``model`` at the description's posture, the root link at the origin.

    Raises:
        RobotError: Pinocchio cannot read the URDF, a joint that the description names does not exist, or the posture
            is out of a joint's reach.
    """

    description: RobotDescription
    urdf_text: str = field(repr=False)
    model: pin.Model = field(init=False, repr=False)
    posture: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        model = build_described_model(self.description, self.urdf_text)
        object.__setattr__(self, "model", model)
        object.__setattr__(self, "posture", _read_only(posture_configuration(model, self.description)))

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle by content, never by path."""
        return Robot, (self.description, self.urdf_text)

    @classmethod
    def of(cls, description: RobotDescription) -> "Robot":
        """The robot of a description, read from a file or changed since; its URDF is read.

        Raises:
            RobotError: the URDF cannot be used, or the description does not fit it.
        """
        return cls(description, read_urdf(description.urdf))

    @property
    def name(self) -> str:
        """What the description calls the robot."""
        return self.description.name

    @cached_property
    def fingerprint(self) -> str:
        """SHA-256 of the URDF and of what in the description shapes the planar model; gait files keep it."""
        return self.description.fingerprint(self.urdf_text)

    @cached_property
    def mass(self) -> float:
        """Total mass [kg]."""
        return float(pin.computeTotalMass(self.model))

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """Every movable joint but the root, in Pinocchio's order."""
        return tuple(name for name in self.model.names[1:] if name != ROOT)

    @cached_property
    def limits(self) -> JointLimits:
        """What the joints can do."""
        model, behind_root = self.model, self._root_velocities
        lower, upper = np.full(model.nv, -np.inf), np.full(model.nv, np.inf)
        for name in self.joint_names:
            joint = model.joints[model.getJointId(name)]
            if joint.nq == joint.nv:
                velocities = slice(joint.idx_v, joint.idx_v + joint.nv)
                positions = slice(joint.idx_q, joint.idx_q + joint.nq)
                lower[velocities] = model.lowerPositionLimit[positions]
                upper[velocities] = model.upperPositionLimit[positions]
        rows = (lower, upper, model.velocityLimit, model.effortLimit)
        return JointLimits(*(_read_only(_unlimited_as_inf(row[behind_root:])) for row in rows))

    @cached_property
    def armature(self) -> FloatArray:
        """(n,) reflected rotor inertia, rows as in `JointLimits` [kg m^2]; 0 where the description tells none."""
        return _read_only(np.array(self.model.armature[self._root_velocities :]))

    @property
    def _root_velocities(self) -> int:
        return int(self.model.joints[self.model.getJointId(ROOT)].nv)


def _unlimited_as_inf(values: FloatArray) -> FloatArray:
    """Pinocchio writes the largest float where a URDF sets no limit."""
    return np.where(np.abs(values) < sys.float_info.max, values, np.copysign(np.inf, values))


def _read_only(values: FloatArray) -> FloatArray:
    values.setflags(write=False)
    return values
