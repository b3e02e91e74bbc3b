"""The constraints C01 to C09 on a step ([O] Sec. IV-A), written once for the optimiser and for the report."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.poincare import StepOrbit
from frontal_biped.zero_dynamics import F_H, F_V, TORQUES

STEP_WIDTH = "step width"


@dataclass(frozen=True)
class Constraint:
    """lower <= values <= upper, at one or many points.

    Attributes:
        code: C01..C09, or the key of the specification for a bound the paper does not have.
        name: what is bounded.
        unit: of values and bounds.
        values: (k,) quantities.
        lower: bound, or None.
        upper: bound, or None.
        scale: a typical size of the quantity, for the optimiser.
        strict: must the bound itself be excluded?
    """

    code: str
    name: str
    unit: str
    values: FloatArray
    lower: float | None
    upper: float | None
    scale: float
    strict: bool = False

    def sides(self, distance: float = 0.0) -> list[tuple[float, float]]:
        """(bound, sign) such that sign (values - bound) >= 0 is asked.

        Args:
            distance: to keep from the bounds, in units of ``scale``; at most a quarter of the room between them.
        """
        distance *= self.scale
        if self.lower is not None and self.upper is not None:
            distance = min(distance, 0.25 * (self.upper - self.lower))
        sides = []
        if self.lower is not None:
            sides.append((self.lower + distance, 1.0))
        if self.upper is not None:
            sides.append((self.upper - distance, -1.0))
        return sides


class SoleHeights(NamedTuple):
    """(2, n) heights of the swing sole's inner and outer end in each phase [m]."""

    rising: FloatArray
    falling: FloatArray


def step_constraints(
    biped: FrontalBiped,
    specification: GaitSpecification,
    step: StepOrbit,
    soles: SoleHeights,
    duration: FloatArray | float | None = None,
) -> list[Constraint]:
    """Every constraint of the specification, evaluated on a step.

    Args:
        biped: the robot.
        specification: the bounds.
        step: the step, sampled from the reversal (first) to the impact (last).
        soles: heights of the swing sole at the same points.
        duration: of the step [s], where the points of ``step`` are no quadrature nodes.

    Returns:
        The constraints, in the order of their codes.
    """
    spec = specification
    rising, falling, landing = step.rising, step.falling, step.landing
    speed_before, speed_after = falling.dbeta[-1], rising.dbeta[-1]
    constraints = [
        Constraint("C01", "multiplier delta_f^2 delta_r^2 delta_z^2", "-", _one(step.multiplier), 0.0, 1.0, 0.1, True),
        Constraint(
            "C01", "zeta_f* at the impact, about the FRI", "kg^2 m^4/s^2", _one(falling.z[-1]), 0.0, None, 10.0, True
        ),
        Constraint("C02", "range of beta, rising", "rad", _one(rising.Delta), spec.min_phase_range, None, 0.02),
        Constraint("C02", "range of beta, falling", "rad", _one(falling.Delta), spec.min_phase_range, None, 0.02),
        Constraint(
            "C02", "kappa_2 at the reversal (HIP2)", "N m", rising.restricted.kappa_2[:1], None, 0.0, 10.0, True
        ),
    ]
    both = (("rising", rising, soles.rising), ("falling", falling, soles.falling))
    for name, orbit, _ in both:
        constraints.append(
            Constraint("C02", f"zeta/tau^2 of the orbit, {name}", "kg^2 m^4/s^2", orbit.z, 0.0, None, 10.0, True)
        )
    for name, orbit, _ in both:
        constraints.append(
            Constraint("C03", f"I_P (decoupling), {name}", "kg m^2", orbit.restricted.I_P, 0.0, None, 10.0, True)
        )
    constraints.append(
        Constraint(
            "C04",
            "touchdown speed of both sole ends",
            "m/s",
            -landing.touchdown * speed_before,
            spec.touchdown_speed,
            None,
            0.05,
        )
    )
    for name, orbit, height in both:
        # height / (1 - t2): the bound is a constant then, also in the limit at the foot's own end on the ground
        inside = height[:, :-1] / (1.0 - orbit.tau[:-1] ** 2)
        end = landing.touchdown if name == "falling" else landing.lift_off / landing.speed_ratio
        values = np.concatenate([inside[0], inside[1], end * orbit.Delta])
        constraints.append(
            Constraint("C05", f"sole height / (1 - t2), {name}", "m", values, spec.swing_clearance, None, 0.01)
        )
    torque = np.asarray(spec.max_torque) if spec.max_torque is not None else biped.max_torque
    low, high = biped.sole[0] + spec.fri_margin, biped.sole[1] - spec.fri_margin
    for name, orbit, _ in both:
        forces = orbit.generalized_forces
        constraints += [
            Constraint("C06", f"F_v / m g, {name}", "-", forces[F_V] / biped.weight, spec.min_normal_force, None, 0.1),
            Constraint("C06", f"F_h / F_v, {name}", "-", forces[F_H] / forces[F_V], -spec.friction, spec.friction, 0.1),
            Constraint("C06", f"FRI in the sole, {name}", "m", orbit.restricted.p_fri, low, high, 0.02),
        ]
        constraints += [
            Constraint("C06", f"torque u_{i + 1}, {name}", "N m", u, -torque[i], torque[i], 50.0)
            for i, u in enumerate(forces[TORQUES])
        ]
        if spec.max_pelvis_roll is not None:
            roll = biped.pelvis_roll(orbit.motion.q)
            constraints.append(
                Constraint(
                    "max_pelvis_roll",
                    f"pelvis roll, {name}",
                    "rad",
                    roll,
                    -spec.max_pelvis_roll,
                    spec.max_pelvis_roll,
                    0.05,
                )
            )
    impulse = landing.impulse * speed_before
    constraints += [
        Constraint("C07", "normal impulse / m", "m/s", impulse[1:2] / biped.mass, 0.0, None, 0.1, True),
        Constraint("C07", "L_h / L_v", "-", impulse[:1] / impulse[1:2], -spec.friction, spec.friction, 0.1),
        # the landing foot is mirrored: its inner end points towards -h
        Constraint("C07", "impulse in the sole", "m", impulse[2:] / impulse[1:2], -biped.sole[1], -biped.sole[0], 0.02),
        Constraint(
            "C08",
            "lift-off speed of the old stance sole",
            "m/s",
            landing.lift_off * (speed_after / landing.speed_ratio),
            0.0,
            None,
            0.05,
        ),
        Constraint(
            "C09", "step duration", "s", _one(step.duration if duration is None else duration), *spec.step_duration, 0.1
        ),
        Constraint("C09", STEP_WIDTH, "m", _one(step.step_width), *spec.step_width, 0.1),
    ]
    return sorted(constraints, key=lambda constraint: constraint.code)


def _one(scalar: FloatArray | float) -> FloatArray:
    return np.stack([scalar])
