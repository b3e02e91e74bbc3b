"""Gait specification: the constraints C01..C09 as data ([O] Sec. IV-A), and the specification file (TOML).

Every key is optional. This file says what an empty one says, but for the ten keys of which leaving out means "free",
or what stands in their comments:

    degree = 5                 # joint Bezier degree; or one for each of stance hip, swing hip, swing ankle
    fri_degree = 3             # FRI Bezier degree
    friction = 0.6             # [C06, C07]
    min_normal_force = 0.1     # of the weight [C06]
    fri_margin = 0.005         # m inside the sole along the phases [C06]; not at the impact, C07 has none
    swing_clearance = 0.01     # m at the reversal, less towards the ground [C05]
    touchdown_speed = 0.05     # m/s, both sole ends [C04]
    min_phase_range = 0.02     # rad, either phase [C02]
    step_duration = [0.4, 0.8] # s [C09]
    step_width = [0.15, 0.35]  # m
    max_pelvis_roll = 0.1      # rad; leave out: free
    max_foot_rotation = 0.3    # rad, of the swing foot; leave out: free
    max_torque = [150.0, 150.0, 150.0, 150.0]  # N m; leave out: the robot's
    max_multiplier = 0.75      # of the return map; leave out: 1 [C01]
    min_energy_margin = 1.0    # energy to spare before tipping outwards, over the orbit's; leave out: free
    max_reversal_shift = 0.003 # rad, by 1 % of post-impact speed; leave out: free
    seed = 0                   # of everything random
    cop_margin_x = 0.02        # m inside toe and heel, of a robot in space; leave out: free
    yaw_friction = 0.6         # coefficient for force and yaw moment together, in space; leave out: free
    travel = 0.1               # m sideways in two steps, wide and narrow in turn; leave out: on the spot
    double_support = [0.1, 0.2] # s on both feet, landing at rest, not with travel; leave out: an instant, an impact

The robot's joint position and velocity limits are kept as well. `default_specification` takes the keys that suit a
robot from the ``[gait]`` table of its description. The three bounds from max_multiplier on ask for robustness;
`design.studies` designs the series that show what each of them costs. cop_margin_x and yaw_friction bound the wrench
that the ground must hold when the whole robot walks the gait in space (`gait.holding_wrench`); they need the length of
the soles. double_support asks for another kind of gait (`gait.support_gait`), for which what bounds an impact means
nothing.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import SpecificationError
from frontal_biped.files.quoted import quoted
from frontal_biped.files.toml import finite_number, load_toml, reject_unknown_keys
from frontal_biped.gait.ranges import SPECIFICATION, require_in_range
from frontal_biped.model.biped import FrontalBiped


@dataclass(frozen=True)
class GaitSpecification:
    """What a gait must satisfy; every key of a specification file, in SI units and radians.

    Attributes:
        degree: degree M of the joint polynomials, at least 3; or one for each of stance hip, swing hip, swing ankle.
        fri_degree: degree of the FRI polynomials, at least 1.
        friction: coefficient of friction [-] (C06, C07).
        min_normal_force: smallest normal force, as a fraction of the weight [-] (C06).
        fri_margin: distance of the FRI from the ends of the sole [m] (C06); the impact (C07) may use all of the sole.
        swing_clearance: height of both sole ends at the reversal [m]; towards lift-off and impact it falls with
            1 - t2, t2 = (beta_r- - beta)/(beta_r- - beta_impact) (C05).
        touchdown_speed: both sole ends descend at least this fast at impact [m/s] (C04).
        min_phase_range: smallest range of beta in either phase [rad] (C02).
        step_duration: shortest and longest step [s] (C09).
        step_width: smallest and largest distance between the ankles, L_s [m].
        max_pelvis_roll: largest rotation of the pelvis [rad]; None: free.
        max_foot_rotation: largest rotation of the swing foot from flat [rad]; None: free.
        max_torque: torque limits of stance ankle, stance hip, swing hip, swing ankle [N m]; None: the robot's.
        max_multiplier: largest multiplier of the return map, below 1 [-]; None: 1 (C01).
        min_energy_margin: energy that may be added after the impact before the robot tips outwards, over the energy
            of the orbit [-]; None: free. See `gait.constraints.energy_margin`.
        max_reversal_shift: displacement of the reversal by 1 % of post-impact speed [rad]; None: free. See
            `gait.constraints.reversal_shift`.
        seed: of everything random.
        cop_margin_x: distance of the holding wrench's centre of pressure from toe and heel [m]; None: free, or 0 with
            ``yaw_friction``. See `gait.holding_wrench`.
        yaw_friction: coefficient of friction that must hold force and yaw moment of the stance sole together [-];
            None: free.
        travel: way sideways in two steps [m], which then differ: the first lands as much wider than the second; None:
            on the spot, all steps alike.
        double_support: shortest and longest time on both feet [s], of a gait that lands at rest and is entered from
            standing (`gait.support_gait`); part of ``step_duration``; None: an instant, with an impact.

    Raises:
        SpecificationError: a value is out of range (see `gait.ranges` also); the message names key and value.
    """

    degree: int | tuple[int, int, int] = 5
    fri_degree: int = 3
    friction: float = 0.6
    min_normal_force: float = 0.1
    fri_margin: float = 0.005
    swing_clearance: float = 0.01
    touchdown_speed: float = 0.05
    min_phase_range: float = 0.02
    step_duration: tuple[float, float] = (0.4, 0.8)
    step_width: tuple[float, float] = (0.15, 0.35)
    max_pelvis_roll: float | None = None
    max_foot_rotation: float | None = None
    max_torque: tuple[float, float, float, float] | None = None
    max_multiplier: float | None = None
    min_energy_margin: float | None = None
    max_reversal_shift: float | None = None
    seed: int = 0
    cop_margin_x: float | None = None
    yaw_friction: float | None = None
    travel: float | None = None
    double_support: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if isinstance(self.degree, tuple | list):
            if len(self.degree) != 3:
                shown = quoted(list(self.degree))
                raise SpecificationError(f"degree = {shown} is neither one number nor a list of 3, one an output")
            object.__setattr__(self, "degree", tuple(self.degree))
        for degree in self.degrees:
            _whole("degree", degree, *_DEGREES)
        _whole("fri_degree", self.fri_degree, 1, 12)
        _whole("seed", self.seed, 0, 2**63 - 1)
        for key, positive in _NUMBERS.items():
            value = finite_number(key, getattr(self, key), SpecificationError)
            if value < 0.0 or (positive and value == 0.0):
                raise SpecificationError(f"{key} = {value:g} must {'be positive' if positive else 'not be negative'}")
            object.__setattr__(self, key, value)
        for key in ("step_duration", "step_width"):
            low_high = _tuple(key, getattr(self, key), 2)
            if not 0.0 < low_high[0] <= low_high[1]:
                raise SpecificationError(
                    f"{key} = {list(low_high)} is not a range; write [smallest, largest], both positive"
                )
            object.__setattr__(self, key, low_high)
        if self.max_pelvis_roll is not None:
            roll = finite_number("max_pelvis_roll", self.max_pelvis_roll, SpecificationError)
            if not 0.0 < roll <= 0.5 * np.pi:
                raise SpecificationError(
                    f"max_pelvis_roll = {roll:g} rad is not in (0, pi/2]; it is an angle in radians"
                )
            object.__setattr__(self, "max_pelvis_roll", roll)
        if self.max_torque is not None:
            torque = _tuple("max_torque", self.max_torque, 4)
            if min(torque) <= 0.0:
                raise SpecificationError(f"max_torque = {list(torque)}: every limit must be positive")
            object.__setattr__(self, "max_torque", torque)

        for key, most in _OPTIONAL.items():
            if getattr(self, key) is not None:
                value = finite_number(key, getattr(self, key), SpecificationError)
                if not 0.0 < value < most:
                    raise SpecificationError(f"{key} = {value:g} is not in (0, {most:g})")
                object.__setattr__(self, key, value)
        if self.cop_margin_x is not None:
            margin = finite_number("cop_margin_x", self.cop_margin_x, SpecificationError)
            if margin < 0.0:
                raise SpecificationError(
                    f"cop_margin_x = {margin:g} must not be negative; 0 lets it go to toe and heel"
                )
            object.__setattr__(self, "cop_margin_x", margin)
        if self.travel is not None:
            travel, (narrowest, widest) = finite_number("travel", self.travel, SpecificationError), self.step_width
            if not 0.0 <= travel <= widest - narrowest + _ROUNDING:
                raise SpecificationError(
                    f"travel = {travel:g} m in two steps is not in [0, {widest - narrowest:g}], the room that"
                    f" step_width = {list(self.step_width)} leaves between a narrow and a wide step; change one of them"
                )
            object.__setattr__(self, "travel", travel)
        if self.double_support is not None:
            low_high = _tuple("double_support", self.double_support, 2)
            if not 0.0 < low_high[0] <= low_high[1]:
                raise SpecificationError(
                    f"double_support = {list(low_high)} is not a range; write [shortest, longest], both positive"
                )
            if self.travel is not None:
                raise SpecificationError(
                    f"double_support = {list(low_high)} and travel = {self.travel:g} do not go together: on both feet a"
                    " gait stays on the spot; leave one of them out"
                )
            object.__setattr__(self, "double_support", low_high)
        for key, allowed in SPECIFICATION.items():
            value = getattr(self, key)
            for part in value if isinstance(value, tuple) else (value,):
                if part is not None:
                    require_in_range(key, part, allowed, SpecificationError)

    def __repr__(self) -> str:
        """What differs from the reference specification."""
        given = [(f.name, getattr(self, f.name)) for f in fields(self) if getattr(self, f.name) != f.default]
        return f"GaitSpecification({', '.join(f'{name}={value!r}' for name, value in given)})"

    @property
    def bounds_holding_wrench(self) -> bool:
        """Does it bound what the ground must hold when the whole robot walks?"""
        return self.cop_margin_x is not None or self.yaw_friction is not None

    @property
    def degrees(self) -> tuple[int, int, int]:
        """Degree of each output: stance hip, swing hip, swing ankle."""
        return self.degree if isinstance(self.degree, tuple) else (self.degree, self.degree, self.degree)

    def torque_limits(self, biped: FrontalBiped) -> FloatArray:
        """(4,) torque limits in the order of the chain [N m]: ``max_torque``, or the robot's."""
        return biped.max_torque if self.max_torque is None else np.asarray(self.max_torque)

    def as_dict(self) -> dict[str, Any]:
        """Keys and values as they stand in a file; keys that are None are left out."""
        plain = {key: list(value) if isinstance(value, tuple) else value for key, value in asdict(self).items()}
        return {key: value for key, value in plain.items() if value is not None}

    @classmethod
    def from_dict(cls, table: Mapping[str, Any], where: str = "specification") -> "GaitSpecification":
        """Specification from keys and values, defaults where it says nothing; ``where`` begins every complaint.

        Raises:
            SpecificationError: a key is unknown, a value of the wrong type or out of range.
        """
        reject_unknown_keys(where, table, [field.name for field in fields(cls)], SpecificationError)
        try:
            values: dict[str, Any] = {key: tuple(v) if isinstance(v, list) else v for key, v in table.items()}
            return cls(**values)
        except SpecificationError as error:
            raise SpecificationError(f"{where}: {error}") from None


def read_specification(path: Path | str) -> GaitSpecification:
    """Read a specification file (TOML); every key is optional.

    Raises:
        SpecificationError: the file is missing or malformed, a key is unknown, a value of the wrong type or range.
    """
    return GaitSpecification.from_dict(load_toml(Path(path), SpecificationError), str(path))


def default_specification(biped: FrontalBiped) -> GaitSpecification:
    """The specification that suits a robot: the ``[gait]`` table of its description, defaults where it says nothing.

    Raises:
        SpecificationError: the table has an unknown key, or a value of the wrong type or range.
    """
    return GaitSpecification.from_dict(biped.description.gait, f"{biped.path}: [gait]")


_ROUNDING = 1e-12
"""Of a difference of step widths [m]: 0.35 - 0.15 is not 0.2."""

_DEGREES = (3, 12)  # below 3 the determined columns meet; above 12 the basis is too ill-conditioned to help

# key: open upper end of its range
_OPTIONAL = {
    "max_foot_rotation": 0.5 * np.pi,
    "max_multiplier": 1.0,
    "min_energy_margin": np.inf,
    "max_reversal_shift": 0.5 * np.pi,
    "yaw_friction": np.inf,
}

# key: must it be strictly positive?
_NUMBERS = {
    "friction": True,
    "min_normal_force": False,
    "fri_margin": False,
    "swing_clearance": False,
    "touchdown_speed": False,
    "min_phase_range": True,
}


def _whole(key: str, value: object, low: int, high: int) -> None:
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise SpecificationError(f"{key} = {quoted(value)} is not a whole number from {low} to {high}")


def _tuple(key: str, value: object, size: int) -> tuple[Any, ...]:
    if not isinstance(value, list | tuple) or len(value) != size:
        raise SpecificationError(f"{key} = {quoted(value)} is not a list of {size} numbers")
    return tuple(finite_number(f"{key}[{i}]", part, SpecificationError) for i, part in enumerate(value))
