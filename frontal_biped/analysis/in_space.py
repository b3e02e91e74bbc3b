"""What a planar gait means for the whole robot in space: the wrench it must be held with, and its landing."""

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError, SimulationError
from frontal_biped.gait.check import ConstraintCheck, check_holding
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.holding_wrench import HoldingWrench, step_holding
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.space.plane_masses import F_H, F_V
from frontal_biped.zero_dynamics.poincare import StepOrbit

if TYPE_CHECKING:
    from frontal_biped.analysis.free_landing import FreeLandingReport

PLANAR_JOINTS = 4
"""A robot with no more joints has nothing to hold."""


@dataclass(frozen=True)
class HoldingRanges:
    """What the ground must hold over a step on one foot.

    Attributes:
        stance: "left" or "right".
        cop_x: smallest and largest, centre of pressure ahead of the ankle [m].
        cop_h: towards the other foot [m].
        yaw_moment: about the vertical through the centre of pressure [N m].
        yaw_moment_at_ankle: about the vertical through the ankle [N m].
        yaw_over_normal: largest size of ``yaw_moment`` over F_v [m].
        normal_force: F_v [N].
        friction: largest |F_h| / F_v [-].
        friction_with_yaw: coefficient that force and yaw moment need together [-].
    """

    stance: str
    cop_x: tuple[float, float]
    cop_h: tuple[float, float]
    yaw_moment: tuple[float, float]
    yaw_moment_at_ankle: tuple[float, float]
    yaw_over_normal: float
    normal_force: tuple[float, float]
    friction: float
    friction_with_yaw: float

    @classmethod
    def of(cls, phases: tuple[HoldingWrench, ...]) -> "HoldingRanges":
        """Of the phases of a step on one foot."""

        def joined(name: str) -> FloatArray:
            return np.concatenate([getattr(held, name) for held in phases], axis=-1)

        rows = joined("rows")
        return cls(
            stance=phases[0].sole.side.value,
            cop_x=_range(joined("cop_x")),
            cop_h=_range(joined("cop_h")),
            yaw_moment=_range(joined("yaw_moment")),
            yaw_moment_at_ankle=_range(joined("yaw_moment_at_ankle")),
            yaw_over_normal=float(np.max(np.abs(joined("yaw_moment") / rows[F_V]))),
            normal_force=_range(rows[F_V]),
            friction=float(np.max(np.abs(rows[F_H] / rows[F_V]))),
            friction_with_yaw=float(np.max(np.abs(joined("friction")))),
        )


@dataclass(frozen=True)
class SpaceAnalysis:
    """A gait as a motion of the robot in space.

    Attributes:
        holding: what the ground must hold on the left and on the right foot, legs as the URDF has them.
        averaged: largest distance between the centre of pressure sideways and the FRI target: what averaging the legs
            changes [m]; None where it cannot be said.
        checks: of that against the sole and its friction, asked for by the specification or not.
        asked: does the specification ask for them?
        landing: with every joint free; None where it cannot be said.
        missing: what could not be said, and why; one line each.
    """

    holding: tuple[HoldingRanges, ...]
    averaged: float | None
    checks: tuple[ConstraintCheck, ...]
    asked: bool
    landing: "FreeLandingReport | None"
    missing: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {**asdict(self), "landing": None if self.landing is None else self.landing.as_dict()}

    def __str__(self) -> str:
        blocks = []
        if self.holding:
            lines = [f"{'held by the ground in space':43} " + " ".join(f"{at.stance:>20}" for at in self.holding)]
            for name, key in _RANGES.items():
                values = [getattr(at, key) for at in self.holding]
                lines.append(f"{name:43} " + " ".join(f"{_printed(value):>20}" for value in values))
            lines.append(f"{'legs averaged: CoP from the FRI target [m]':43} {self.averaged:20.2g}")
            if not self.asked:  # else they are among the constraints
                lines += [f"{check}{'' if check.satisfied else '  beyond, not asked for'}" for check in self.checks]
            blocks.append("\n".join(lines))
        if self.landing is not None:
            blocks.append(str(self.landing))
        blocks += [f"in space: {line}" for line in self.missing]
        return "\n\n".join(blocks)


_RANGES = {
    "CoP ahead of the ankle [m]": "cop_x",
    "CoP towards the other foot [m]": "cop_h",
    "yaw moment about the CoP [N m]": "yaw_moment",
    "yaw moment about the ankle [N m]": "yaw_moment_at_ankle",
    "|yaw moment| / F_v, largest [m]": "yaw_over_normal",
    "normal force F_v [N]": "normal_force",
    "friction used, |F_h| / F_v [-]": "friction",
    "friction used, with the yaw moment [-]": "friction_with_yaw",
}


def has_joints_to_hold(biped: FrontalBiped) -> bool:
    """Has the robot joints besides the four roll joints?"""
    return len(biped.robot.joint_names) > PLANAR_JOINTS


def analyse_in_space(
    biped: FrontalBiped, gait: Gait, specification: GaitSpecification, step: StepOrbit
) -> SpaceAnalysis | None:
    """What a gait means for the whole robot; None for a robot that has no joints but the four roll joints.

    Args:
        biped: the robot.
        gait: the gait.
        specification: bounds to check against.
        step: of the gait, on converged quadrature nodes.
    """
    if not has_joints_to_hold(biped):
        return None
    from frontal_biped.analysis.free_landing import free_landing  # brings the simulation of walks in space

    missing: list[str] = []
    holding: tuple[HoldingRanges, ...] = ()
    checks: tuple[ConstraintCheck, ...] = ()
    averaged: float | None = None
    landing: FreeLandingReport | None = None
    try:
        wrenches, checks = check_holding(biped, specification, gait.rising, gait.falling, step)
        holding = tuple(HoldingRanges.of(phases) for phases in zip(*wrenches, strict=True))
        averaged = _off_target(biped, step)
        landing = free_landing(biped, gait)
    except (RobotError, SimulationError) as error:
        missing.append(str(error))
    return SpaceAnalysis(holding, averaged, checks, specification.bounds_holding_wrench, landing, tuple(missing))


def _off_target(biped: FrontalBiped, step: StepOrbit) -> float:
    distances = [
        np.max(np.abs(held.cop_h - orbit.restricted.p_fri))
        for orbit, wrenches in zip((step.rising, step.falling), step_holding(biped, step), strict=True)
        for held in wrenches
    ]
    return float(np.max(distances))


def _range(values: FloatArray) -> tuple[float, float]:
    return float(np.min(values)), float(np.max(values))


def _printed(value: float | tuple[float, float]) -> str:
    return f"{value:.4g}" if isinstance(value, float) else f"{value[0]:.4g} .. {value[1]:.4g}"
