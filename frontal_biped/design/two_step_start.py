"""Where the design of two different steps starts: at two steps of other widths, carried over.

Feet that stand farther apart, or nearer, turn the stance leg before it moves at all. Each landing pose is replaced by
the one of the new width, the stance leg turned as a level stand on both feet turns it; the reversal stays beyond both
ends of its step: its stance leg is turned by the larger of both changes, pelvis and swing foot keep their angles, and
the swing leg takes the mean. In between the columns follow linearly.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.start import symmetric_stance
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import relabel
from frontal_biped.virtual_constraints.invariance import FreeParameters, double_support_pose


class _Landing(NamedTuple):
    """A landing that is moved to another width.

    Attributes:
        beta: new stance ankle angle at the impact [rad].
        change: (4,) of the pose [rad].
    """

    beta: float
    change: FloatArray


def carried_over(
    biped: FrontalBiped, steps: tuple[FreeParameters, FreeParameters], widths: tuple[float, float]
) -> tuple[FreeParameters, FreeParameters]:
    """What is free of two steps in turn, moved to other step widths.

    Args:
        biped: the robot.
        steps: what is free of step A and of step B.
        widths: where A and where B shall land [m].

    Raises:
        UnreachablePoseError: the feet cannot stand so.
    """
    a, b = (_moved(biped, free, width) for free, width in zip(steps, widths, strict=True))
    return _carried(steps[0], widths[0], b, a), _carried(steps[1], widths[1], a, b)


def _moved(biped: FrontalBiped, free: FreeParameters, width: float) -> _Landing:
    turned = symmetric_stance(biped, width) - symmetric_stance(biped, free.step_width)
    before = double_support_pose(biped, free.beta_impact, free.step_width)
    after = double_support_pose(biped, free.beta_impact + turned, width)
    return _Landing(free.beta_impact + turned, after - before)


def _carried(free: FreeParameters, width: float, begin: _Landing, end: _Landing) -> FreeParameters:
    start, final = relabel(begin.change), end.change
    leg = max(float(start[0]), float(final[0]))
    swing_leg = 0.5 * float(start[:3].sum() + final[:3].sum())
    reversal = np.array([-leg, swing_leg, -swing_leg])  # of the three joints after the stance ankle
    M = free.rising_columns.shape[1] + 1
    k = np.arange(M + 1) / M
    rising = np.outer(start[1:], 1.0 - k) + np.outer(reversal, k)
    falling = np.outer(reversal, 1.0 - k) + np.outer(final[1:], k)
    return replace(
        free,
        beta_reversal=free.beta_reversal + leg,
        beta_impact=end.beta,
        step_width=width,
        rising_columns=free.rising_columns + rising[:, 2:],
        falling_columns=free.falling_columns + falling[:, 2:-1],
    )
