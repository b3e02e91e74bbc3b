"""The constraints C01 to C09 on a step ([O] Sec. IV-A), written once.

The optimiser asks them of arrays that carry derivatives, the report of a dense grid, and `ContactMargins` asks C04 to
C08 of a perturbed step, which the functions of one phase and of one impact are for.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.gait.holding_wrench import HoldingWrench, StepHolding
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import GRAVITY, JOINTS
from frontal_biped.model.impact import Landing
from frontal_biped.zero_dynamics.orbit import PhaseOrbit
from frontal_biped.zero_dynamics.poincare import StepOrbit
from frontal_biped.zero_dynamics.restricted import F_H, TORQUES

STEP_WIDTH = "step width"
MULTIPLIER = "multiplier delta_f^2 delta_r^2 delta_z^2"
ENERGY = "kg^2 m^4/s^2"

# A typical size of each quantity: the unit in which the optimiser weighs one constraint against another, and a report
# orders violations. What a gait has to satisfy does not depend on them. Where the specification asks for at least so
# much, its default is the size; the others are round numbers, of the order found on gaits of the robot of Table I
# (60.7 kg, motors of 150 N m, soles of 0.1 m).
SHARE = 0.1  # of what lies between 0 and 1: multiplier, coefficient of friction, share of the weight or of an energy
SPEED = GaitSpecification.touchdown_speed  # of an end of the sole [m/s]
HEIGHT = GaitSpecification.swing_clearance  # of an end of the sole [m]
RANGE = GaitSpecification.min_phase_range  # of beta [rad]
PLACE = 0.02  # on the sole, a fifth of it [m]
TORQUE = 50.0  # a third of what a motor gives [N m]
WEIGHT_MOMENT = 10.0  # the weight at an arm of 2 cm [N m]
INERTIA = 10.0  # I_P of brisk gaits comes down to 14 [kg m^2]
ZETA = 10.0  # zeta/tau^2 of brisk gaits comes down to 43 [kg^2 m^4/s^2]
IMPULSE = 0.1  # vertical speed that the impact takes from the centre of mass; brisk gaits lose 0.16 [m/s]
ROLL, ROTATION = 0.05, 0.1  # of the pelvis and of the swing foot [rad]
POSITION, VELOCITY = 0.1, 1.0  # of a joint [rad], [rad/s]
SECONDS, WIDTH = 0.1, 0.1  # of a step [s], [m]
SHIFT = 1e-3  # of the reversal by 1 % of speed [rad]


class Constraint(NamedTuple):
    """lower <= values <= upper, at one or many points.

    Attributes:
        code: C01..C09; "joint limits" of the robot; or the key of the specification for a bound the paper lacks.
        name: what is bounded.
        unit: of values and bounds.
        values: (k,) quantities.
        lower: bound, or None.
        upper: bound, or None.
        scale: a typical size of the quantity.
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
            distance = min(distance, 0.25 * max(self.upper - self.lower, 0.0))
        sides = []
        if self.lower is not None:
            sides.append((self.lower + distance, 1.0))
        if self.upper is not None:
            sides.append((self.upper - distance, -1.0))
        return sides


class PhaseLimits(NamedTuple):
    """What the stance foot and the motors carry along a phase (C06)."""

    normal_force: Constraint
    friction: Constraint
    fri: Constraint
    torques: tuple[Constraint, ...]


def phase_limits(
    biped: FrontalBiped, specification: GaitSpecification, forces: FloatArray, p_fri: FloatArray, phase: str
) -> PhaseLimits:
    """C06 at n points of a phase.

    Args:
        biped: the robot.
        specification: the bounds.
        forces: (7, n) rows F_h, F_v [N], N_0, u_1..u_4 [N m].
        p_fri: (n,) FRI [m].
        phase: its name, for the constraints'.
    """
    spec, (F_h, F_v, *_) = specification, forces
    low, high = biped.sole[0] + spec.fri_margin, biped.sole[1] - spec.fri_margin
    least, mu = spec.min_normal_force, spec.friction
    return PhaseLimits(
        _bound("C06", f"F_v / m g, {phase}", "-", F_v / biped.weight, least, None, SHARE, "min_normal_force"),
        _bound("C06", f"F_h / F_v, {phase}", "-", F_h / F_v, -mu, mu, SHARE, "friction"),
        _bound("C06", f"FRI in the sole, {phase}", "m", p_fri, low, high, PLACE, "fri_margin"),
        tuple(
            _bound("C06", f"{JOINTS[i]} torque, {phase}", "N m", u, -limit, limit, TORQUE, f"max_torque[{i}]")
            for i, (u, limit) in enumerate(zip(forces[TORQUES], spec.torque_limits(biped).tolist(), strict=True))
        ),
    )


def clearance_limit(
    specification: GaitSpecification,
    heights: FloatArray,
    share: FloatArray,
    phase: str,
    on_ground: FloatArray | None = None,
) -> Constraint:
    """C05: the height of the swing sole's ends over 1 - t2, so that the bound is one number.

    Args:
        specification: the bound.
        heights: (2, n) heights of the inner and the outer end [m].
        share: (n,) 1 - t2 = (beta - beta_impact)/(beta_r- - beta_impact), above 0.
        phase: its name, for the constraint's.
        on_ground: (2,) limit of the quotient where the foot is on the ground and both vanish [m].
    """
    inner, outer = heights / share
    values = np.concatenate([inner, outer] if on_ground is None else [inner, outer, on_ground])
    least = specification.swing_clearance
    return _bound("C05", f"sole height / (1 - t2), {phase}", "m", values, least, None, HEIGHT, "swing_clearance")


class ImpactLimits(NamedTuple):
    """What an impact must do: bring both ends of the sole down (C04), stick (C07), free the old stance foot (C08)."""

    touchdown: Constraint
    normal_impulse: Constraint
    friction: Constraint
    center_of_pressure: Constraint
    lift_off: Constraint


def impact_limits(
    biped: FrontalBiped, specification: GaitSpecification, landing: Landing, dbeta: FloatArray | float
) -> ImpactLimits:
    """C04, C07 and C08 at an impact.

    Args:
        biped: the robot.
        specification: the bounds.
        landing: the impact per unit of dbeta.
        dbeta: before it [rad/s], negative.
    """
    spec, mu, (outer, inner) = specification, specification.friction, biped.sole
    descent, impulse, lift_off = -landing.touchdown * dbeta, landing.impulse * dbeta, landing.lift_off * dbeta
    L_h, L_v, moment = impulse[:1], impulse[1:2], impulse[2:]
    least = spec.touchdown_speed
    return ImpactLimits(
        _bound("C04", "touchdown speed of both sole ends", "m/s", descent, least, None, SPEED, "touchdown_speed"),
        _bound("C07", "normal impulse / m", "m/s", L_v / biped.mass, 0.0, None, IMPULSE, strict=True),
        _bound("C07", "L_h / L_v", "-", L_h / L_v, -mu, mu, SHARE, "friction"),
        # the landing foot is mirrored: its inner end points towards -h
        _bound("C07", "impulse in the sole", "m", moment / L_v, -inner, -outer, PLACE),
        _bound("C08", "lift-off speed of the old stance sole", "m/s", lift_off, 0.0, None, SPEED),
    )


class SoleHeights(NamedTuple):
    """(2, n) heights of the swing sole's inner and outer end in each phase [m]."""

    rising: FloatArray
    falling: FloatArray


def sole_heights(biped: FrontalBiped, q: FloatArray) -> FloatArray:
    """(2, n) heights of the swing sole's inner and outer end at q (n, 4) [m]."""
    return biped.swing_sole_heights(q)


def step_constraints(
    biped: FrontalBiped,
    specification: GaitSpecification,
    step: StepOrbit,
    soles: SoleHeights,
    duration: FloatArray | float | None = None,
    departure: Landing | None = None,
    holding: StepHolding | None = None,
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
        holding: what the ground must hold at the same points; needed where the specification bounds it.

    Returns:
        The constraints, in the order of their codes.
    """
    spec = specification
    rising, falling, landing = step.rising, step.falling, step.landing
    both = (("rising", rising, soles.rising), ("falling", falling, soles.falling))
    found: list[Constraint] = []
    if departure is None:
        departure = landing
        slope, top = _one(step.multiplier), 1.0 if spec.max_multiplier is None else spec.max_multiplier
        found.append(_bound("C01", MULTIPLIER, "-", slope, 0.0, top, SHARE, ("", "max_multiplier"), strict=True))
    zeta, name = _one(falling.z[-1]), "zeta_f* at the impact, about the FRI"
    found.append(_bound("C01", name, ENERGY, zeta, 0.0, None, ZETA, strict=True))
    least = spec.min_phase_range
    found += [
        _bound("C02", f"range of beta, {name}", "rad", _one(orbit.Delta), least, None, RANGE, "min_phase_range")
        for name, orbit, _ in both
    ]
    kappa_2 = rising.restricted.kappa_2[:1]
    found.append(_bound("C02", "kappa_2 at the reversal (HIP2)", "N m", kappa_2, None, 0.0, WEIGHT_MOMENT, strict=True))
    found += [
        _bound("C02", f"zeta/tau^2 of the orbit, {name}", ENERGY, orbit.z, 0.0, None, ZETA, strict=True)
        for name, orbit, _ in both
    ]
    found += [
        _bound("C03", f"I_P (decoupling), {name}", "kg m^2", orbit.restricted.I_P, 0.0, None, INERTIA, strict=True)
        for name, orbit, _ in both
    ]
    found += impact_limits(biped, spec, landing, falling.dbeta[-1])
    for name, orbit, height in both:
        end = landing.touchdown if name == "falling" else departure.lift_off / departure.speed_ratio
        found.append(clearance_limit(spec, height[:, :-1], 1.0 - orbit.tau[:-1] ** 2, name, end * orbit.Delta))
        *limits, torques = phase_limits(biped, spec, orbit.generalized_forces, orbit.restricted.p_fri, name)
        found += [*limits, *torques, *_joint_limits(biped, spec, orbit, name)]
    seconds, (shortest, longest) = _one(step.duration if duration is None else duration), spec.step_duration
    keys = "step_duration[0]", "step_duration[1]"
    found.append(_bound("C09", "step duration", "s", seconds, shortest, longest, SECONDS, keys))
    keys = "step_width[0]", "step_width[1]"
    found.append(_bound("C09", STEP_WIDTH, "m", _one(step.step_width), *spec.step_width, WIDTH, keys))
    if spec.min_energy_margin is not None:
        key, margin, least = "min_energy_margin", _one(energy_margin(step)), spec.min_energy_margin
        found.append(_bound(key, "energy to spare before tipping", "-", margin, least, None, SHARE, key))
    if spec.max_reversal_shift is not None:
        key, shift, most = "max_reversal_shift", _one(reversal_shift(step)), spec.max_reversal_shift
        found.append(_bound(key, "reversal shift by 1 % of speed", "rad", shift, None, most, SHIFT, key))
    if holding is not None and spec.bounds_holding_wrench:
        for name, wrenches in zip(("rising", "falling"), holding, strict=True):
            held = holding_limits(wrenches, spec.cop_margin_x or 0.0, spec.yaw_friction, name)
            found += [limit for limit in held if limit is not None]
    return sorted(found, key=lambda constraint: constraint.code)


class HoldingLimits(NamedTuple):
    """What the soles must hold along a phase when the whole robot walks in space.

    Attributes:
        fore_aft: centre of pressure between heel and toe, of the shorter sole where left and right differ.
        friction: force and yaw moment together; None without a coefficient.
    """

    fore_aft: Constraint
    friction: Constraint | None


def holding_limits(
    wrenches: Sequence[HoldingWrench], margin: float, friction: float | None, phase: str
) -> HoldingLimits:
    """Bounds on what the ground must hold along a phase.

    Args:
        wrenches: of either foot, or of one.
        margin: of the centre of pressure, inside toe and heel [m].
        friction: coefficient of friction; None: not bounded.
        phase: its name, for the constraints'.
    """
    low = margin - min(wrench.sole.back for wrench in wrenches)
    high = min(wrench.sole.front for wrench in wrenches) - margin
    name, key = f"CoP ahead of the ankle, {phase}", "cop_margin_x"
    cop = np.concatenate([wrench.cop_x for wrench in wrenches])
    fore_aft = _bound(key, name, "m", cop, low, high, PLACE, key)
    if friction is None:
        return HoldingLimits(fore_aft, None)
    name, key = f"F_h and yaw moment, over F_v, {phase}", "yaw_friction"
    used = np.concatenate([part for wrench in wrenches for part in wrench.friction])
    return HoldingLimits(fore_aft, _bound(key, name, "-", used, -friction, friction, SHARE, key))


def _joint_limits(
    biped: FrontalBiped, specification: GaitSpecification, orbit: PhaseOrbit, phase: str
) -> list[Constraint]:
    """Bounds on pelvis, swing foot and joints along a phase, those that the specification and the robot have."""
    q, found = orbit.motion.q, []
    if specification.max_pelvis_roll is not None:
        key, limit = "max_pelvis_roll", specification.max_pelvis_roll
        found.append(_bound(key, f"pelvis roll, {phase}", "rad", biped.pelvis_roll(q), -limit, limit, ROLL, key))
    if specification.max_foot_rotation is not None:
        key, limit = "max_foot_rotation", specification.max_foot_rotation
        rotation = biped.swing_foot_rotation(q)
        found.append(_bound(key, f"swing foot, {phase}", "rad", rotation, -limit, limit, ROTATION, key))
    limits = np.stack([biped.joint_lower, biped.joint_upper, biped.joint_max_velocity], axis=1).tolist()
    for i, bounds in enumerate(limits):
        lower, upper, fastest = (bound if math.isfinite(bound) else None for bound in bounds)
        if lower is not None or upper is not None:
            found.append(_bound("joint limits", f"{JOINTS[i]} angle, {phase}", "rad", q[:, i], lower, upper, POSITION))
        if fastest is not None:
            name, velocity = f"{JOINTS[i]} speed, {phase}", orbit.velocities[:, i]
            found.append(_bound("joint limits", name, "rad/s", velocity, -fastest, fastest, VELOCITY))
    return found


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
    return np.atleast_1d(scalar)


def _bound(
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
) -> Constraint:
    """A constraint; one key is the entry of both bounds."""
    pair = (keys, keys) if isinstance(keys, str) else keys
    return Constraint(code, name, unit, values, lower, upper, scale, strict, pair)
