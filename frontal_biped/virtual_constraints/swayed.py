r"""Virtual constraints of a phase as functions of the sway: how far the centre of mass is inwards of the stance ankle.

A phase may be parametrised by anything that runs monotonically along it. The paper takes beta, the angle of the stance
ankle; on gaits of least torque it runs over 0.03 rad while the joints turn by five times as much, stands all but still
at the impact, and where a step begins on other ground than planned a phase anchored to the robot may find beta between
start and end not moving at all. The sway

.. math:: s = p_{cm}^h(q)

runs over centimetres, with a speed that the angular momentum gives it (sigma is about m z ds/dt), so that it cannot
stand still before the robot does. On the orbit nothing changes: the same poses at the same times.

.. math:: h_d(s) = h_o(t(s)) + e_0\, a(u) + e_0'\, b(u / c), \qquad u = (s - s_0) / (s_1 - s_0)

h_o is the planned path; t(s) = s, stretched linearly where the phase begins before its planned start, so that it ends
where it was to end; e_0 and e_0' are the errors of pose and slope where it begins, faded out by Hermite's polynomials
a = (1 + 2u)(1 - u)^2 and b = x(1 - x)^2. A phase may be asked to end elsewhere, further on and in another pose: e_1
is its error there (see `OtherEnd`). Slopes fade sooner, by the share c: a slope error that is carried along the
whole phase bends it. Past its ends a phase goes on with its slope, which dies out.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.numerics.between import between
from frontal_biped.virtual_constraints.phase import Phase

POINTS = 81
"""Points of a phase between which its path is interpolated by cubics."""

LEAST_RANGE = 0.015
"""Shortest way that a phase is given [m], unless it is planned shorter; one that begins nearer to its end than that
ends later."""

SLOPE_SHARE = 0.2
"""c: share of a phase in which an error of the slope is faded out [-]."""

BEYOND = 0.1
"""Length, in units of the phase's, over which its slope dies out past an end [-]."""

BODY = slice(0, 3)
"""Of what is interpolated: the joints; then the FRI target."""


class SwayTargets(NamedTuple):
    """What a phase asks for at one sway.

    Attributes:
        h_d: (3,) body coordinates [rad].
        h_d1: (3,) their derivative with respect to s [rad/m].
        h_d2: (3,) their second derivative [rad/m^2].
        p_fri: FRI target [m].
    """

    h_d: FloatArray
    h_d1: FloatArray
    h_d2: FloatArray
    p_fri: float


class OtherEnd(NamedTuple):
    """Another end of a phase than planned.

    Attributes:
        further: by how much the sway there is larger [m].
        error: (3,) by how much the body coordinates differ there [rad].
    """

    further: float
    error: FloatArray


AS_PLANNED = OtherEnd(0.0, np.zeros(3))


class SwayedPhase:
    """A planned phase over the sway.

    Args:
        biped: the robot.
        phase: its virtual constraints.

    Attributes:
        start: sway where it is to begin [m].
        end: where it is to end [m].
        cubics: (pieces, 4, 4) of each piece the coefficients, the highest power first, of joints and FRI target.

    Raises:
        SimulationError: the sway does not run one way along the phase.
    """

    def __init__(self, biped: FrontalBiped, phase: Phase) -> None:
        motion = phase.motion(np.linspace(phase.beta_start, phase.beta_end, POINTS))
        s = sways(biped, motion.q)
        self.start, self.end = float(s[0]), float(s[-1])
        order = np.argsort(s)
        along = np.column_stack([motion.q[:, 1:], motion.p_fri])
        ds = np.array([float(biped.com_velocity(*at)[0]) for at in zip(motion.q, motion.dq, strict=True)])
        slopes = np.column_stack([motion.dq[:, 1:], motion.dp_fri]) / ds[:, None]
        first, last = slopes[order[0]], slopes[order[-1]]
        spline = CubicSpline(s[order], along[order], bc_type=((1, first), (1, last)))
        self._knots = spline.x[1:-1].copy()
        self.cubics = np.ascontiguousarray(spline.c.transpose(1, 0, 2))
        self._first = spline.x[:-1].copy()

    def place(self, s: float) -> tuple[int, float]:
        """Which of the cubics holds at a sway [m], and how far behind its beginning that is [m].

        SciPy's own evaluation answers arrays, and would take a quarter of a control tick for one point.
        """
        piece = int(self._knots.searchsorted(s))
        return piece, s - self._first.item(piece)

    def begun_as_planned(self) -> "BegunPhase":
        """The phase as it was planned."""
        nothing = np.zeros(3)
        return BegunPhase(self, self.start, nothing, nothing)

    def begun(
        self,
        s: float,
        pose: FloatArray,
        slope: FloatArray | None,
        other_end: "OtherEnd | None" = None,
    ) -> "BegunPhase":
        """The phase from where the robot is.

        Args:
            s: sway [m].
            pose: (3,) body coordinates there [rad].
            slope: (3,) their derivative with respect to s [rad/m]; None: that of the plan.
            other_end: where it ends; None: as planned.
        """
        end = AS_PLANNED if other_end is None else other_end
        plain = BegunPhase(self, s, np.zeros(3), np.zeros(3), end).at(s)
        error = np.zeros(3) if slope is None else slope - plain.h_d1
        return BegunPhase(self, s, pose - plain.h_d, error, end)


class BegunPhase:
    """A phase that began somewhere.

    Args:
        planned: the phase.
        s: sway where it began [m].
        error: (3,) of the pose there [rad].
        slope_error: (3,) of the slope there [rad/m].
        other_end: where it ends, and in which pose.
    """

    def __init__(
        self,
        planned: SwayedPhase,
        s: float,
        error: FloatArray,
        slope_error: FloatArray,
        other_end: OtherEnd = AS_PLANNED,
    ) -> None:
        self._planned = planned
        sense = 1.0 if planned.end > planned.start else -1.0
        self._start = s
        self._end_error = other_end.error if other_end.error.any() else None
        least = min(LEAST_RANGE, abs(planned.end - planned.start))
        self._length = sense * max(sense * (planned.end + other_end.further - s), least)
        # begun on its way, it is what is left of the plan
        self._from = s if 0.0 < sense * (s - planned.start) < sense * (planned.end - planned.start) else planned.start
        self._stretch = (planned.end - self._from) / self._length
        # what is added up: the cubic of a piece of the plan, and the errors, none of which is of the FRI target
        self._piece, self._sum = -1, np.zeros((6, 4))
        self._sum[4:, BODY] = error - other_end.error, slope_error

    def at(self, s: float) -> SwayTargets:
        """What is asked for at a sway s [m]."""
        u = (s - self._start) / self._length
        inside = between(0.0, u, 1.0)
        targets = self._inside(inside)
        if u == inside:
            return targets
        past = (u - inside) / BEYOND
        kept, side, length = float(np.exp(-abs(past))), float(np.sign(past)), BEYOND * self._length
        return SwayTargets(
            targets.h_d + targets.h_d1 * (length * side * (1.0 - kept)),
            targets.h_d1 * kept,
            targets.h_d1 * (-kept * side / length),
            targets.p_fri,
        )

    def _inside(self, u: float) -> SwayTargets:
        k, length = self._stretch, self._length
        piece, d = self._planned.place(self._from + k * length * u)
        if piece != self._piece:
            self._piece, self._sum[:4] = piece, self._planned.cubics[piece]
        w = 1.0 - u
        # the one error fades out as the other fades in: a(u) and 1 - a(u); that of the slope by b(x)
        a, a_1, a_2 = (1.0 + 2.0 * u) * w * w, -6.0 * u * w / length, (12.0 * u - 6.0) / length**2
        b = b_1 = b_2 = 0.0
        x = u / SLOPE_SHARE
        if x < 1.0:
            w, short = 1.0 - x, SLOPE_SHARE * length
            b, b_1, b_2 = short * x * w * w, w * w - 2.0 * x * w, (2.0 * x - 4.0 * w) / short
        # fmt: off
        shares = (
            d * d * d, d * d, d, 1.0, a, b,
            3.0 * k * d * d, 2.0 * k * d, k, 0.0, a_1, b_1,
            6.0 * k * k * d, 2.0 * k * k, 0.0, 0.0, a_2, b_2,
        )
        # fmt: on
        h = np.array(shares).reshape(3, 6).dot(self._sum)
        if self._end_error is not None:
            h[0, BODY] += self._end_error
        return SwayTargets(h[0, BODY], h[1, BODY], h[2, BODY], h.item(3))


def runs_one_way(biped: FrontalBiped, phases: Iterable[Phase]) -> bool:
    """Does the centre of mass move outwards all along rising phases and inwards all along falling ones?

    Only then can they be followed over the sway. A robot whose legs carry most of its mass may sway the other way.
    """
    for phase in phases:
        motion = phase.motion(np.linspace(phase.beta_start, phase.beta_end, POINTS))
        if not (np.diff(_sways(biped, motion.q)) * phase.range < 0.0).all():
            return False
    return True


def sways(biped: FrontalBiped, q: FloatArray) -> FloatArray:
    """(n,) sway [m] of configurations q (n, 4) [rad] along a phase, from one end to the other.

    Raises:
        SimulationError: the sway does not run one way along them.
    """
    s = _sways(biped, q)
    if not _one_way(s):
        raise SimulationError(
            f"{biped.name}: the centre of mass turns back along a phase of this gait, which can therefore not be walked"
            " in space; design one with a larger min_phase_range or a smaller max_pelvis_roll"
        )
    return s


def _sways(biped: FrontalBiped, q: FloatArray) -> FloatArray:
    return np.array([float(biped.com(row)[0]) for row in q])


def _one_way(s: FloatArray) -> bool:
    way = np.diff(s)
    return bool((way > 0.0).all() or (way < 0.0).all())
