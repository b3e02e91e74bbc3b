"""A robot that is not quite the one in its files: errors of mass, centre of mass, inertia and leg length, link by link.

The errors may differ from left to right, as on a real robot. The relabelling at impact then also exchanges two
slightly different mechanisms, so a perturbed robot is a pair, one for each stance foot; see `Plant`.
"""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.urdf.description import ROLL_JOINTS
from frontal_biped.model.urdf.projection import PELVIS, FrontalBodies
from frontal_biped.model.urdf.symmetry import symmetrised

LINKS = ("left_foot", "left_leg", "pelvis", "right_leg", "right_foot")
"""The links of the planar chain from left to right: the order of every array of `ModelErrors`."""

LEGS = ("left_leg", "right_leg")
"""The order of `ModelErrors.length`."""

_MOVED_BY = dict(zip(LINKS, (ROLL_JOINTS[0], ROLL_JOINTS[1], PELVIS, ROLL_JOINTS[2], ROLL_JOINTS[3]), strict=True))


@dataclass(frozen=True, eq=False)
class ModelErrors:
    """How the true robot differs from its model; the default is not at all.

    Attributes:
        mass: (5,) factors, in the order of `LINKS` [-]. The inertia about the link's own CoM is not scaled with it.
        com: (5, 2) shifts of the centres of mass in (y, z), Y left and Z up, at the reference posture [m].
        inertia: (5,) factors of the inertias about the link's own centre of mass [-].
        length: (2,) factors of the distance from hip to ankle, left and right leg [-]. Ankle and foot move with it;
            the leg's centre of mass keeps its place below the hip.

    Raises:
        RobotError: a wrong shape, or a factor that is not positive.
    """

    mass: FloatArray = field(default_factory=lambda: np.ones(len(LINKS)))
    com: FloatArray = field(default_factory=lambda: np.zeros((len(LINKS), 2)))
    inertia: FloatArray = field(default_factory=lambda: np.ones(len(LINKS)))
    length: FloatArray = field(default_factory=lambda: np.ones(len(LEGS)))

    def __post_init__(self) -> None:
        for name, shape in (("mass", (5,)), ("com", (5, 2)), ("inertia", (5,)), ("length", (2,))):
            array = np.array(getattr(self, name), dtype=float)
            if array.shape != shape:
                raise RobotError(f"ModelErrors: {name} has shape {array.shape}; give {shape}, in the order of LINKS")
            if not np.all(np.isfinite(array)) or (name != "com" and np.any(array <= 0.0)):
                wanted = "finite shifts in m" if name == "com" else "positive factors, 1 for no error"
                raise RobotError(f"ModelErrors: {name} = {array.tolist()}; give {wanted}")
            object.__setattr__(self, name, array)

    @classmethod
    def draw(
        cls,
        generator: np.random.Generator,
        *,
        mass: float = 0.0,
        com: float = 0.0,
        inertia: float = 0.0,
        length: float = 0.0,
    ) -> "ModelErrors":
        """Random errors, every link and side on its own, uniform within the given bounds.

        Args:
            generator: of the draws; the same one draws the same errors whichever bounds are zero.
            mass: largest relative error of each mass, below 1 [-].
            com: largest shift of each centre of mass, in y and in z alike [m].
            inertia: largest relative error of each inertia, below 1 [-].
            length: largest relative error of each leg's length, below 1 [-].
        """
        sizes = {"mass": (5,), "com": (5, 2), "inertia": (5,), "length": (2,)}
        unit = {name: generator.uniform(-1.0, 1.0, shape) for name, shape in sizes.items()}
        return cls(
            mass=1.0 + mass * unit["mass"],
            com=com * unit["com"],
            inertia=1.0 + inertia * unit["inertia"],
            length=1.0 + length * unit["length"],
        )

    @property
    def any(self) -> bool:
        """Is there any error at all?"""
        return bool(np.any(self.com)) or any(np.any(a != 1.0) for a in (self.mass, self.inertia, self.length))

    def times(self, other: "ModelErrors") -> "ModelErrors":
        """Both errors at once: factors multiply, shifts add."""
        return ModelErrors(
            self.mass * other.mass, self.com + other.com, self.inertia * other.inertia, self.length * other.length
        )

    def as_dict(self) -> dict[str, list[float]]:
        """Plain lists, for files."""
        return {name: getattr(self, name).tolist() for name in ("mass", "com", "inertia", "length")}

    @classmethod
    def from_dict(cls, table: Mapping[str, list[float]]) -> "ModelErrors":
        """The inverse of `as_dict`."""
        return cls(**{name: np.array(values) for name, values in table.items()})


class PerturbedBiped(FrontalBiped):
    """A robot with errors, standing on one foot: its dynamics are the plant's, its name and limits the model's.

    Args:
        nominal: the robot of the files.
        errors: how this one differs.
        stance: the foot it stands on; its q is that of the nominal robot on the same foot.
    """

    def __init__(self, nominal: FrontalBiped, errors: ModelErrors, stance: Stance) -> None:
        bodies = _perturbed_bodies(symmetrised(nominal.measured), errors)
        reduction = nominal.reduction._replace(chain=bodies.chain(nominal.description.sole, stance), measured=bodies)
        content = f"{nominal.fingerprint} {errors.as_dict()} {stance.value}"
        super().__init__(nominal.robot, reduction, hashlib.sha256(content.encode()).hexdigest())
        self.nominal, self.errors, self.stance = nominal, errors, stance

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle by what it is made of."""
        return PerturbedBiped, (self.nominal, self.errors, self.stance)


def perturbed(biped: FrontalBiped, errors: ModelErrors, stance: Stance = Stance.LEFT) -> FrontalBiped:
    """The robot with errors, standing on one foot.

    Args:
        biped: the robot of the files.
        errors: how the true one differs.
        stance: the foot it stands on; where the errors differ from left to right the two robots do.

    Returns:
        The plant; a controller keeps ``biped``.
    """
    return PerturbedBiped(biped, errors, stance)


@dataclass(frozen=True)
class Plant:
    """What is simulated: the robot on either foot; the same one twice where the legs are mirror images.

    Attributes:
        left: standing on the left foot.
        right: standing on the right foot.
    """

    left: FrontalBiped
    right: FrontalBiped

    @classmethod
    def of(cls, biped: FrontalBiped, errors: ModelErrors | None = None) -> "Plant":
        """The plant of a robot, with or without errors."""
        if errors is None or not errors.any:
            return cls(biped, biped)
        return cls(perturbed(biped, errors, Stance.LEFT), perturbed(biped, errors, Stance.RIGHT))

    def on(self, stance: Stance) -> FrontalBiped:
        """The robot standing on a foot."""
        return self.left if stance is Stance.LEFT else self.right


def _perturbed_bodies(bodies: FrontalBodies, errors: ModelErrors) -> FrontalBodies:
    position, body = dict(bodies.position), dict(bodies.body)
    for i, link in enumerate(LINKS):
        key = _MOVED_BY[link]
        body[key] = body[key]._replace(
            mass=body[key].mass * float(errors.mass[i]),
            com=body[key].com + errors.com[i],
            inertia=body[key].inertia * float(errors.inertia[i]),
        )
    for i, side in enumerate(("left", "right")):
        hip, ankle = position[f"{side}_hip"], position[f"{side}_ankle"]
        shift = (float(errors.length[i]) - 1.0) * (ankle - hip)
        position[f"{side}_ankle"] = ankle + shift
        body[f"{side}_ankle"] = body[f"{side}_ankle"]._replace(com=body[f"{side}_ankle"].com + shift)
    return replace(bodies, position=position, body=body)
