"""Hybrid invariance in ball arithmetic (`virtual_constraints.invariance`): a step from what invariance leaves free."""

from dataclasses import dataclass

from frontal_biped.virtual_constraints.invariance import FreeParameters
from frontal_biped.zero_dynamics.proof.balls import Ball, Number, arb, is_negative, is_positive, narrowed_jet, sin_cos
from frontal_biped.zero_dynamics.proof.chain import BallChain
from frontal_biped.zero_dynamics.proof.half_step import Curve, HalfStep, NotEnclosedError


@dataclass(frozen=True)
class BallStep:
    """A step whose columns are imposed at a reversal.

    Attributes:
        rising: from the impact to the reversal.
        falling: backwards, from the impact to the reversal.
        speed_ratio: dbeta after the impact over dbeta before it [-].
    """

    rising: HalfStep
    falling: HalfStep
    speed_ratio: Number

    def narrowed_by_parameter(self, middle: "BallStep", w: Ball) -> "BallStep":
        """For all reversals of an interval, from its middle."""
        return BallStep(
            self.rising.narrowed_by_parameter(middle.rising, w),
            self.falling.narrowed_by_parameter(middle.falling, w),
            narrowed_jet(middle.speed_ratio, self.speed_ratio, w),
        )

    def jump(self) -> Number:
        """g [-].

        Raises:
            NotEnclosedError: I_P may vanish at the impact.
        """
        ratio = self.speed_ratio * self.rising.at(arb(0)).I_P / self.falling.at(arb(0)).I_P
        return ratio * ratio


@dataclass(frozen=True)
class BallGait:
    """What invariance leaves free, exactly as stored, and what follows from it whatever the reversal is.

    Attributes:
        chain: the robot.
        free: the parameters; its ``beta_reversal`` is the planned one.
        q_minus: (4,) pose at the impact [rad].
        landed: (4,) velocities after the impact of a unit of dbeta alone, and of the other joints' part of the slope.
    """

    chain: BallChain
    free: FreeParameters
    q_minus: list[Ball]
    landed: tuple[list[Ball], list[Ball]]

    @classmethod
    def of(cls, chain: BallChain, free: FreeParameters) -> "BallGait":
        """The gait of a robot's free parameters.

        Raises:
            NotEnclosedError: the final pose is not known to exist.
        """
        q_minus = double_support_pose(chain, arb(free.beta_impact), arb(free.step_width))
        last = [arb(float(x)) for x in free.falling_columns[:, -1]]
        nothing = arb(0)
        alone = [arb(1), nothing, nothing, nothing]
        others = [nothing, *(q - b for q, b in zip(q_minus[1:], last, strict=True))]
        try:
            first, second = chain.landed_slopes(q_minus, [alone, others])
        except ZeroDivisionError as error:
            raise NotEnclosedError("impact") from error
        return cls(chain, free, q_minus, (first, second))

    @property
    def begin(self) -> Ball:
        """beta_r+ [rad]."""
        return self.q_minus[3]

    @property
    def end(self) -> Ball:
        """beta_f- [rad]."""
        return self.q_minus[0]

    def imposed(self, reversal: Number) -> BallStep:
        """The step with invariance imposed at a reversal [rad]."""
        free, q_minus = self.free, self.q_minus
        degree = free.falling_columns.shape[1] + 2
        steep = arb(degree) / (self.end - reversal)
        plus = [steep * b + a for a, b in zip(*self.landed, strict=True)]
        up, down = reversal - self.begin, reversal - self.end
        rising: list[list[Number]] = []
        falling: list[list[Number]] = []
        for i in range(3):
            first = q_minus[2 - i]
            second = plus[1 + i] / plus[0] * (up / (free.rising_columns.shape[1] + 1)) + first
            columns: list[Number] = [first, second, *(arb(float(x)) for x in free.rising_columns[i])]
            last, before = columns[-1], columns[-2]
            turned = (down / up) * (before - last) + last  # range_f / range_r is negative
            rising.append(columns)
            inner = [arb(float(x)) for x in free.falling_columns[i]]
            falling.append([q_minus[1 + i], *reversed(inner), turned, last])
        fri = [arb(float(x)) for x in free.rising_fri]
        fri_f = [fri[-1], *(arb(float(x)) for x in free.falling_fri)]
        halves = (
            half_step(self.chain, self.begin, up, rising, fri),
            half_step(self.chain, self.end, down, falling, fri_f[::-1]),
        )
        return BallStep(*halves, plus[0])


def half_step(chain: BallChain, start: Ball, span: Number, joints: list[list[Number]], fri: list[Number]) -> HalfStep:
    """The half step of Bezier columns.

    Args:
        chain: the robot.
        start: beta at the impact [rad].
        span: beta at the reversal minus that [rad].
        joints: columns of the three joints after the first, from the impact on [rad].
        fri: those of the FRI target [m].
    """
    return HalfStep(chain, span, _absolute_angles(start, span, joints), Curve.of(fri, span))


def _absolute_angles(start: Ball, span: Number, joints: list[list[Number]]) -> tuple[Curve, ...]:
    """Bezier columns of the links' absolute angles, from those of the joints; beta itself is linear."""
    degree = len(joints[0]) - 1
    quarter = arb.pi() / 2
    columns = [span * (arb(k) / degree) + start + quarter for k in range(degree + 1)]
    angles = [columns]
    for joint in joints:
        angles.append([b + a + quarter for a, b in zip(angles[-1], joint, strict=True)])
    return tuple(Curve.of(own, span) for own in angles)


def double_support_pose(chain: BallChain, beta: Ball, width: Ball) -> list[Ball]:
    """(4,) pose with both feet flat, as `invariance.double_support_pose`.

    Raises:
        NotEnclosedError: the pose is not known to exist.
    """
    a, b, c = chain.bodies[0].tip, chain.bodies[1].tip, chain.bodies[2].tip
    quarter = arb.pi() / 2
    leg = beta + quarter
    sin, cos = sin_cos(leg)
    d_h, d_v = width - (cos * a[0] - sin * a[1]), -(sin * a[0] + cos * a[1])
    along, across = b[0] * c[0] + b[1] * c[1], -b[0] * c[1] + b[1] * c[0]
    reach = (along * along + across * across).sqrt()
    cosine = (d_h * d_h + d_v * d_v - _squared(b) - _squared(c)) / (2 * reach)
    centre = arb.atan2(across, along)
    if not (is_positive(1 - cosine * cosine) and (is_positive(centre) or is_negative(centre))):
        raise NotEnclosedError("final pose")
    x = centre - cosine.acos() if is_positive(centre) else centre + cosine.acos()
    sin, cos = sin_cos(x)
    tip_h, tip_v = b[0] + cos * c[0] - sin * c[1], b[1] + sin * c[0] + cos * c[1]
    pelvis = arb.atan2(tip_h * d_v - tip_v * d_h, tip_h * d_h + tip_v * d_v)
    return [beta, pelvis - leg - quarter, x - quarter, -pelvis - x - quarter]


def _squared(x: tuple[Ball, Ball]) -> Ball:
    return x[0] * x[0] + x[1] * x[1]
