"""What a gait with a finite double support must keep, written once: for its design and for its certificate.

Single support, from the lift-off to the reversal (falling is the same backwards): C02, C03, C05, C06 and the limits of
the joints. The swing foot leaves the ground at rest, so its height grows with the square of the way, and C05 bounds the
height over (1 - t2)^2. At the lift-off the torques of single support must take the foot off the ground, upwards rather
than sideways: were it held, the ground would have to pull.

Double support, and the way from standing into the gait: the pressure point stays inside both feet; that soles and
motors can share the load behind it, the certificate asks of `SupportPoint`.
"""

from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import UnreachablePoseError
from frontal_biped.gait.constraints import (
    HEIGHT,
    INERTIA,
    PLACE,
    POSITION,
    RANGE,
    ROLL,
    ROTATION,
    SECONDS,
    SHARE,
    VELOCITY,
    ZETA,
    Constraint,
    energy_margin,
    phase_limits,
    sole_heights,
)
from frontal_biped.gait.support_gait import SupportGait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import JOINTS
from frontal_biped.model.impact import impact
from frontal_biped.numerics.quintic import Kinematics, Quintic
from frontal_biped.virtual_constraints.double_support import DoubleSupportFamily
from frontal_biped.zero_dynamics.orbit import PhaseOrbit
from frontal_biped.zero_dynamics.poincare import StepOrbit
from frontal_biped.zero_dynamics.restricted import F_H, F_V, TORQUES
from frontal_biped.zero_dynamics.support_dynamics import SupportPoint
from frontal_biped.zero_dynamics.support_plan import NODES, WEIGHTS, SupportPlan

TO_SPARE = 0.5
"""Least energy to spare before the robot tips outwards, over that of the orbit (`gait.constraints.energy_margin`),
where the specification does not ask for more: a lift-off faster by sqrt(1.5), 22 %, still reverses."""

SIDEWAYS = 1.0
"""Sideways acceleration of a foot that leaves the ground, over its upward one, at most."""

LIFT = 0.005
"""Share of the weight with which the ground would at least have to pull at the foot to keep it."""

INSTANTS = 15
"""At which the pressure point is looked at on the way from standing."""


class SupportStep(NamedTuple):
    """A step of such a gait, evaluated.

    Attributes:
        orbit: rising half of the single support.
        hand_over: the double support.
        duration: of the step [s].
        residuals: whose squares add up to J.
        constraints: what it must keep.
    """

    orbit: PhaseOrbit
    hand_over: SupportPlan
    duration: float
    residuals: FloatArray
    constraints: list[Constraint]

    @property
    def cost(self) -> float:
        """J = (1/L_s) int u'u dt over a step, double support included [N^2 m s]."""
        return float(self.residuals @ self.residuals)


def evaluate_support_step(biped: FrontalBiped, gait: SupportGait, size: int) -> SupportStep:
    """A step of a gait on ``size`` quadrature nodes.

    Raises:
        ReversalError: the reversal is not above the lift-off, or double support would stop on the way.
        UnreachablePoseError: there is no double support where it begins or ends.
    """
    orbit = gait.orbit(biped, size)
    # the curve decides the speed; the gait's own number is that of its last evaluation
    speed = float(orbit.dbeta[-1])
    over = gait.hand_over(biped)
    over = type(over)(over.family, over.landing, over.lift_off, speed)
    plan = over.plan()
    u = orbit.generalized_forces[TORQUES]
    single = u * np.sqrt(2.0 * orbit.weights * orbit.time_density / gait.width)
    double = []
    for node, weight in zip(NODES.tolist(), WEIGHTS.tolist(), strict=True):
        beta, rate, acceleration = plan.at(0.5 * (node + 1.0) * plan.duration)
        point = SupportPoint.of(plan.family, beta)
        forces = point.forces(acceleration, rate**2, point.shared(acceleration, rate**2, gait.p_fri))
        double.append(forces.u * np.sqrt(0.5 * weight * plan.duration / gait.width))
    duration = 2.0 * orbit.duration + plan.duration
    constraints = [
        *_single_support(biped, gait, orbit),
        *_lift_off(biped, gait, over.family, orbit),
        *_double_support(gait, plan, duration),
        _from_rest(gait, over.lift_off.kinematics(over.family, speed), plan),
    ]
    residuals = np.concatenate([single.ravel(), *double])
    return SupportStep(orbit, plan, duration, residuals, constraints)


def _single_support(biped: FrontalBiped, gait: SupportGait, orbit: PhaseOrbit) -> list[Constraint]:
    spec, q = gait.specification, orbit.motion.q
    share = 1.0 - orbit.tau[:-1] ** 2
    over_share = (sole_heights(biped, q)[:, :-1] / share**2).ravel()
    landing = impact(biped, q[-1], orbit.motion.dq[-1])
    spare = energy_margin(StepOrbit(orbit, orbit, landing, gait.width))
    wanted = TO_SPARE if spec.min_energy_margin is None else spec.min_energy_margin
    least = spec.swing_clearance
    key = "swing_clearance"
    found = [
        Constraint("C02", "range of beta", "rad", np.array([orbit.Delta]), spec.min_phase_range, None, RANGE),
        Constraint("min_energy_margin", "energy to spare before tipping", "-", np.array([spare]), wanted, None, SHARE),
        Constraint("C02", "zeta/tau^2 of the orbit", "kg^2 m^4/s^2", orbit.z, 0.0, None, ZETA, strict=True),
        Constraint("C03", "I_P (decoupling)", "kg m^2", orbit.restricted.I_P, 0.0, None, INERTIA, strict=True),
        Constraint("C05", "sole height / (1 - t2)^2", "m", over_share, least, None, HEIGHT, keys=(key, key)),
    ]
    *limits, torques = phase_limits(biped, spec, orbit.generalized_forces, orbit.restricted.p_fri, "single support")
    found += [*limits, *torques]
    for name, limit, values, scale in (
        ("max_pelvis_roll", spec.max_pelvis_roll, biped.pelvis_roll(q), ROLL),
        ("max_foot_rotation", spec.max_foot_rotation, biped.swing_foot_rotation(q), ROTATION),
    ):
        if limit is not None:
            found.append(Constraint(name, name, "rad", values, -limit, limit, scale, keys=(name, name)))
    for i, (low, high, fast) in enumerate(
        zip(biped.joint_lower, biped.joint_upper, biped.joint_max_velocity, strict=True)
    ):
        lower, upper, fastest = (float(bound) if np.isfinite(bound) else None for bound in (low, high, fast))
        if lower is not None or upper is not None:
            found.append(Constraint("joint limits", f"{JOINTS[i]} angle", "rad", q[:, i], lower, upper, POSITION))
        if fastest is not None:
            rate = orbit.motion.dq[:, i] * orbit.dbeta
            found.append(Constraint("joint limits", f"{JOINTS[i]} speed", "rad/s", rate, -fastest, fastest, VELOCITY))
    return found


def _lift_off(
    biped: FrontalBiped, gait: SupportGait, family: DoubleSupportFamily, orbit: PhaseOrbit
) -> list[Constraint]:
    point, motion = SupportPoint.of(family, gait.rising.beta_start), orbit.motion
    bend = point.J @ (motion.ddq[-1] - point.at.ddq) * orbit.Delta**2
    away = np.array([bend[F_V] * SIDEWAYS - bend[F_H], bend[F_V] * SIDEWAYS + bend[F_H]])
    held = point.under(orbit.generalized_forces[TORQUES, -1], float(orbit.dbeta[-1]) ** 2)[1]
    pull = np.array([-held.swing[F_V] / biped.weight])
    return [
        Constraint("C08", "upward less sideways, foot lifted", "m", away, 0.0, None, HEIGHT),
        Constraint("C08", "pull of the ground at a foot not lifted / m g", "-", pull, LIFT, None, LIFT),
    ]


def _double_support(gait: SupportGait, plan: SupportPlan, duration: float) -> list[Constraint]:
    (shortest, longest), (short, long) = gait.specification.step_duration, gait.asked.double_support
    way = np.array([plan.at(plan.duration).x - plan.at(0.0).x])
    return [
        Constraint("C09", "double support", "s", np.array([plan.duration]), short, long, SECONDS),
        Constraint("C09", "step duration", "s", np.array([duration]), shortest, longest, SECONDS),
        Constraint("double support", "way of beta in it", "rad", way, 0.0, None, RANGE, strict=True),
    ]


def _from_rest(gait: SupportGait, lift_off: Kinematics, plan: SupportPlan) -> Constraint:
    """The pressure point on the way from rest half-way to the lift-off, inside both feet."""
    family, T = plan.family, gait.setting_off
    outer = family.biped.sole[0]
    half_way = Kinematics(family.half_way(), 0.0, 0.0)
    path = Quintic.between(half_way, lift_off, T)
    points = []
    for t in np.linspace(0.0, T, INSTANTS).tolist():
        beta, rate, acceleration = path.at(t)
        try:
            points.append(SupportPoint.of(family, beta).pressure_point(acceleration, rate**2))
        except UnreachablePoseError:
            points.append(np.inf)
    inside = outer + gait.specification.fri_margin + gait.asked.pressure_margin
    return Constraint(
        "standing", "pressure point while setting off", "m", np.array(points), inside, family.width - inside, PLACE
    )


def margins(constraints: list[Constraint], distance: float = 0.0) -> FloatArray:
    """All scaled margins, >= 0 where kept, ``distance`` inside the bounds."""
    parts = [
        sign * (constraint.values - bound) / constraint.scale
        for constraint in constraints
        for bound, sign in constraint.sides(distance)
    ]
    return np.concatenate(parts)
