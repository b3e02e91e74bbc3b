"""Random bipeds and gait specifications, many of them with bounds that bind: each is drawn again from its number."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from robot_files import write_robot

from frontal_biped.gait import GaitSpecification
from frontal_biped.model import FrontalBiped, load_robot

SEED = 1904
"""Of every draw, beside the number of the case."""


class RandomCase(NamedTuple):
    """A biped and what is asked of its gait."""

    biped: FrontalBiped
    specification: GaitSpecification


def random_case(number: int, folder: Path) -> RandomCase:
    """Biped and specification of a number; URDF and description are written to the folder.

    Sizes range from half to 1.4 times the robot of Table I; masses, lengths and soles vary by a third and more around
    it. Three in ten have feet of 2 to 4 cm at its size, half have their ankles above the sole, four in ten have joints
    that turn by no more than 0.06 to 0.35 rad. Every bound of the specification is drawn around what such a robot
    does, so that some contradict each other.
    """
    rng = np.random.default_rng([SEED, number])
    size = rng.uniform(0.5, 1.4)
    parameters = _parameters(rng, size)
    biped = load_robot(write_robot(folder, f"biped_{number}", parameters))
    return RandomCase(biped, _specification(rng, size, parameters))


def _parameters(rng: np.random.Generator, size: float) -> dict[str, float]:
    mass, length = size**3, 0.8 * size * rng.uniform(0.85, 1.15)
    width = round(0.2 * size * rng.uniform(0.75, 1.4), 4)  # its half, tx, is rounded below and must not change
    torso, leg, foot = mass * rng.uniform([20.0, 6.0, 0.2], [50.0, 16.0, 2.0])
    trunk = rng.uniform(0.0, 0.3) * size
    narrow, raised, limited = rng.random(3) < (0.3, 0.5, 0.4)
    inner, outer = size * rng.uniform(0.01, 0.02, 2) if narrow else size * rng.uniform(0.03, 0.07, 2)
    height = size * rng.uniform(0.02, 0.12) if raised else 0.0
    drawn = {
        "L": length,
        "W": width,
        "leg_com": length * rng.uniform(0.15, 0.5),
        "leg_lat": size * rng.uniform(-0.015, 0.015),
        "tx": 0.5 * width,
        "ty": trunk,
        "ml": leg,
        "mt": torso,
        "mf": foot,
        "Jl": leg * (length * rng.uniform(0.18, 0.3)) ** 2,
        "Jt": torso * (size * rng.uniform(0.2, 0.4)) ** 2,
        "Jf": foot * (size * rng.uniform(0.03, 0.06)) ** 2,
        "e_in": inner,
        "e_out": outer,
        "ha": height,
        "fx": size * rng.uniform(-0.01, 0.01),
        "fy": height * rng.uniform(0.0, 1.0),
        "effort": 150.0 * size**4 * rng.uniform(0.3, 1.0),
    }
    if limited:
        limits = rng.uniform(0.06, 0.35, 4).tolist()
        drawn |= dict(zip(("hip_in", "hip_out", "ankle_in", "ankle_out"), limits, strict=True))
    return {key: round(float(value), 5) for key, value in drawn.items()}


def _specification(rng: np.random.Generator, size: float, parameters: dict[str, float]) -> GaitSpecification:
    sole = parameters["e_in"] + parameters["e_out"]
    duration = rng.uniform(0.3, 0.55) * np.sqrt(size)
    width = parameters["W"] * rng.uniform(0.8, 1.3)
    asked = rng.random(3) < (0.5, 0.4, 0.3)
    roll, turn, multiplier = rng.uniform([0.03, 0.05, 0.55], [0.2, 0.4, 0.95])
    return GaitSpecification(
        degree=int(rng.integers(4, 7)),
        friction=round(rng.uniform(0.2, 0.9), 3),
        min_normal_force=round(rng.uniform(0.05, 0.5), 3),
        fri_margin=round(sole * rng.uniform(0.02, 0.25), 4),
        swing_clearance=round(size * rng.uniform(0.003, 0.025), 4),
        touchdown_speed=round(rng.uniform(0.01, 0.12), 3),
        min_phase_range=round(rng.uniform(0.01, 0.03), 3),
        step_duration=(round(duration, 3), round(duration + rng.uniform(0.03, 0.4), 3)),
        step_width=(round(width, 3), round(width + size * rng.uniform(0.01, 0.2), 3)),
        max_pelvis_roll=round(roll, 4) if asked[0] else None,
        max_foot_rotation=round(turn, 4) if asked[1] else None,
        max_multiplier=round(multiplier, 3) if asked[2] else None,
    )
