r"""The double-support family: every pose with both feet flat, ankles a given width apart. One freedom is left, beta.

Between the stance ankle and the swing ankle stand three links r_0, r_1, r_2 (stance leg, hip line, swing leg) with
absolute angles theta_i, and r_0 + r_1 + r_2 does not change. A link that turns moves its end across itself; turned back
by a quarter, first and second derivative with respect to beta = theta_0 are

.. math:: r_1 \theta_1' + r_2 \theta_2' = -r_0, \qquad
          P (r_1 \theta_1'' + r_2 \theta_2'') = r_0 + r_1 \theta_1'^2 + r_2 \theta_2'^2,

P a quarter turn: two linear equations each, singular only where hip line and swing leg are parallel. The swing foot
stays flat, so q' = (1, theta_1' - 1, theta_2' - theta_1', -theta_2').

The family is the same curve seen from either foot: relabelled, a pose at beta is the pose at its q_4, and q_4 falls
where beta rises. Half-way, where both are equal, the robot stands as its own mirror image.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import UnreachablePoseError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.invariance import double_support_pose

LARGEST_LEAN = 0.6
"""How far from half-way the family is looked at [rad]: by then the centre of mass is beyond the feet."""


class FamilyPoint(NamedTuple):
    """One pose of the family, and how the family goes on from there.

    Attributes:
        q: (4,) pose [rad].
        dq: (4,) dq/dbeta, first entry 1 [-].
        ddq: (4,) d2q/dbeta2, first entry 0 [1/rad].
    """

    q: FloatArray
    dq: FloatArray
    ddq: FloatArray


@dataclass(frozen=True)
class DoubleSupportFamily:
    """Poses with both feet flat on level ground.

    Attributes:
        biped: the robot.
        width: distance between the ankles [m].
    """

    biped: FrontalBiped
    width: float

    def at(self, beta: float) -> FamilyPoint:
        """Pose, slope and curvature at the stance ankle angle beta [rad].

        Raises:
            UnreachablePoseError: there is no such pose.
        """
        q = np.asarray(double_support_pose(self.biped, beta, self.width), dtype=float)
        r_0, r_1, r_2 = np.diff(self.biped.joint_positions(q), axis=0)
        links = np.stack([r_1, r_2], axis=1)
        theta = np.array([1.0, *np.linalg.solve(links, -r_0)])
        across = r_0 + theta[1] ** 2 * r_1 + theta[2] ** 2 * r_2
        turned_back = np.array([across[1], -across[0]])
        dtheta = np.array([0.0, *np.linalg.solve(links, turned_back)])
        return FamilyPoint(q, _from_angles(theta), _from_angles(dtheta))

    def from_other_foot(self, beta: float) -> float:
        """The stance ankle angle of the same pose with the other foot taken as the stance foot, q_4 [rad]."""
        return float(self.at(beta).q[3])

    def half_way(self) -> float:
        """The stance ankle angle at which both legs are alike [rad].

        Raises:
            UnreachablePoseError: the feet cannot stand so far apart.
        """
        # q_4 falls with beta, so beta - q_4 rises: shrink the bracket until both its ends exist
        guess = self._symmetric_guess()
        reach = LARGEST_LEAN

        def difference(beta: float) -> float:
            return beta - self.from_other_foot(beta)

        while reach > 1e-3:
            try:
                if difference(guess - reach) < 0.0 < difference(guess + reach):
                    return float(brentq(difference, guess - reach, guess + reach, xtol=1e-14))
            except UnreachablePoseError:
                pass
            reach *= 0.5
        raise UnreachablePoseError(f"both feet cannot stand {self.width:.4g} m apart with the legs alike; change width")

    def _symmetric_guess(self) -> float:
        """Where a level pelvis puts the stance hip at the mirror image of the swing hip [rad]."""
        ankle, hip, _, swing_ankle = self.biped.chain.joints
        leg = hip - ankle
        sideways = leg[0] + 0.5 * (self.width - (swing_ankle[0] - ankle[0]))
        upright = float(np.arctan2(leg[0], leg[1]))
        leaning = float(np.arcsin(np.clip(sideways / np.hypot(*leg), -0.9, 0.9)))
        return float(-0.5 * np.pi - leaning + upright)


def _from_angles(theta: FloatArray) -> FloatArray:
    """(4,) rates of the joints from those of the three links; the swing foot does not turn."""
    return np.array([theta[0], theta[1] - theta[0], theta[2] - theta[1], -theta[2]])
