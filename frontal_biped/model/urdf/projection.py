"""A robot's mass, joints and limits in its frontal plane, as measured and still unequal on left and right.

Only mass, (y, z) of the centre of mass and the moment of inertia about X of each body enter a motion in the
frontal plane; the projection is therefore exact, not an approximation, once the four axes are along X.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.chain import UPRIGHT, FrontalChain, PlanarBody
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.urdf.description import ROLL_JOINTS, Sole

PELVIS = "pelvis"


class RollJoint(NamedTuple):
    """Limits of one roll joint, angles about +X from the reference posture.

    Attributes:
        lower: [rad].
        upper: [rad].
        velocity: largest speed [rad/s].
        effort: largest torque [N m].
        armature: reflected rotor inertia [kg m^2].
    """

    lower: float
    upper: float
    velocity: float
    effort: float
    armature: float

    def mirrored(self) -> "RollJoint":
        """The same joint seen in the mirror: +X turns the other way."""
        return self._replace(lower=-self.upper, upper=-self.lower)


@dataclass(frozen=True)
class FrontalBodies:
    """What the frontal plane sees of a robot at its posture; (y, z) in the room, Y left, Z up.

    Attributes:
        position: (2,) of each roll joint [m], by `ROLL_JOINTS`.
        body: pelvis, and the body that each roll joint moves (hips: legs, ankles: feet), centres of mass in (y, z).
        joint: limits of each roll joint.
    """

    position: Mapping[str, FloatArray]
    body: Mapping[str, PlanarBody]
    joint: Mapping[str, RollJoint]

    @property
    def middle(self) -> float:
        """Y of the mirror plane: half-way between the hips [m]."""
        return 0.5 * (self.position["left_hip"][0] + self.position["right_hip"][0])

    @property
    def leg_length(self) -> float:
        """Height of the hips above the ankles, mean of both sides [m]."""
        legs = [self.position[f"{side}_hip"] - self.position[f"{side}_ankle"] for side in ("left", "right")]
        return float(np.mean([leg[1] for leg in legs]))

    def chain(self, sole: Sole, stance: Stance = Stance.LEFT) -> FrontalChain:
        """The open chain with one foot as the stance foot; the two differ where the legs do."""
        order = ROLL_JOINTS if stance is Stance.LEFT else ROLL_JOINTS[::-1]
        side = stance.sign
        foot = self.position[order[0]]
        ground = foot[1] - sole.ankle_height

        def to_plane(yz: FloatArray) -> FloatArray:
            return np.array([side * (foot[0] - yz[0]), yz[1] - ground])

        bodies = [self.body[key] for key in (order[0], order[1], PELVIS, order[2], order[3])]
        # S of the stance map: whichever foot stands, q grows with the left angles and falls with the right ones
        joints = [self.joint[key] if key.startswith("left") else self.joint[key].mirrored() for key in order]
        return FrontalChain(
            joints=np.array([to_plane(self.position[key]) for key in order]),
            bodies=tuple(b._replace(com=to_plane(b.com)) for b in bodies),  # type: ignore[arg-type]
            sole_inner=sole.inner,
            sole_outer=sole.outer,
            armature=np.array([joint.armature for joint in joints]),
            max_torque=np.array([joint.effort for joint in joints]),
            lower=UPRIGHT + np.array([joint.lower for joint in joints]),
            upper=UPRIGHT + np.array([joint.upper for joint in joints]),
            max_velocity=np.array([joint.velocity for joint in joints]),
        )


def planar_inertia(model: pin.Model, data: pin.Data, joint: int) -> PlanarBody:
    """Mass, (y, z) of the centre of mass and moment about X of the body a joint moves; kinematics are in ``data``."""
    inertia = data.oMi[joint].act(model.inertias[joint])
    return PlanarBody(float(inertia.mass), inertia.lever[1:].copy(), float(inertia.inertia[0, 0]))
