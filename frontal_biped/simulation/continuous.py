"""A phase in continuous time: the controller acts at every instant, and events are located, not stepped over.

Two ways to follow it, to the same tolerances. Where the controller answers many states at once, by collocation, stretch
after stretch; past places where limits bind or the virtual constraints change form, and all along where the controller
answers one state at a time, by SciPy's DOP853. Guards are looked at where the solution is known, and their first zero
is located on it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Controller, many_at_once
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.state import State
from frontal_biped.numerics.collocation import Collocation, Stretch
from frontal_biped.simulation.hybrid_system import EventKind, Guard, Guards
from frontal_biped.simulation.loop import PHASE_TIME_LIMIT, TIMED_OUT, TOO_STIFF
from frontal_biped.virtual_constraints.phase import StepPhase

MOST_EVALUATIONS = 8_000
"""Of the controller in one phase by DOP853: a phase of a walk takes about a thousand, one that falls up to 4000."""

BRIDGE = 0.01
"""Time that DOP853 follows the motion where collocation gives up [s]; twice as long each time it does so again."""

LOOKS = 2
"""At every so many of the points of a stretch guards are looked at: as often as DOP853 steps on a walk, 5 to 20 ms."""

ROUNDING = 4.0 * float(np.finfo(float).eps)
"""To which events are located, relative to their time."""


class Ended(NamedTuple):
    """How a phase ended.

    Attributes:
        t: when [s].
        state: there.
        why: the event, or the outcome of a walk that ends without one.
    """

    t: float
    state: State
    why: EventKind | str


class Piece(NamedTuple):
    """A part of the solution.

    Attributes:
        end: its time [s].
        at: states (T, 8) at times (T,) [s] up to there.
    """

    end: float
    at: Callable[[FloatArray], FloatArray]


@dataclass(frozen=True)
class PhaseFlow:
    """The motion in one phase, in continuous time.

    Attributes:
        pieces: of the solution, in order.
        stretches: those of them that collocation found.
        begun: state at the start.
        ended: how it ended.
    """

    pieces: list[Piece]
    stretches: list[Stretch]
    begun: State
    ended: Ended

    def samples(self, times: FloatArray) -> FloatArray:
        """States (T, 8) at times (T,) [s] of which the first and the last are those of start and end."""
        ends = np.array([piece.end for piece in self.pieces[:-1]])
        parts = np.split(times, np.searchsorted(times, ends, side="right"))
        found = [piece.at(part) for piece, part in zip(self.pieces, parts, strict=True) if len(part)]
        x: FloatArray = np.concatenate(found)
        x[0], x[-1] = np.concatenate(self.begun), np.concatenate(self.ended.state)
        return x


def follow_phase(
    controller: Controller,
    plant: FrontalBiped,
    phase: StepPhase,
    t: float,
    state: State,
    guards: Guards,
    rtol: float,
    atol: float,
    like: PhaseFlow | None = None,
) -> PhaseFlow:
    """Follow a phase from time t [s] to its first event.

    Args:
        controller: commands torques.
        plant: the robot that moves, on its stance foot.
        phase: rising or falling.
        t: when it begins [s].
        state: there.
        guards: whose crossing ends the phase.
        rtol: relative tolerance.
        atol: absolute tolerance.
        like: the phase of this kind of the last step, which this one may resemble.
    """
    until = t + PHASE_TIME_LIMIT
    collocation = _collocation(controller, plant, phase, rtol, atol, t, [] if like is None else like.stretches)
    one_by_one = _OneByOne(controller, plant, phase, guards, rtol, atol)
    bridge = until - t if collocation is None else BRIDGE
    pieces, stretches = list[Piece](), list[Stretch]()
    here = Ended(t, state, TIMED_OUT)
    values = guards.values(*state)
    while here.t < until:
        stretch = None if collocation is None else collocation.advance(here.t, *here.state, until)
        ended: Ended | None
        if stretch is not None:
            bridge = BRIDGE
            pieces.append(Piece(stretch.end, stretch.at))
            stretches.append(stretch)
            ended, values = _first_event(stretch, guards, values)
            here = ended or Ended(stretch.end, State(stretch.q[-1], stretch.dq[-1]), TIMED_OUT)
        else:
            piece, ended = one_by_one.advance(here, min(here.t + bridge, until))
            pieces.append(piece)
            bridge *= 2.0
            here = ended or Ended(piece.end, _halves(piece.at(np.array([piece.end]))[0]), TIMED_OUT)
            values = guards.values(*here.state)
        if ended is not None:
            break
    return PhaseFlow(pieces, stretches, state, here)


def _collocation(
    controller: Controller,
    plant: FrontalBiped,
    phase: StepPhase,
    rtol: float,
    atol: float,
    start: float,
    like: list[Stretch],
) -> Collocation | None:
    """The method for many states at once; None where the controller answers one at a time."""
    many = many_at_once(controller)
    if many is None:
        return None

    def acceleration(q: FloatArray, dq: FloatArray) -> FloatArray | None:
        commands = many.commands(phase, q, dq)
        return None if commands is None else plant.many.forward_dynamics(q, dq, commands.u)

    return Collocation(acceleration, rtol, atol, start, like)


def _first_event(stretch: Stretch, guards: Guards, before: tuple[float, ...]) -> tuple[Ended | None, tuple[float, ...]]:
    """The first event on a stretch, if any; and the guards' values at its end."""
    left = stretch.start
    for i in range(LOOKS, len(stretch.q), LOOKS):
        q, dq, right = stretch.q[i], stretch.dq[i], stretch.times.item(i)
        values = guards.values(q, dq)
        if min(values) <= 0.0:
            crossed = [
                (_located(stretch, guard, left, right), guard.kind)
                for guard, a, b in zip(guards, before, values, strict=True)
                if a >= 0.0 >= b
            ]
            if crossed:
                t, kind = min(crossed, key=lambda item: item[0])
                return Ended(t, _halves(stretch.at_one(t)), kind), values
        left, before = right, values
    return None, before


def _located(stretch: Stretch, guard: Guard, left: float, right: float) -> float:
    def value(t: float) -> float:
        return guard.function(*_halves(stretch.at_one(t)))

    return float(brentq(value, left, right, xtol=ROUNDING, rtol=ROUNDING))


def _halves(x: FloatArray) -> State:
    n = len(x) // 2
    return State(x[:n], x[n:])


class _OneByOne:
    """DOP853, the controller inside the right-hand side; it has patience for one phase."""

    def __init__(
        self,
        controller: Controller,
        plant: FrontalBiped,
        phase: StepPhase,
        guards: Guards,
        rtol: float,
        atol: float,
    ) -> None:
        self._controller, self._plant, self._phase, self._guards = controller, plant, phase, guards
        self._rtol, self._atol = rtol, atol
        self._asked, self._given_up = 0, np.inf
        self._events = [*(_as_event(guard) for guard in guards), self._patience()]

    def _derivative(self, t: float, x: FloatArray) -> FloatArray:
        self._asked += 1
        if self._asked > MOST_EVALUATIONS:
            self._given_up = min(self._given_up, t)
        q, dq = _halves(x)
        u = self._controller.command(self._phase, q, dq).u
        return np.concatenate([dq, self._plant.forward_dynamics(q, dq, u)])

    def _patience(self) -> Callable[[float, FloatArray], float]:
        def patience(t: float, _: FloatArray) -> float:
            return self._given_up - t

        patience.terminal = True  # type: ignore[attr-defined]
        return patience

    def advance(self, begun: Ended, until: float) -> tuple[Piece, Ended | None]:
        """From where the phase has come to up to ``until`` [s]; how the phase ended, if it did."""
        solution = solve_ivp(
            self._derivative,
            (begun.t, until),
            np.concatenate(begun.state),
            method="DOP853",
            rtol=self._rtol,
            atol=self._atol,
            events=self._events,
            dense_output=True,
        )
        assert solution.sol is not None  # dense_output=True
        assert solution.t_events is not None  # there are events
        dense, end = solution.sol, float(solution.t[-1])
        piece = Piece(end, lambda times: np.asarray(dense(times).T))
        if solution.status == 0:
            return piece, None
        why: EventKind | str = TIMED_OUT
        if solution.status == 1:
            *found, gave_up = solution.t_events
            hits = zip(self._guards, found, strict=True)
            why = TOO_STIFF if len(gave_up) else next(guard.kind for guard, times in hits if len(times))
        return piece, Ended(end, _halves(solution.y[:, -1]), why)


def _as_event(guard: Guard) -> Callable[[float, FloatArray], float]:
    def event(_: float, x: FloatArray) -> float:
        return guard.function(*_halves(x))

    event.terminal = True  # type: ignore[attr-defined]
    event.direction = -1  # type: ignore[attr-defined]
    return event
