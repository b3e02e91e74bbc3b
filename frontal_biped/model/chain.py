"""The planar open chain foot, leg, pelvis, leg, foot: its numbers, and the two Pinocchio models built from them.

Frame: (h, v) of the paper with the right-handed third axis out of the plane; h points from the stance foot
towards the swing foot, v up, origin on the ground below the stance ankle. A joint frame is turned by +pi/2 from
its parent's link frame, so Pinocchio's joint angles *are* the paper's: all four are -pi/2 when upright, and
every link frame is then aligned with (h, v).
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray

UPRIGHT = -0.5 * np.pi
GRAVITY = 9.81  # [m/s^2]

JOINTS = ("stance ankle", "stance hip", "swing hip", "swing ankle")
"""The chain's joints in words, q1 to q4."""


class PlanarBody(NamedTuple):
    """Mass properties of one link in the frontal plane.

    Attributes:
        mass: [kg].
        com: (2,) centre of mass in (h, v) at the upright reference [m].
        inertia: about the centre of mass, out of the plane [kg m^2].
    """

    mass: float
    com: FloatArray
    inertia: float


@dataclass(frozen=True)
class FrontalChain:
    """The biped at the upright reference, seen with either foot as the stance foot (HR3: they are mirrored).

    Attributes:
        joints: (4, 2) positions of stance ankle, stance hip, swing hip, swing ankle in (h, v) [m].
        bodies: stance foot, stance leg, pelvis (with everything it carries), swing leg, swing foot.
        sole_inner: extent of a sole from the ankle towards the other foot [m].
        sole_outer: extent of a sole from the ankle away from the other foot [m].
        armature: (4,) reflected rotor inertias, chain order [kg m^2].
        max_torque: (4,) torque limits, chain order [N m].
        lower: (4,) lower joint limits in stance coordinates [rad].
        upper: (4,) upper joint limits in stance coordinates [rad].
        max_velocity: (4,) joint velocity limits [rad/s].
    """

    joints: FloatArray
    bodies: tuple[PlanarBody, PlanarBody, PlanarBody, PlanarBody, PlanarBody]
    sole_inner: float
    sole_outer: float
    armature: FloatArray
    max_torque: FloatArray
    lower: FloatArray
    upper: FloatArray
    max_velocity: FloatArray

    @property
    def ankle_height(self) -> float:
        """Height of the ankles above the soles [m]."""
        return float(self.joints[0, 1])

    @property
    def mass(self) -> float:
        """Mass of the whole robot, both feet included [kg]."""
        return float(sum(body.mass for body in self.bodies))

    def pinned_model(self) -> pin.Model:
        """Pinocchio model of the four moving links, stance foot fixed; q is the paper's q."""
        model = _empty_model("pinned")
        self._append_chain(model, parent=0)
        model.armature = self.armature.copy()
        return model

    def floating_model(self) -> pin.Model:
        """Pinocchio model of all five links: stance foot free in the plane (h, v, rotation), then q.

        The base turns about the ground point below the stance ankle, so with the foot at rest the first three
        generalized forces are the ground reaction F_h, F_v and its moment about that point.
        """
        model = _empty_model("floating")
        identity = pin.SE3.Identity()
        base = model.addJoint(0, pin.JointModelPX(), identity, "foot_h")
        base = model.addJoint(base, pin.JointModelPY(), identity, "foot_v")
        base = model.addJoint(base, pin.JointModelRZ(), identity, "foot_rotation")
        return self._on_base(model, base)

    def planar_base_model(self) -> pin.Model:
        """`floating_model` with its base in one joint: the same forces of a foot at rest, in less time.

        A configuration is h, v, cosine and sine of the foot's rotation, then q.
        """
        model = _empty_model("planar_base")
        return self._on_base(model, model.addJoint(0, pin.JointModelPlanar(), pin.SE3.Identity(), "foot"))

    def _on_base(self, model: pin.Model, base: int) -> pin.Model:
        """All five links on a base of three freedoms."""
        model.appendBodyToJoint(base, _inertia(self.bodies[0], np.zeros(2)), pin.SE3.Identity())
        self._append_chain(model, base)
        model.armature = np.concatenate([np.zeros(3), self.armature])
        return model

    def _append_chain(self, model: pin.Model, parent: int) -> None:
        quarter_turn = pin.utils.rotate("z", 0.5 * np.pi)
        origin = np.zeros(2)
        names = ("stance_ankle", "stance_hip", "swing_hip", "swing_ankle")
        for i, (name, position, body) in enumerate(zip(names, self.joints, self.bodies[1:], strict=True)):
            # the parent's frame is aligned with (h, v) when upright, its origin at the previous joint
            placement = pin.SE3(quarter_turn, _lift(position - origin))
            parent = model.addJoint(parent, pin.JointModelRZ(), placement, name)
            model.appendBodyToJoint(parent, _inertia(body, position), pin.SE3.Identity())
            model.lowerPositionLimit[-1], model.upperPositionLimit[-1] = self.lower[i], self.upper[i]
            origin = position
        # inner lies towards the stance foot, that is towards -h
        for label, offset in (("inner", -self.sole_inner), ("outer", self.sole_outer)):
            at_sole = pin.SE3(np.eye(3), np.array([offset, -self.ankle_height, 0.0]))
            model.addFrame(pin.Frame(f"swing_sole_{label}", parent, at_sole, pin.FrameType.OP_FRAME))


def _empty_model(name: str) -> pin.Model:
    model = pin.Model()
    model.name = name
    model.gravity.linear = np.array([0.0, -GRAVITY, 0.0])
    return model


def _lift(planar: FloatArray) -> FloatArray:
    return np.array([planar[0], planar[1], 0.0])


def _inertia(body: PlanarBody, origin: FloatArray) -> pin.Inertia:
    # only the out-of-plane component enters a planar motion; the other two repeat it
    return pin.Inertia(body.mass, _lift(body.com - origin), body.inertia * np.eye(3))
