"""Between which values the numbers of a gait file and of a gait specification make sense.

The ranges are generous: no robot that walks comes near their ends. They keep out what is a slip of the keyboard or of
another program, and what would only come to light later, as a division by nothing, an overflow or a search without end.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

from frontal_biped.exceptions import FrontalBipedError

MOST_COEFFICIENTS = 31
"""Of a Bezier polynomial, that is degree 30.

A phase is followed past its end, up to s = 2, where the sum of the Bernstein polynomials' absolute values is 3^degree.
Coefficients of a radian, rounded to 1e-16, are there worth 0.02 rad at degree 30, and nothing any more at 34. Designs
have at most 12.
"""


class Range(NamedTuple):
    """Both ends belong to it.

    Attributes:
        low: smallest value.
        high: largest value.
        unit: of both.
    """

    low: float
    high: float
    unit: str


_SMALL = 1e-9  # of what must be positive, and is divided by

SPECIFICATION: Mapping[str, Range] = {
    "friction": Range(1e-6, 1000.0, "(coefficient)"),
    "min_normal_force": Range(0.0, 10.0, "(of the weight)"),  # its mean over a step is one weight
    "fri_margin": Range(0.0, 1.0, "m"),
    "swing_clearance": Range(0.0, 1.0, "m"),
    "touchdown_speed": Range(0.0, 10.0, "m/s"),
    "min_phase_range": Range(_SMALL, math.pi, "rad"),
    "step_duration": Range(1e-3, 60.0, "s"),
    "step_width": Range(1e-6, 10.0, "m"),
    "max_pelvis_roll": Range(_SMALL, 0.5 * math.pi, "rad"),
    "max_foot_rotation": Range(_SMALL, 0.5 * math.pi, "rad"),
    "max_torque": Range(1e-6, 1e6, "N m"),
    "max_multiplier": Range(_SMALL, 1.0, "(of the return map)"),
    "min_energy_margin": Range(_SMALL, 1e6, "(of the orbit's energy)"),
    "max_reversal_shift": Range(_SMALL, 0.5 * math.pi, "rad"),
    "cop_margin_x": Range(0.0, 1.0, "m"),
    "yaw_friction": Range(1e-6, 1000.0, "(coefficient)"),
    "travel": Range(0.0, 10.0, "m"),
    "double_support": Range(1e-3, 2.0, "s"),
}
"""By the keys of a specification; those of a list hold for each of its numbers."""

GAIT: Mapping[str, Range] = {
    # the ankles' line and the hip: the stance leg points above the ground from -pi to 0
    "beta_start": Range(-math.pi, 0.0, "rad"),
    "beta_end": Range(-math.pi, 0.0, "rad"),
    # angles stay within a turn; coefficients between which they are interpolated reach farther, the less the farther
    "joint_bezier": Range(-1000.0, 1000.0, "rad"),
    "fri_bezier": Range(-1000.0, 1000.0, "m"),
    "step_width": Range(1e-6, 10.0, "m"),
    "beta_dot_after_impact": Range(1e-9, 1e3, "rad/s"),
    "zeta_f_star": Range(1e-12, 1e12, "kg^2 m^4/s^2"),
    "step_duration": Range(1e-3, 1e3, "s"),
    "cost": Range(1e-12, 1e18, "N^2 m s"),
    "multiplier": Range(1e-12, 1e6, "[-]"),
    # of gaits with a finite double support
    "double_support": Range(1e-3, 1e3, "s"),
    "setting_off": Range(1e-3, 1e3, "s"),
    "pressure_margin": Range(0.0, 0.1, "m"),
}
"""By the fields of a gait file."""


def require_in_range(where: str, value: float, allowed: Range, error: type[FrontalBipedError]) -> None:
    """Raise ``error`` where a number lies outside of its range; ``where`` begins the complaint."""
    if not allowed.low <= value <= allowed.high:
        which = f"below {allowed.low:g}" if value < allowed.low else f"above {allowed.high:g}"
        raise error(
            f"{where} = {value:g} is {which} {allowed.unit}; give the true value, between {allowed.low:g} and"
            f" {allowed.high:g}"
        )
