"""Two unequal legs, and the pair of mirrored legs half-way between them (HR3).

CAD data are mirrored only nearly: cables, a battery, rounding. The mean of a leg and the mirror image of the other
keeps the robot's mass and the height of its centre of mass; what the paper's theory then sees differs from either leg
by half the difference, which is reported.
"""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.chain import UPRIGHT, FrontalChain, PlanarBody
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.urdf.description import Sole
from frontal_biped.model.urdf.projection import PELVIS, FrontalBodies, RollJoint

ROUNDING = 1e-6
"""Relative difference of the legs that counts as none; a URDF prints at least seven digits."""

MOST_AVERAGED = 0.1
"""Largest relative difference of masses, inertias and lengths that may be averaged away."""


class Difference(NamedTuple):
    """One quantity that left and right do not share.

    Attributes:
        what: the quantity.
        left: its value on the left; for the torso, its distance from the middle.
        right: on the right, mirrored.
        unit: of both.
        relative: difference over a typical size of the quantity.
    """

    what: str
    left: float
    right: float
    unit: str
    relative: float


@dataclass(frozen=True)
class Asymmetry:
    """How unlike the two legs are.

    Attributes:
        mass_matrix: largest difference between D in left and in mirrored right stance, upright, over its largest
            entry [-].
        gravity: largest difference between the gravity torques G of the two [N m].
        bodies: largest relative difference of a mass, an inertia or a length [-].
        differences: quantities that differ by more than rounding, the largest first; joint limits come last.
    """

    mass_matrix: float
    gravity: float
    bodies: float
    differences: tuple[Difference, ...]

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {**asdict(self), "differences": [difference._asdict() for difference in self.differences]}


def asymmetry(bodies: FrontalBodies, sole: Sole) -> Asymmetry:
    """Compare the legs of a robot.

    Args:
        bodies: the robot in its frontal plane.
        sole: of one foot; its height moves nothing here.
    """
    left, right = (_inertia_and_gravity(bodies.chain(sole, stance)) for stance in (Stance.LEFT, Stance.RIGHT))
    masses = sorted(_mass_differences(bodies), key=lambda difference: -difference.relative)
    found = [difference for difference in (*masses, *_limit_differences(bodies)) if difference.relative > ROUNDING]
    return Asymmetry(
        mass_matrix=float(np.max(np.abs(left[0] - right[0])) / np.max(np.abs(left[0]))),
        gravity=float(np.max(np.abs(left[1] - right[1]))),
        bodies=masses[0].relative,
        differences=tuple(found),
    )


def symmetrised(bodies: FrontalBodies) -> FrontalBodies:
    """The robot with the mean leg, its torso in the middle, and of the joint limits what both sides can do.

    Mass and first moment of leg, foot and torso are averaged with their mirror images; so is the moment of inertia
    about the centre of mass.
    """
    middle = bodies.middle

    def mirror(yz: FloatArray) -> FloatArray:
        return np.array([2.0 * middle - yz[0], yz[1]])

    position, body, joint = dict(bodies.position), dict(bodies.body), dict(bodies.joint)
    for part in ("ankle", "hip"):
        left, right = f"left_{part}", f"right_{part}"
        position[left] = 0.5 * (bodies.position[left] + mirror(bodies.position[right]))
        position[right] = mirror(position[left])
        a, b = bodies.body[left], bodies.body[right]
        com = (a.mass * a.com + b.mass * mirror(b.com)) / (a.mass + b.mass)
        body[left] = PlanarBody(0.5 * (a.mass + b.mass), com, 0.5 * (a.inertia + b.inertia))
        body[right] = body[left]._replace(com=mirror(com))
        joint[left] = _common(bodies.joint[left], bodies.joint[right].mirrored())
        joint[right] = joint[left].mirrored()
    pelvis = bodies.body[PELVIS]
    body[PELVIS] = pelvis._replace(com=np.array([middle, pelvis.com[1]]))
    return FrontalBodies(position, body, joint)


def _common(a: RollJoint, b: RollJoint) -> RollJoint:
    return RollJoint(
        lower=max(a.lower, b.lower),
        upper=min(a.upper, b.upper),
        velocity=min(a.velocity, b.velocity),
        effort=min(a.effort, b.effort),
        armature=0.5 * (a.armature + b.armature),
    )


def _inertia_and_gravity(chain: FrontalChain) -> tuple[FloatArray, FloatArray]:
    model = chain.pinned_model()
    data = model.createData()
    upright = np.full(4, UPRIGHT)
    return pin.crba(model, data, upright).copy(), pin.computeGeneralizedGravity(model, data, upright).copy()


def _mass_differences(bodies: FrontalBodies) -> Iterator[Difference]:
    middle, length = bodies.middle, max(bodies.leg_length, 1e-3)

    def differ(what: str, left: float, right: float, unit: str, scale: float) -> Difference:
        return Difference(what, float(left), float(right), unit, float(abs(left - right) / scale))

    for part in ("hip", "ankle"):
        left, right = bodies.position[f"left_{part}"], bodies.position[f"right_{part}"]
        yield differ(f"the distance of the {part} from the middle", left[0] - middle, middle - right[0], "m", length)
        yield differ(f"the height of the {part}", left[1], right[1], "m", length)
    for moved_by, link in (("hip", "leg"), ("ankle", "foot")):
        a, b = bodies.body[f"left_{moved_by}"], bodies.body[f"right_{moved_by}"]
        yield differ(f"the mass of the {link}", a.mass, b.mass, "kg", a.mass)
        yield differ(f"the inertia of the {link}", a.inertia, b.inertia, "kg m^2", a.inertia + a.mass * length**2)
        yield differ(f"y of the {link}'s centre of mass", a.com[0] - middle, middle - b.com[0], "m", length)
        yield differ(f"z of the {link}'s centre of mass", a.com[1], b.com[1], "m", length)
    torso = float(bodies.body[PELVIS].com[0] - middle)
    yield differ("the distance of the torso's centre of mass", torso, -torso, "m", length)


def _limit_differences(bodies: FrontalBodies) -> Iterator[Difference]:
    names = {"effort": ("max torque", "N m"), "velocity": ("max velocity", "rad/s"), "armature": ("armature", "kg m^2")}
    names |= {"lower": ("lower limit", "rad"), "upper": ("upper limit", "rad")}
    for part in ("ankle", "hip"):
        left, right = bodies.joint[f"left_{part}"], bodies.joint[f"right_{part}"].mirrored()
        for field, (what, unit) in names.items():
            a, b = getattr(left, field), getattr(right, field)
            if a != b:
                yield Difference(f"the {what} of the {part}", a, b, unit, abs(a - b) / max(abs(a), abs(b)))
