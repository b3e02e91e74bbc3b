"""The constraints C01 to C09 on a step ([O] Sec. IV-A), written once for the optimiser and for the report."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import GRAVITY
from frontal_biped.zero_dynamics.poincare import Landing, StepOrbit
from frontal_biped.zero_dynamics.restricted import F_H, TORQUES

STEP_WIDTH = "step width"
MULTIPLIER = "multiplier delta_f^2 delta_r^2 delta_z^2"
ENERGY = "kg^2 m^4/s^2"
RANGE, TOUCHDOWN, CLEARANCE = "min_phase_range", "touchdown_speed", "swing_clearance"


@dataclass(frozen=True)
class Constraint:
    """lower <= values <= upper, at one or many points.

    Attributes:
        code: C01..C09; "joint limits" of the robot; or the key of the specification for a bound the paper lacks.
        name: what is bounded.
        unit: of values and bounds.
        values: (k,) quantities.
        lower: bound, or None.
        upper: bound, or None.
        scale: a typical size of the quantity, for the optimiser.
        strict: must the bound itself be excluded?
        keys: entries of the specification that set the lower and the upper bound; "" where physics or the robot do.
    """

    code: str
    name: str
    unit: str
    values: FloatArray
    lower: float | None
    upper: float | None
    scale: float
    strict: bool = False
    keys: tuple[str, str] = ("", "")

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
    departure: Landing | None = None,
) -> list[Constraint]:
    """Every constraint of the specification, evaluated on a step.

    Args:
        biped: the robot.
        specification: the bounds.
        step: the step, sampled from the reversal (first) to the impact (last).
        soles: heights of the swing sole at the same points.
        duration: of the step [s], where the points of ``step`` are no quadrature nodes.
        departure: the impact that the step begins with; default: the one it ends with, as in a periodic gait. A step
            between two gaits, which departs from another impact, has no multiplier.

    Returns:
        The constraints, in the order of their codes.
    """
    spec = specification
    rising, falling, landing = step.rising, step.falling, step.landing
    speed_before = falling.dbeta[-1]
    both = (("rising", rising, soles.rising), ("falling", falling, soles.falling))
    found: list[Constraint] = []

    def add(
        code: str,
        name: str,
        unit: str,
        values: FloatArray,
        lower: float | None,
        upper: float | None,
        scale: float,
        keys: str | tuple[str, str] = "",
        *,
        strict: bool = False,
    ) -> None:
        pair = (keys, keys) if isinstance(keys, str) else keys
        found.append(Constraint(code, name, unit, values, lower, upper, scale, strict, pair))

    if departure is None:
        departure = landing
        top = 1.0 if spec.max_multiplier is None else spec.max_multiplier
        add("C01", MULTIPLIER, "-", _one(step.multiplier), 0.0, top, 0.1, ("", "max_multiplier"), strict=True)
    add("C01", "zeta_f* at the impact, about the FRI", ENERGY, _one(falling.z[-1]), 0.0, None, 10.0, strict=True)
    for name, orbit, _ in both:
        add("C02", f"range of beta, {name}", "rad", _one(orbit.Delta), spec.min_phase_range, None, 0.02, RANGE)
    kappa_2 = rising.restricted.kappa_2[:1]
    add("C02", "kappa_2 at the reversal (HIP2)", "N m", kappa_2, None, 0.0, 10.0, strict=True)
    for name, orbit, _ in both:
        add("C02", f"zeta/tau^2 of the orbit, {name}", ENERGY, orbit.z, 0.0, None, 10.0, strict=True)
    for name, orbit, _ in both:
        add("C03", f"I_P (decoupling), {name}", "kg m^2", orbit.restricted.I_P, 0.0, None, 10.0, strict=True)
    touchdown = -landing.touchdown * speed_before
    add("C04", "touchdown speed of both sole ends", "m/s", touchdown, spec.touchdown_speed, None, 0.05, TOUCHDOWN)
    for name, orbit, height in both:
        # height / (1 - t2): the bound is a constant then, also in the limit at the foot's own end on the ground
        inside = height[:, :-1] / (1.0 - orbit.tau[:-1] ** 2)
        end = landing.touchdown if name == "falling" else departure.lift_off / departure.speed_ratio
        heights = np.concatenate([inside[0], inside[1], end * orbit.Delta])
        add("C05", f"sole height / (1 - t2), {name}", "m", heights, spec.swing_clearance, None, 0.01, CLEARANCE)
    torque = spec.torque_limits(biped)
    low, high = biped.sole[0] + spec.fri_margin, biped.sole[1] - spec.fri_margin
    for name, orbit, _ in both:
        F_h, F_v, *_ = forces = orbit.generalized_forces
        add("C06", f"F_v / m g, {name}", "-", F_v / biped.weight, spec.min_normal_force, None, 0.1, "min_normal_force")
        add("C06", f"F_h / F_v, {name}", "-", F_h / F_v, -spec.friction, spec.friction, 0.1, "friction")
        add("C06", f"FRI in the sole, {name}", "m", orbit.restricted.p_fri, low, high, 0.02, "fri_margin")
        for i, u in enumerate(forces[TORQUES]):
            limit = float(torque[i])
            add("C06", f"torque u_{i + 1}, {name}", "N m", u, -limit, limit, 50.0, f"max_torque[{i}]")
        if spec.max_pelvis_roll is not None:
            limit, roll = spec.max_pelvis_roll, biped.pelvis_roll(orbit.motion.q)
            add("max_pelvis_roll", f"pelvis roll, {name}", "rad", roll, -limit, limit, 0.05, "max_pelvis_roll")
        if spec.max_foot_rotation is not None:
            limit, q = spec.max_foot_rotation, orbit.motion.q
            rotation = q[:, 0] + q[:, 1] + q[:, 2] + q[:, 3] + 2.0 * np.pi
            add("max_foot_rotation", f"swing foot, {name}", "rad", rotation, -limit, limit, 0.1, "max_foot_rotation")
        for i in range(4):
            position, velocity = orbit.motion.q[:, i], orbit.motion.dq[:, i] * orbit.dbeta
            lower, upper, fastest = (
                float(bound[i]) if np.isfinite(bound[i]) else None
                for bound in (biped.joint_lower, biped.joint_upper, biped.joint_max_velocity)
            )
            if lower is not None or upper is not None:
                add("joint limits", f"q_{i + 1}, {name}", "rad", position, lower, upper, 0.1)
            if fastest is not None:
                add("joint limits", f"|dq_{i + 1}/dt|, {name}", "rad/s", velocity, -fastest, fastest, 1.0)
    impulse = landing.impulse * speed_before
    add("C07", "normal impulse / m", "m/s", impulse[1:2] / biped.mass, 0.0, None, 0.1, strict=True)
    add("C07", "L_h / L_v", "-", impulse[:1] / impulse[1:2], -spec.friction, spec.friction, 0.1, "friction")
    # the landing foot is mirrored: its inner end points towards -h
    add("C07", "impulse in the sole", "m", impulse[2:] / impulse[1:2], -biped.sole[1], -biped.sole[0], 0.02)
    lift_off = landing.lift_off * speed_before
    add("C08", "lift-off speed of the old stance sole", "m/s", lift_off, 0.0, None, 0.05)
    seconds = _one(step.duration if duration is None else duration)
    add("C09", "step duration", "s", seconds, *spec.step_duration, 0.1, ("step_duration[0]", "step_duration[1]"))
    add("C09", STEP_WIDTH, "m", _one(step.step_width), *spec.step_width, 0.1, ("step_width[0]", "step_width[1]"))
    if spec.min_energy_margin is not None:
        margin, least = _one(energy_margin(step)), spec.min_energy_margin
        add("min_energy_margin", "energy to spare before tipping", "-", margin, least, None, 0.1, "min_energy_margin")
    if spec.max_reversal_shift is not None:
        shift, most = _one(reversal_shift(step)), spec.max_reversal_shift
        name = "reversal shift by 1 % of speed"
        add("max_reversal_shift", name, "rad", shift, None, most, 1e-3, "max_reversal_shift")
    return sorted(found, key=lambda constraint: constraint.code)


def _energy_at_reversal(step: StepOrbit) -> FloatArray:
    """zeta after the impact, carried to the reversal: what the drive takes away on the way [kg^2 m^4/s^2]."""
    return step.rising.z[-1] * np.exp(-step.rising.log_delta_squared[-1])


def energy_margin(step: StepOrbit) -> FloatArray:
    """Energy that may be added after the impact before the robot tips outwards, over the energy of the orbit [-].

    Beyond the reversal the drive kappa_2 I_P is continued along its tangent with the FRI at rest and I_P constant:
    d kappa_2/dbeta = -g m p_cm_h' = -g A_h, so the barrier kappa_2 = 0 lies kappa_2/(g A_h) ahead, at the height
    I_P kappa_2^2 / (-2 g A_h).
    """
    at = step.rising.restricted
    barrier = at.I_P[0] * at.kappa_2[0] ** 2 / (-2.0 * GRAVITY * at.projected.A[F_H, 0])
    return barrier / _energy_at_reversal(step)


def reversal_shift(step: StepOrbit) -> FloatArray:
    """Displacement of the reversal by a post-impact speed 1 % too high, to first order [rad].

    zeta grows by 2 % after the impact; at the reversal the drive takes dzeta/dbeta per radian.
    """
    return 0.02 * _energy_at_reversal(step) / -step.rising.restricted.drive[0]


def _one(scalar: FloatArray | float) -> FloatArray:
    return np.stack([scalar])
