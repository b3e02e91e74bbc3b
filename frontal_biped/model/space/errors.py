"""A robot in space that is not quite the one in its files: errors of mass, centre of mass and inertia, body by body."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError


@dataclass(frozen=True, eq=False)
class SpatialErrors:
    """How the true robot differs from its model.

    A body is all that one joint moves before the next; bodies come in the order root link, `FreeRobot.joint_names`.

    Attributes:
        mass: (1 + n,) factors [-]. The inertia about a body's own centre of mass is not scaled with it.
        com: (1 + n, 3) shifts of the centres of mass, in the axes of the body's joint [m].
        inertia: (1 + n,) factors of the inertias about the body's own centre of mass [-].

    Raises:
        RobotError: shapes that do not go together, or a factor that is not positive.
    """

    mass: FloatArray
    com: FloatArray
    inertia: FloatArray

    def __post_init__(self) -> None:
        bodies = len(np.asarray(self.mass))
        for name, shape in (("mass", (bodies,)), ("com", (bodies, 3)), ("inertia", (bodies,))):
            array = np.array(getattr(self, name), dtype=float)
            if array.shape != shape:
                raise RobotError(f"SpatialErrors: {name} has shape {array.shape}; give {shape}, body by body")
            if not np.all(np.isfinite(array)) or (name != "com" and np.any(array <= 0.0)):
                wanted = "finite shifts in m" if name == "com" else "positive factors, 1 for no error"
                raise RobotError(f"SpatialErrors: {name} = {array.tolist()}; give {wanted}")
            object.__setattr__(self, name, array)

    @classmethod
    def none(cls, bodies: int) -> "SpatialErrors":
        """No error at all, of a number of bodies."""
        return cls(np.ones(bodies), np.zeros((bodies, 3)), np.ones(bodies))

    @classmethod
    def draw(
        cls, generator: np.random.Generator, bodies: int, *, mass: float = 0.0, com: float = 0.0, inertia: float = 0.0
    ) -> "SpatialErrors":
        """Random errors, every body on its own, uniform within the given bounds.

        Args:
            generator: of the draws; the same one draws the same errors whichever bounds are zero.
            bodies: how many, 1 + n.
            mass: largest relative error of each mass, below 1 [-].
            com: largest shift of each centre of mass along each axis [m].
            inertia: largest relative error of each inertia, below 1 [-].
        """
        unit = [generator.uniform(-1.0, 1.0, shape) for shape in ((bodies,), (bodies, 3), (bodies,))]
        return cls(1.0 + mass * unit[0], com * unit[1], 1.0 + inertia * unit[2])

    @property
    def any(self) -> bool:
        """Is there any error at all?"""
        return bool(np.any(self.com) or np.any(self.mass != 1.0) or np.any(self.inertia != 1.0))

    def as_dict(self) -> dict[str, list[float]]:
        """Plain lists, for files."""
        return {name: getattr(self, name).tolist() for name in ("mass", "com", "inertia")}

    @classmethod
    def from_dict(cls, table: Mapping[str, list[float]]) -> "SpatialErrors":
        """The inverse of `as_dict`."""
        return cls(**{name: np.array(values) for name, values in table.items()})
