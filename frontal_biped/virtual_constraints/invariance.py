"""Hybrid invariance: choose the Bezier columns that keep the robot on Z through impact and reversal.

Impact: both feet are flat at the end of the falling phase, so the last falling column follows from beta_f- and the
step width. Relabelled it is the first rising column, and beta_r+ its first entry. The impact map is linear in the
velocities, so the slope dq_b/dbeta after the impact depends on the falling slope alone and fixes the second rising
column. Reversal: the falling phase starts in the pose and with the slope (with respect to beta) in which the rising
phase ends, which fixes its first two columns; its FRI target starts where the rising one ends.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import UnreachablePoseError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import UPRIGHT
from frontal_biped.model.impact import impact
from frontal_biped.model.stance_map import relabel
from frontal_biped.virtual_constraints.phase import Phase


def double_support_pose(biped: FrontalBiped, beta: float, step_width: float) -> FloatArray:
    """(4,) pose with both feet flat on the ground, ankles ``step_width`` apart, stance ankle at beta.

    Hip line and swing leg close a triangle over the stance hip and the swing ankle; of its two mirror images the
    one nearer to the upright posture is taken.

    Args:
        biped: the robot.
        beta: stance ankle angle [rad].
        step_width: distance between the ankles [m].

    Returns:
        q (4,) [rad].

    Raises:
        UnreachablePoseError: the swing foot cannot be there.
    """
    # stance leg, hip line, swing leg at the upright reference (h, v)
    joints = biped.chain.joints
    (a_h, a_v), (b_h, b_v), (c_h, c_v) = (joints[1:] - joints[:-1]).tolist()
    stance_leg = beta - UPRIGHT
    cos, sin = math.cos(stance_leg), math.sin(stance_leg)
    d_h, d_v = step_width - (cos * a_h - sin * a_v), -(sin * a_h + cos * a_v)
    # |b + R(x) c|^2 = |d|^2, with b . R(x) c = cos x (b . c) + sin x (b . Jc), J the quarter turn
    along, across = b_h * c_h + b_v * c_v, b_v * c_h - b_h * c_v
    squares = d_h * d_h + d_v * d_v - b_h * b_h - b_v * b_v - c_h * c_h - c_v * c_v
    cosine = 0.5 * squares / math.hypot(along, across)
    if not abs(cosine) <= 1.0:
        raise UnreachablePoseError(
            f"both feet cannot stand {float(step_width):.4g} m apart with the stance ankle at {float(beta):.4g} rad;"
            " change step_width or the start pose"
        )
    centre = math.atan2(across, along)
    x = centre - math.copysign(math.acos(cosine), centre)
    cos, sin = math.cos(x), math.sin(x)
    hip_to_ankle_h, hip_to_ankle_v = b_h + cos * c_h - sin * c_v, b_v + sin * c_h + cos * c_v
    # rotation from the unturned hip-to-ankle vector to d
    pelvis = math.atan2(hip_to_ankle_h * d_v - hip_to_ankle_v * d_h, hip_to_ankle_h * d_h + hip_to_ankle_v * d_v)
    return np.array([beta, UPRIGHT + pelvis - stance_leg, UPRIGHT + x, UPRIGHT - pelvis - x])


@dataclass(frozen=True)
class FreeParameters:
    """What hybrid invariance leaves free; everything else follows.

    Attributes:
        beta_reversal: beta_r- = beta_f+ [rad].
        beta_impact: beta_f- [rad].
        step_width: distance between the ankles L_s [m].
        rising_columns: (3, M - 1) rising Bezier columns 2..M [rad].
        falling_columns: (3, M - 2) falling Bezier columns 2..M-1 [rad].
        rising_fri: (M_FRI + 1,) [m].
        falling_fri: (M_FRI,) columns 1..M_FRI [m].
    """

    beta_reversal: float
    beta_impact: float
    step_width: float
    rising_columns: FloatArray
    falling_columns: FloatArray
    rising_fri: FloatArray
    falling_fri: FloatArray


class StepBegin(NamedTuple):
    """What a step begins with.

    Attributes:
        q_minus: (4,) pose at the impact before it [rad].
        slope_plus: (3,) dq_b/dbeta behind that impact [-].
    """

    q_minus: FloatArray
    slope_plus: FloatArray


class PhaseParameters(NamedTuple):
    """Parameters of one phase, as `Phase` keeps them."""

    beta_start: float
    beta_end: float
    joint_bezier: FloatArray
    fri_bezier: FloatArray


def rising_parameters(free: FreeParameters, q_minus: FloatArray, slope_plus: FloatArray) -> PhaseParameters:
    """Complete the rising phase from the impact pose q- (4,) and the slope behind the impact (3,)."""
    q_plus = relabel(q_minus)
    beta_start = q_plus[0]
    degree = free.rising_columns.shape[1] + 1
    first = q_plus[1:]
    second = first + slope_plus * (free.beta_reversal - beta_start) / degree
    columns = np.concatenate([first[:, None], second[:, None], free.rising_columns], axis=1)
    return PhaseParameters(beta_start, free.beta_reversal, columns, free.rising_fri)


def falling_parameters(free: FreeParameters, q_minus: FloatArray, rising: PhaseParameters) -> PhaseParameters:
    """Complete the falling phase from the impact pose q- (4,) and the end of the rising phase."""
    last, before_last = rising.joint_bezier[:, -1], rising.joint_bezier[:, -2]
    # equal slopes in beta: M (b_M - b_{M-1}) / range_r = M (c_1 - c_0) / range_f
    range_ratio = (free.beta_impact - free.beta_reversal) / (free.beta_reversal - rising.beta_start)
    second = last + (last - before_last) * range_ratio
    columns = np.concatenate([last[:, None], second[:, None], free.falling_columns, q_minus[1:][:, None]], axis=1)
    fri = np.concatenate([rising.fri_bezier[-1:], free.falling_fri])
    return PhaseParameters(free.beta_reversal, free.beta_impact, columns, fri)


def final_falling_slope(free: FreeParameters, q_minus: FloatArray) -> FloatArray:
    """(4,) dq/dbeta at the end of the falling phase, first entry 1 [-]."""
    degree = free.falling_columns.shape[1] + 2
    slope = (q_minus[1:] - free.falling_columns[:, -1]) * (degree / (free.beta_impact - free.beta_reversal))
    return np.concatenate([np.ones(1), slope])


def complete(biped: FrontalBiped, free: FreeParameters, begin: StepBegin | None = None) -> tuple[Phase, Phase]:
    """Rising and falling phase with hybrid invariance built in.

    Args:
        biped: the robot.
        free: what invariance leaves free; M >= 4 so that the determined columns do not meet.
        begin: what the step begins with; default: the impact it ends with, as in a gait.

    Returns:
        Rising and falling phase.

    Raises:
        UnreachablePoseError: the final pose does not exist.
    """
    q_minus = double_support_pose(biped, free.beta_impact, free.step_width)
    if begin is None:
        begin = step_end(biped, free)
    rising = rising_parameters(free, *begin)
    falling = falling_parameters(free, q_minus, rising)
    return _phase(rising), _phase(falling)


def complete_in_turn(
    biped: FrontalBiped, a: FreeParameters, b: FreeParameters
) -> tuple[tuple[Phase, Phase], tuple[Phase, Phase]]:
    """Phases of two steps that follow each other, hybrid invariance built in: either begins as the other has landed.

    Args:
        biped: the robot.
        a: what is free of step A, which ends with the ankles ``a.step_width`` apart.
        b: what is free of step B.

    Returns:
        Rising and falling phase of A, and of B. Equal parameters give twice what `complete` gives.

    Raises:
        UnreachablePoseError: a final pose does not exist.
    """
    after_a, after_b = step_end(biped, a), step_end(biped, b)
    return complete(biped, a, after_b), complete(biped, b, after_a)


def step_end(biped: FrontalBiped, free: FreeParameters) -> StepBegin:
    """What a step leaves to the next one.

    Raises:
        UnreachablePoseError: the final pose does not exist.
    """
    q_minus = double_support_pose(biped, free.beta_impact, free.step_width)
    return StepBegin(q_minus, impact(biped, q_minus, final_falling_slope(free, q_minus)).slope)


def _phase(parameters: PhaseParameters) -> Phase:
    start, end, joints, fri = parameters
    return Phase(float(start), float(end), np.asarray(joints), np.asarray(fri))


def invariance_residuals(
    biped: FrontalBiped, rising: Phase, falling: Phase, step_width: float, following: Phase | None = None
) -> dict[str, float]:
    """How far two phases are from hybrid invariance; all zero on an invariant gait.

    Args:
        biped: the robot.
        rising: the rising phase.
        falling: the falling phase.
        step_width: distance between the ankles where it ends [m].
        following: rising phase that the next step begins with; default: the same again, as in a gait.

    Returns:
        Largest absolute residual of: final pose (both feet flat, ``step_width`` apart) [m, rad], pose and slope at
        impact [rad, -], pose and slope at reversal [rad, -], FRI target at reversal [m]. Slopes are divided by the
        larger of 1 and the slope itself.
    """
    start, end = (
        rising.motion(np.array([rising.beta_start, rising.beta_end])),
        falling.motion(np.array([falling.beta_start, falling.beta_end])),
    )
    begun = start if following is None else following.motion(np.array([following.beta_start]))
    q_minus = end.q[1]
    landing = impact(biped, q_minus, end.dq[1])
    inner, outer = biped.swing_sole(q_minus)
    offset = np.array([biped.chain.sole_inner, -biped.chain.sole_outer])
    feet = np.array([*(np.array([inner[0], outer[0]]) + offset - step_width), inner[1], outer[1]])

    def relative(left: FloatArray, right: FloatArray) -> float:
        return float(np.max(np.abs(left - right) / np.maximum(1.0, np.abs(right))))

    return {
        "final_pose": float(np.max(np.abs(feet))),
        "impact_pose": float(np.max(np.abs(landing.q_plus - begun.q[0]))),
        "impact_slope": relative(begun.dq[0, 1:], landing.slope),
        "reversal_pose": float(np.max(np.abs(start.q[1] - end.q[0]))),
        "reversal_slope": relative(end.dq[0], start.dq[1]),
        "reversal_fri": float(abs(start.p_fri[1] - end.p_fri[0])),
    }


def free_parameters(rising: Phase, falling: Phase, step_width: float) -> FreeParameters:
    """What a completed gait leaves free: the inverse of `complete`.

    Args:
        rising: the rising phase.
        falling: the falling phase.
        step_width: distance between the ankles [m].
    """
    return FreeParameters(
        beta_reversal=rising.beta_end,
        beta_impact=falling.beta_end,
        step_width=step_width,
        rising_columns=rising.joint_bezier[:, 2:],
        falling_columns=falling.joint_bezier[:, 2:-1],
        rising_fri=rising.fri_bezier,
        falling_fri=falling.fri_bezier[1:],
    )
