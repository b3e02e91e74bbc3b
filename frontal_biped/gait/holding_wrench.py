r"""The planar gait as a motion of the whole robot in space, and what the ground must hold for it.

With every joint but the four roll joints held at the posture, pelvis pitch and yaw zero and the stance foot flat, a
planar gait is a motion of the robot in space; nothing is neglected. The price is a wrench at the stance sole that the
plane does not see: the centre of pressure lies ahead of the ankle or behind it, and a yaw moment acts. Both follow from
`model.space.plane_masses`, for the robot as its URDF has it, on either foot: legs that the planar model averages
(``symmetrise``) are taken as they are, so left and right differ by what averaging changes. With virtual legs each leg
is taken to turn as one body, as in the plane; the links between its hip joints turn a little otherwise, which on
g1_bent is 0.4 mm of the centre of pressure fore-aft, 4.5 mm sideways and 0.2 N m.

**Yaw moment that a sole holds.** What friction can hold depends on the pressure below the sole, which rigid bodies
leave open. We assume it uniform on the largest rectangle inside the sole that has the centre of pressure in its
middle, |x| <= X, |y| <= Y from there: the effective area of an eccentrically loaded footing (Meyerhof 1953). Tractions
of size mu p along one direction hold the force mu F_v and no moment about the middle; tractions of size mu p around
the middle hold no force and the moment mu F_v r, r the mean distance from the middle. Of each a share, a and 1 - a,
stays within mu p everywhere, so a force F_h and a moment M are held if

.. math:: \frac{|F_h| + |M| / r}{F_v} \le \mu, \qquad
          r = \frac{1}{XY}\int_0^X\!\!\int_0^Y \sqrt{x^2 + y^2} \;\ge\; \frac{1}{2} \sqrt{X^2 + Y^2}

(the norm is convex, so the mean of it is not below the norm of the mean, (X, Y)/2). The right-hand side is taken for r:
exact for a line, 8 % low for a square. The wrench cone of a rectangle (Caron, Pham and Nakamura 2015) asks only that
some pressure exists, all of it in the corners if need be, and allows 2 to 2.8 times as much.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.robot import FootSole
from frontal_biped.model.space.plane_masses import F_H, F_V, N_0, S_H, S_V, PlaneMasses
from frontal_biped.model.stance_map import Stance
from frontal_biped.zero_dynamics.orbit import PhaseOrbit
from frontal_biped.zero_dynamics.poincare import StepOrbit


@dataclass(frozen=True)
class HoldingWrench:
    """The wrench of the ground on the stance sole at n points of a motion in the frontal plane.

    World axes X forward, Y left, Z up; places from the sole's origin, the point below the ankle.

    Attributes:
        sole: the foot that stands.
        rows: (5, n) F_h, F_v [N], N_0, S_h, S_v [N m], as `PlaneDynamics` has them.
    """

    sole: FootSole
    rows: FloatArray

    @property
    def wrench(self) -> FloatArray:
        """(6, n) force [N] and moment about the sole's origin [N m]; there is no force along X."""
        side, rows = self.sole.side.sign, self.rows
        return np.stack(
            [np.zeros_like(rows[F_H]), -side * rows[F_H], rows[F_V], -side * rows[N_0], -rows[S_V], -side * rows[S_H]]
        )

    @property
    def cop_x(self) -> FloatArray:
        """(n,) centre of pressure ahead of the ankle [m]."""
        return self.rows[S_V] / self.rows[F_V]

    @property
    def cop_h(self) -> FloatArray:
        """(n,) centre of pressure from the ankle towards the other foot [m]: the FRI, but for legs that differ."""
        return self.rows[N_0] / self.rows[F_V]

    @property
    def yaw_moment(self) -> FloatArray:
        """(n,) moment about the vertical through the centre of pressure [N m]."""
        return -self.sole.side.sign * (self.rows[S_H] - self.cop_x * self.rows[F_H])

    @property
    def yaw_moment_at_ankle(self) -> FloatArray:
        """(n,) moment about the vertical through the ankle [N m]."""
        return -self.sole.side.sign * self.rows[S_H]

    @property
    def yaw_arm(self) -> FloatArray:
        """(n,) moment that friction holds about the centre of pressure, over mu F_v [m]; see the module.

        It means nothing where the centre of pressure is outside the sole.
        """
        x, y, sole = self.cop_x, self.cop_h, self.sole
        X, Y = np.minimum(sole.front - x, sole.back + x), np.minimum(sole.inner - y, sole.outer + y)
        return friction_arm(X, Y)

    @property
    def friction(self) -> FloatArray:
        """(2, n) F_h/F_v plus and minus what the yaw moment takes [-]; the larger size is the coefficient it needs."""
        F_h, F_v = self.rows[F_H], self.rows[F_V]
        of_moment = self.yaw_moment / self.yaw_arm
        return np.stack([(F_h + of_moment) / F_v, (F_h - of_moment) / F_v])


def friction_arm(X: FloatArray, Y: FloatArray) -> FloatArray:
    """r of a rectangle |x| <= X, |y| <= Y [m], from below; see the module."""
    return 0.5 * np.sqrt(X * X + Y * Y)


class StepHolding(NamedTuple):
    """Holding wrenches of a step.

    Attributes:
        rising: of the rising phase, one for each foot that may stand: left, right.
        falling: of the falling phase likewise.
    """

    rising: tuple[HoldingWrench, ...]
    falling: tuple[HoldingWrench, ...]


def step_holding(biped: FrontalBiped, step: StepOrbit) -> StepHolding:
    """Holding wrenches at the points of a step.

    Raises:
        RobotError: the length of the soles is not known.
    """
    masses = [PlaneMasses.of(biped, stance) for stance in (Stance.LEFT, Stance.RIGHT)]

    def along(orbit: PhaseOrbit) -> tuple[HoldingWrench, ...]:
        q, dq, ddq, *_ = orbit.motion
        return tuple(
            HoldingWrench(sole, robot.along(q, dq, ddq).at(orbit.ddbeta, orbit.dbeta**2))
            for sole, robot in zip(biped.robot.soles, masses, strict=True)
        )

    return StepHolding(along(step.rising), along(step.falling))
