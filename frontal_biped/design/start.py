"""Where a design starts when nothing better is known."""

import numpy as np

from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import UPRIGHT
from frontal_biped.virtual_constraints.invariance import FreeParameters, double_support_pose

LARGEST_ROLL = 0.15
"""Of the pelvis, at the start [rad]: with more of it the robot would not reverse."""

LEAN = 0.03
"""Of the stance leg, from the impact to the reversal [rad]."""

LARGEST_LEAN = 0.1
"""The same, where a longer step leads elsewhere than the default one."""


def swayed_stand(biped: FrontalBiped, spec: GaitSpecification, lean: float = LEAN) -> FreeParameters:
    """A swayed stand in the middle of the allowed step widths, FRI in the middle of the sole.

    The feet stand symmetrically apart; the stance leg leans out by ``lean`` [rad] to the reversal, by 1.2 times the
    smallest range of beta at least and by `LARGEST_LEAN` at most, while the pelvis rolls so that the swing foot rises,
    flat, by twice the clearance (0.15 rad at most); the joints go there and back smoothly.

    Raises:
        UnreachablePoseError: the feet cannot stand so far apart.
    """
    # the step no wider than comfortable: half-way in the range, but at most 1.5 hip widths
    low, high = spec.step_width
    width = float(np.clip(min(0.5 * (low + high), 1.5 * biped.hip_width), low, high))
    beta_impact = symmetric_stance(biped, width)
    final = double_support_pose(biped, beta_impact, width)
    lean = min(max(lean, 1.2 * spec.min_phase_range), LARGEST_LEAN)
    reversal = final[::-1].copy()
    reversal[0] += lean
    beta_reversal = float(reversal[0])
    # lift the hip by pelvis roll: about 2 clearance over the hip width
    roll = min(2.0 * spec.swing_clearance / biped.hip_width, LARGEST_ROLL)
    if spec.max_pelvis_roll is not None:
        roll = min(roll, 0.5 * spec.max_pelvis_roll)
    reversal[1] += roll - lean
    reversal[2] -= roll
    M = max(spec.degrees)
    begin, end = final[::-1][1:], final[1:]
    ramp = np.linspace(0.0, 1.0, M + 1)
    ease = ramp**2 * (3.0 - 2.0 * ramp)
    rising = begin[:, None] + (reversal[1:] - begin)[:, None] * ease
    falling = reversal[1:, None] + (end - reversal[1:])[:, None] * ease
    middle = 0.5 * sum(biped.sole)
    return FreeParameters(
        beta_reversal,
        beta_impact,
        width,
        rising[:, 2:],
        falling[:, 2:-1],
        np.full(spec.fri_degree + 1, middle),
        np.full(spec.fri_degree, middle),
    )


def symmetric_stance(biped: FrontalBiped, step_width: float) -> float:
    """Stance ankle angle at which both feet stand flat, ``step_width`` apart, with a level pelvis [rad]."""
    ankle, hip, _, swing_ankle = biped.chain.joints
    a = hip - ankle
    # level pelvis: stance hip where the mirror image of the swing hip is; a turned by x has the horizontal part below
    horizontal = a[0] + 0.5 * (step_width - (swing_ankle[0] - ankle[0]))
    length, offset = float(np.hypot(*a)), float(np.arctan2(a[0], a[1]))
    return UPRIGHT - float(np.arcsin(np.clip(horizontal / length, -0.9, 0.9))) + offset
