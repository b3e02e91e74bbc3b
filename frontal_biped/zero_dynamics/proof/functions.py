"""The two functions whose zeros are reversal points, enclosed: E at fixed parameters, and S with invariance imposed."""

from functools import cached_property

from frontal_biped.zero_dynamics.proof.ball_gait import BallGait, BallStep
from frontal_biped.zero_dynamics.proof.balls import Ball, Jet, Number, arb, coefficient, exp, is_negative, narrowed_jet
from frontal_biped.zero_dynamics.proof.half_step import HalfStep, NotEnclosedError
from frontal_biped.zero_dynamics.proof.passage import Passed, across, cuts_of, on_panel, passed, passed_by_all
from frontal_biped.zero_dynamics.proof.signs import Known

SHARP, BROAD = 1e-14, 1e-8
"""Shares of the energy that a panel may widen its ball by: where a point is enclosed, and where an interval is."""


class Imposed:
    """S(beta) = E(beta; b(beta)), whose zeros are the gaits.

    Args:
        gait: the parameters.
    """

    def __init__(self, gait: BallGait) -> None:
        self.gait = gait

    @cached_property
    def _sharp(self) -> tuple[list[Ball], list[Ball]]:
        return self._cuts(SHARP)

    @cached_property
    def _broad(self) -> tuple[list[Ball], list[Ball]]:
        return self._cuts(BROAD)

    def _cuts(self, narrow: float) -> tuple[list[Ball], list[Ball]]:
        step = self.gait.imposed(arb(self.gait.free.beta_reversal))
        return cuts_of(step.rising, narrow), cuts_of(step.falling, narrow)

    def halves(self, reversal: Ball) -> tuple[BallStep, Passed, Passed]:
        """The step imposed at a reversal, a point or nearly one [rad], and its rising and falling half.

        Raises:
            NotEnclosedError: I_P may vanish.
        """
        step = self.gait.imposed(reversal)
        up, down = self._sharp
        return step, passed(step.rising, up), passed(step.falling, down)

    def at(self, reversal: Ball | float) -> Ball:
        """S at a reversal [rad].

        Raises:
            NotEnclosedError: I_P may vanish.
        """
        step, rising, falling = self.halves(arb(reversal))
        return step.jump() * falling.W - rising.W

    def on(self, low: float, high: float) -> Known:
        """S and S' on an interval of reversals [rad].

        Raises:
            NotEnclosedError: I_P may vanish.
        """
        middle = (arb(low) + arb(high)) / 2
        w = (arb(high) - arb(low)) / 2
        thin = self.gait.imposed(Jet([middle, arb(1), arb(0)]))
        wide = self.gait.imposed(Jet([arb(low).union(arb(high)), arb(1), arb(0)])).narrowed_by_parameter(thin, w)
        up, down = self._broad
        rising, risings = passed_by_all(thin.rising, wide.rising, w, up)
        falling, fallings = passed_by_all(thin.falling, wide.falling, w, down)
        own = thin.jump() * falling.W - rising.W
        value, slope, _ = narrowed_jet(own, wide.jump() * fallings.W - risings.W, w).parts
        return Known(value, slope)

    def partials(self, low: float, high: float) -> tuple[Ball, Ball]:
        """dE/dbeta and dE/dx of E(beta; b(x)) for all beta and x of an interval [rad].

        Raises:
            NotEnclosedError: I_P may vanish.
        """
        middle, w = (arb(low) + arb(high)) / 2, (arb(high) - arb(low)) / 2
        betas = arb(low).union(arb(high))
        thin = self.gait.imposed(Jet([middle, arb(1)]))
        wide = self.gait.imposed(Jet([betas, arb(1)])).narrowed_by_parameter(thin, w)
        works, slopes = [], []
        for a, b, begin, cuts in zip(
            (thin.rising, thin.falling),
            (wide.rising, wide.falling),
            (self.gait.begin, self.gait.end),
            self._broad,
            strict=True,
        ):
            ratios = (betas - begin) / a.span, (betas - begin) / b.span
            _, all_ = passed_by_all(a, b, w, cuts, ratios)
            works.append(all_.W)
            there = b.at(ratios[1])
            slopes.append(exp(-all_.K).parts[0] * there.drive.parts[0])
        jump = wide.jump()
        E = jump * works[1] - works[0]
        return slopes[0] - jump.parts[0] * slopes[1], E.parts[1]


class Fixed:
    """E(beta; b), the paper's Z but for a positive factor, along an interval from left to right.

    Args:
        gait: the parameters, imposed at their planned reversal.
        low: where it begins [rad].

    Raises:
        NotEnclosedError: I_P may vanish before.
    """

    def __init__(self, gait: BallGait, low: float) -> None:
        self._step = gait.imposed(arb(gait.free.beta_reversal))
        self._begins = gait.begin, gait.end
        self._jump = self._step.jump()
        self._at = {low: tuple(self._up_to(half, arb(low), begin) for half, begin in self._halves)}

    @property
    def _halves(self) -> list[tuple[HalfStep, Ball]]:
        return list(zip((self._step.rising, self._step.falling), self._begins, strict=True))

    @staticmethod
    def _up_to(half: HalfStep, beta: Ball, begin: Ball) -> Passed:
        ratio: Number = (beta - begin) / half.span
        return passed(half, [ratio * cut for cut in cuts_of(half, SHARP)])

    def at(self, beta: float) -> Ball:
        """E at a point that was passed [rad].

        Raises:
            NotEnclosedError: it was not: I_P may vanish before.
        """
        rising, falling = self._passed(beta)
        return self._jump * falling.W - rising.W

    def _passed(self, beta: float) -> tuple[Passed, ...]:
        if beta not in self._at:
            raise NotEnclosedError("I_P")
        return self._at[beta]

    def on(self, low: float, high: float) -> Known:
        """E and E' on an interval that begins where another one ended [rad].

        Raises:
            NotEnclosedError: I_P may vanish on it, or the robot may not turn back there.
        """
        ends, slopes = [], []
        for (half, begin), at in zip(self._halves, self._passed(low), strict=True):
            a, b = ((arb(x) - begin) / half.span for x in (low, high))
            panel, h = on_panel(half, a, b), (b - a) / 2
            end = across(panel, at, h, half.span)
            if end.W.rad() - at.W.rad() > BROAD * (abs(end.W.mid()) + 1):
                raise NotEnclosedError("W")
            wide = panel.wide
            K = at.K + coefficient(wide.rate * half.span, 0) * arb(0).union(2 * h)
            drive = coefficient(wide.drive, 0)
            ends.append(end)
            slopes.append((K, drive))
        self._at[high] = tuple(ends)
        if not is_negative(slopes[0][1]):
            raise NotEnclosedError("drive")
        (K_r, drive_r), (K_f, drive_f) = slopes
        slope = exp(-K_r) * drive_r - self._jump * exp(-K_f) * drive_f
        value = self.at(low) + slope * arb(0).union(arb(high) - arb(low))
        return Known(value, slope)
