"""Motion of the robot on one foot while its torques are held."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from scipy.optimize import brentq

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.hybrid_system import EventKind, Guards
from frontal_biped.simulation.pushes import PelvisForce, PushForces, along_h


class Reaction(NamedTuple):
    """What the ground does to the stance foot.

    Attributes:
        F_h: [N].
        F_v: [N].
        p_fri: where it acts, from the ankle [m]; nan where it carries nothing.
    """

    F_h: float
    F_v: float
    p_fri: float

    @property
    def friction_used(self) -> float:
        """Coefficient of friction |F_h| / F_v that keeps the foot at rest; inf if the ground would pull."""
        return abs(self.F_h) / self.F_v if self.F_v > 0.0 else float("inf")


class Reactions(NamedTuple):
    """What the ground does to the stance foot at many states.

    Attributes:
        force: (m, 2) F_h, F_v [N].
        p_fri: (m,) where it acts, from the ankle [m]; nan where it carries nothing.
    """

    force: FloatArray
    p_fri: FloatArray


class RungeKutta(NamedTuple):
    """The classical Runge-Kutta step of order 4, in the form that it takes for second order.

    Every matrix makes a configuration and velocities, (2, n), of the rows q, dq, a_1, a_2, .. known before it.

    Attributes:
        second: (2, 3) where the acceleration a_2 is taken.
        third: (2, 4) where a_3 is.
        fourth: (2, 5) where a_4 is.
        end: (2, 6) where the step ends.
    """

    second: FloatArray
    third: FloatArray
    fourth: FloatArray
    end: FloatArray

    @classmethod
    @lru_cache(maxsize=64)  # a run has few lengths of a step, but for those by which its events are located
    def of(cls, h: float) -> "RungeKutta":
        """The step over h [s]."""
        half, third, sixth = h / 2.0, h / 3.0, h / 6.0
        return cls(
            np.array([[1.0, half, 0.0], [0.0, 1.0, half]]),
            np.array([[1.0, half, half * half, 0.0], [0.0, 1.0, 0.0, half]]),
            np.array([[1.0, h, 0.0, h * half, 0.0], [0.0, 1.0, 0.0, 0.0, h]]),
            np.array([[1.0, h, h * sixth, h * sixth, h * sixth, 0.0], [0.0, 1.0, sixth, third, third, sixth]]),
        )


class StanceMotion:
    """The robot on one foot under held torques and pushes.

    Args:
        biped: the robot that moves.
        stance: the foot it stands on.

    Attributes:
        u: (4,) torques of the motors [N m].
        pushes: force along h [N] and height above the hip line [m] of each push.
    """

    def __init__(self, biped: FrontalBiped, stance: Stance) -> None:
        self.biped, self.stance = biped, stance
        self.u: FloatArray = np.zeros(len(biped.max_torque))
        self.pushes: list[tuple[float, float]] = []
        self._pelvis = PelvisForce(biped)
        self._model, self._data = biped.pinned, biped.pinned.createData()
        joints = len(self.u)
        self._known, self._stage = np.zeros((6, joints)), np.zeros((2, joints))  # of a step: see `RungeKutta`
        self._first, self._two, self._three = (self._known[:count] for count in (3, 4, 5))
        self._at, self._rates = self._stage
        # and of the ground reaction: the foot at rest on its planar joint, then the joints
        self._standing, foot = biped.planar_base, biped.planar_base.nv - joints
        self._standing_data, self._pose = self._standing.createData(), pin.neutral(self._standing)
        self._motion = np.zeros((2, foot + joints))
        self._joints, self._changes = self._pose[-joints:], self._motion[:, foot:]

    def copy(self) -> "StanceMotion":
        """The same motion under torques of its own."""
        twin = StanceMotion(self.biped, self.stance)
        twin.u, twin.pushes = self.u, self.pushes
        return twin

    def feel(self, pushes: PushForces, t: float) -> None:
        """Take what acts at time t [s]."""
        self.pushes = [(along_h(force, self.stance), height) for force, height in pushes.at(t)]

    def felt(self, q: FloatArray) -> FloatArray:
        """(4,) generalized forces of motors and pushes at q (4,) [N m]."""
        u = self.u
        for force, height in self.pushes:
            u = u + self._pelvis.torques(q, force, height)
        return u

    def acceleration(self, state: State) -> FloatArray:
        """(4,) ddq [rad/s^2] at a state."""
        q, dq = state
        return pin.aba(self._model, self._data, q, dq, self.felt(q))

    def reaction(self, state: State, ddq: FloatArray | None = None) -> Reaction:
        """Ground reaction, which carries what the pushes do not; ``ddq`` is `acceleration` there, where it is known."""
        q, dq = state
        self._joints[:], self._changes[0], self._changes[1] = q, dq, self.acceleration(state) if ddq is None else ddq
        F_h, F_v, N_0 = pin.rnea(self._standing, self._standing_data, self._pose, *self._motion)[:BASE].tolist()
        for force, height in self.pushes:
            F_h -= force
            N_0 += force * self._pelvis.height(q, height)
        return Reaction(F_h, F_v, N_0 / F_v if F_v else float("nan"))

    def reactions(self, states: State, u: FloatArray) -> Reactions:
        """Ground reactions at q, dq (m, 4) under torques u (m, 4) [N m] and no push."""
        ddq = self.biped.many.forward_dynamics(*states, u)
        forces = self.biped.many.inverse_dynamics(*states, ddq)
        with np.errstate(divide="ignore", invalid="ignore"):
            return Reactions(forces[:, :2], forces[:, 2] / forces[:, 1])

    def advance(self, state: State, h: float, ddq: FloatArray | None = None) -> State:
        """State after h [s], by a Runge-Kutta step of order 4; ``ddq`` as for `reaction`."""
        # three of five microseconds of a step are Pinocchio's: it is asked without a call in between
        aba, model, data, felt, pushed = pin.aba, self._model, self._data, self.felt, bool(self.pushes)
        second, third, fourth, end = RungeKutta.of(h)
        known, stage, at, rates, u = self._known, self._stage, self._at, self._rates, self.u
        q, dq = state
        known[0], known[1] = q, dq
        known[2] = aba(model, data, q, dq, felt(q) if pushed else u) if ddq is None else ddq
        second.dot(self._first, stage)
        known[3] = aba(model, data, at, rates, felt(at) if pushed else u)
        third.dot(self._two, stage)
        known[4] = aba(model, data, at, rates, felt(at) if pushed else u)
        fourth.dot(self._three, stage)
        known[5] = aba(model, data, at, rates, felt(at) if pushed else u)
        after = end.dot(known)
        return State(after[0], after[1])

    def first_crossing(
        self,
        state: State,
        h: float,
        guards: Guards,
        before: tuple[float, ...],
        after: tuple[float, ...],
    ) -> tuple[float, EventKind] | None:
        """Time into the step and kind of the earliest event in it."""
        found = []
        for place, kind in enumerate(guards.kinds):
            if before[place] > 0.0 >= after[place]:

                def value(tau: float, place: int = place) -> float:
                    return guards.values(*self.advance(state, tau))[place]

                found.append((float(brentq(value, 0.0, h, xtol=1e-14)), kind))
        return min(found, key=lambda item: item[0]) if found else None
