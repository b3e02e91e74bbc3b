r"""Landings wider or narrower than planned: where the falling phase ends then, and in which pose.

The planar gait lands with the ankles w apart. A landing w + d apart, both feet flat, is taken with the centre of mass
d/2 further from the stance ankle: it is then d/2 further from the new one too, and under the same FRI

.. math:: E(s) = \tfrac12 \omega^2 \left[(s - p)^2 - (s_r - p)^2\right]

what the fall gains by the longer way is what the next rise to the same reversal needs more. So a robot that lands wide
with the one foot and narrow with the other walks sideways on the orbit of the gait, but for what the impacts take.
"""

import numpy as np
from scipy.optimize import brentq

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import UnreachablePoseError
from frontal_biped.gait.planned_step import PlannedStep
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.invariance import double_support_pose

WIDEST, POINTS = 0.12, 13
"""Largest change of the width that is tabulated, if the legs reach that far [m], number of widths to either side."""

TURNED = 0.12
"""How far the stance ankle may be turned from the planned landing to find a pose [rad]."""


class LandingWidths:
    """Poses at landings of other widths than the gait's.

    Args:
        biped: the robot.
        gait: its landing.

    Attributes:
        width: of the gait [m].
        narrowest: change of the width from which on poses are known [m].
        widest: to which they are [m].
    """

    def __init__(self, biped: FrontalBiped, gait: PlannedStep) -> None:
        planned = gait.falling.motion(np.array([gait.falling.beta_end])).q[0]
        self.width = float(biped.joint_positions(planned)[-1, 0])
        sway = float(biped.com(planned)[0])
        known = [(0.0, 0.0, 0.0, 0.0)]
        for side in (-1.0, 1.0):
            for change in side * np.linspace(0.0, WIDEST, POINTS)[1:]:
                pose = _pose(biped, float(planned[0]), self.width + change, sway + 0.5 * change)
                if pose is None:
                    break
                known.append((change, *(pose - planned)[1:]))
        table = np.array(sorted(known))
        self._changes, self._errors = table[:, 0], table[:, 1:]
        self.narrowest, self.widest = float(self._changes[0]), float(self._changes[-1])

    def within(self, change: float) -> float:
        """The nearest change of the width [m] of which a pose is known."""
        return min(max(change, self.narrowest), self.widest)

    def pose_error(self, change: float) -> FloatArray:
        """(3,) by how much the body coordinates at the landing differ from the planned ones [rad]."""
        return np.array([np.interp(change, self._changes, error) for error in self._errors.T])


def _pose(biped: FrontalBiped, beta: float, width: float, sway: float) -> FloatArray | None:
    """Both feet flat, the centre of mass at a sway; None where the legs do not reach."""

    def beyond(turned: float) -> float:
        return float(biped.com(double_support_pose(biped, beta + turned, width))[0]) - sway

    try:
        low, high = beyond(-TURNED), beyond(TURNED)
        if low * high > 0.0:
            return None
        found: FloatArray = double_support_pose(biped, beta + float(brentq(beyond, -TURNED, TURNED)), width)
    except UnreachablePoseError:
        return None
    return found


def standing_pose(biped: FrontalBiped, gait: PlannedStep) -> FloatArray | None:
    """(4,) both feet flat as far apart as the gait lands, the centre of mass midway; None where there is none."""
    planned = gait.falling.motion(np.array([gait.falling.beta_end])).q[0]
    width = float(biped.joint_positions(planned)[-1, 0])
    return _pose(biped, float(planned[0]), width, 0.5 * width)
