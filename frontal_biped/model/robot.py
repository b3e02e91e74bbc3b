"""The whole robot in space: all that a URDF and its description say, before anything is reduced to a plane."""

import sys
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError
from frontal_biped.files.shown import ShownAsPage
from frontal_biped.files.toml import finite_number
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.urdf.description import RobotDescription
from frontal_biped.model.urdf.masses import with_link_masses, with_total_mass
from frontal_biped.model.urdf.read import read_urdf
from frontal_biped.model.urdf.soles import measure_sole
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
class FootSole:
    """The rectangle a foot stands on.

    Its frame hangs on the foot: the origin lies on the sole, straight below the ankle (the origin of the ankle roll
    joint's frame, a point of its axis), when the robot stands upright at its posture with flat feet; X points forward,
    Y to the robot's left, Z up then. The sole is the part of z = 0 with -back <= x <= front and y between the inner
    and the outer edge.

    Attributes:
        side: which foot.
        joint: the ankle roll joint that moves it.
        placement: of the frame in the frame of that joint.
        front: extent from the ankle forwards [m].
        back: extent from the ankle backwards, positive [m].
        inner: extent from the ankle towards the other foot [m].
        outer: extent from the ankle away from the other foot [m].
        ankle_height: of the ankle above the sole [m].
    """

    side: Stance
    joint: str
    placement: pin.SE3
    front: float
    back: float
    inner: float
    outer: float
    ankle_height: float

    @property
    def length(self) -> float:
        """From heel to toe [m]."""
        return self.front + self.back

    @property
    def width(self) -> float:
        """From the inner to the outer edge [m]."""
        return self.inner + self.outer

    @property
    def corners(self) -> FloatArray:
        """(4, 3) outer and inner corner in front, outer and inner corner behind, in the sole's frame [m]."""
        outer, inner = self.side.sign * self.outer, -self.side.sign * self.inner
        return np.array([[x, y, 0.0] for x in (self.front, -self.back) for y in (outer, inner)])


class Soles(NamedTuple):
    """The soles of both feet.

    Attributes:
        left: of the left foot.
        right: of the right foot.
    """

    left: FootSole
    right: FootSole


@dataclass(frozen=True, eq=False)
class Robot(ShownAsPage):
    """A robot in space: every joint of its URDF on a free-flying root, upright at the posture of its description.

    It holds no work data, so threads may share it, and it pickles by content: a robot of a changed description is
    still that robot in another process, whatever has become of the files; only meshes are read when soles are first
    asked for.

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

    def __repr__(self) -> str:
        return f"Robot {self.name!r}: {self.mass:.1f} kg, {len(self.joint_names)} joints; {self.description.path.name}"

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle by content, never by path; soles that were measured travel along, for the meshes may not."""
        measured = {"soles": self.soles} if "soles" in self.__dict__ else {}
        return Robot, (self.description, self.urdf_text), measured

    @classmethod
    def of(cls, description: RobotDescription) -> "Robot":
        """The robot of a description, read from a file or changed since; its URDF is read.

        Raises:
            RobotError: the URDF cannot be used, or the description does not fit it.
        """
        return cls(description, read_urdf(description.urdf))

    def with_mass(self, mass: float | Mapping[str, float]) -> "Robot":
        """The robot with another total mass, or with other masses of some links.

        The bodies keep shape and centre of mass: inertias are scaled with the masses. The files do not change, but the
        `fingerprint` does: a gait designed for the one robot is told from a gait of the other.

        Args:
            mass: of the whole robot [kg]; or of links, by their URDF names [kg], the others left as they are.

        Raises:
            RobotError: there is no such link, it has no mass to scale, or a mass is no positive number; one line.
        """
        where = f"{self.description.path}: with_mass"
        if isinstance(mass, Mapping):
            return Robot(self.description, with_link_masses(self.urdf_text, mass, where))
        return Robot(self.description, with_total_mass(self.urdf_text, mass, where))

    def with_posture(self, posture: Mapping[str, float]) -> "Robot":
        """The robot locked at another posture in the plane, and starting from it in space: `[posture]` changed.

        The files do not change, but the `fingerprint` does.

        Args:
            posture: angles by the joints' URDF names [rad]; the others stay as the description has them.

        Raises:
            RobotError: there is no such joint, or an angle is no number or out of its reach; one line.
        """
        where = f"{self.description.path}: with_posture"
        angles = {name: finite_number(f"{where}: {name}", angle, RobotError) for name, angle in posture.items()}
        return Robot(replace(self.description, posture={**self.description.posture, **angles}), self.urdf_text)

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

    @cached_property
    def soles(self) -> Soles:
        """Both soles; measured on the shapes of the feet where the description does not give ``[sole] front, back``.

        Raises:
            RobotError: there is nothing to measure, or a mesh cannot be read.
        """
        return Soles(*(self._sole(stance) for stance in (Stance.LEFT, Stance.RIGHT)))

    def _sole(self, side: Stance) -> FootSole:
        joint = self.description.joints[f"{side.value}_ankle"]
        sole = self.description.sole
        front, back = sole.front, sole.back
        if front is None or back is None:
            toe, heel = self._measured_ends(joint)
            front = toe if front is None else front
            back = -heel if back is None else back
        placement = self.sole_placement(side)
        return FootSole(side, joint, placement, front, back, sole.inner, sole.outer, sole.ankle_height)

    def sole_placement(self, side: Stance) -> pin.SE3:
        """Placement of the sole's frame in the frame of the ankle roll joint, as `FootSole`; no shape is measured."""
        data = self.model.createData()
        pin.forwardKinematics(self.model, data, self.posture)
        joint = self.model.getJointId(self.description.joints[f"{side.value}_ankle"])
        to_joint = data.oMi[joint].rotation.T
        return pin.SE3(to_joint, to_joint @ np.array([0.0, 0.0, -self.description.sole.ankle_height]))

    def _measured_ends(self, ankle: str) -> tuple[float, float]:
        """X of a foot's toe and heel, from the ankle [m]."""
        description = self.description
        where = f"{description.path}: the length of the sole below {ankle!r} cannot be measured"
        remedy = "give [sole] front, back (m, from the ankle)"
        try:
            measured = measure_sole(self.model, self.posture, ankle, description.urdf, self.urdf_text)
        except RobotError as error:
            raise RobotError(f"{where}, {error}; {remedy}") from None
        if measured is None:
            raise RobotError(f"{where}, the foot has neither collision nor visual shapes; {remedy}")
        if not measured.spans_ankle:
            raise RobotError(
                f"{where}, its shapes reach from {measured.heel:+.3f} to {measured.toe:+.3f} m,"
                f" not to both sides of the ankle; {remedy}"
            )
        return measured.toe, measured.heel

    @property
    def _root_velocities(self) -> int:
        return int(self.model.joints[self.model.getJointId(ROOT)].nv)


def _unlimited_as_inf(values: FloatArray) -> FloatArray:
    """Pinocchio writes the largest float where a URDF sets no limit."""
    return np.where(np.abs(values) < sys.float_info.max, values, np.copysign(np.inf, values))


def _read_only(values: FloatArray) -> FloatArray:
    values.setflags(write=False)
    return values
