r"""The hybrid system with double support: one foot on the ground, or both, and what changes between them.

*On one foot* the robot moves as in `RigidEngine`, torques held (`StanceMotion`).

*Landing.* A swing foot that meets the ground stays, and so does the other one: a plastic impact of both. What is left
is the motion along the double-support family that has the same momentum,

.. math:: \dot\beta^+ = q' \cdot D \dot q^- / (q' \cdot D q'),

and the impulses follow from the momentum that is lost. Feet that arrive at rest lose none. The one that stood before
may not be torn off the ground: its impulse must be one that its load makes up for within `AT_ONCE`. Both feet then stay
until the torques change, for those that are still held were meant for a foot in the air.

*On both feet* beta is the one freedom; torques decide its acceleration and the wrenches of both feet
(`SupportPoint.under`). A foot that the ground would have to pull leaves it. One whose centre of pressure leaves the
sole, or that would slip under a coefficient of friction that the engine is given, is a fall.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Reading
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance, relabel
from frontal_biped.model.state import State
from frontal_biped.simulation.hybrid_system import FLAT_LANDING, LEAVING, LOWEST, EventKind
from frontal_biped.simulation.rigid import BEYOND_SOLE, MAX_STEP
from frontal_biped.simulation.stance_motion import Reaction, StanceMotion
from frontal_biped.virtual_constraints.double_support import DoubleSupportFamily
from frontal_biped.zero_dynamics.restricted import F_H, F_V, N_0, TORQUES
from frontal_biped.zero_dynamics.support_dynamics import SupportPoint

AT_ONCE = 0.02
"""Time within which the load of a foot makes up for an impulse that pulls at it [s]."""

HELD = 1e-3
"""Share of the weight that the ground may seem to pull at a foot that is to stay: torques are held for a period."""

LOADED = 0.02
"""Share of the weight from which on it matters where a foot is pressed."""

LIFTED = 1e-6
"""Clearance after which a foot has left the ground [m]."""

TORN = "a landing tore the other foot off the ground"


class Touchdown(NamedTuple):
    """A landing on both feet.

    Attributes:
        t: when [s].
        speed: fastest descent of an end of the sole just before [m/s].
        impulse: vertical, on the foot that lands [N s].
        pulled: vertical impulse that pulls at the other one [N s], 0 where it is pushed.
        dbeta: after it, in the coordinates of the foot that lands [rad/s].
    """

    t: float
    speed: float
    impulse: float
    pulled: float
    dbeta: float


class SupportEngine:
    """The robot on one foot or on both, and the events between them.

    Args:
        biped: the robot.
        period: control period [s].
        friction: coefficient of the ground; None: no foot slips.

    Attributes:
        stance: the foot that the coordinates begin at.
        double: is the robot on both feet?
        state: where it is.
        touchdowns: landings so far.
        lift_offs: times of the lift-offs so far [s].
    """

    name = "ours"

    def __init__(self, biped: FrontalBiped, period: float = 1e-3, friction: float | None = None) -> None:
        self.biped, self.period, self.friction = biped, period, friction
        self._motion = {side: StanceMotion(biped, side) for side in Stance}
        self._lowest = LOWEST * float(biped.com(np.full(4, -0.5 * np.pi))[1])
        self.touchdowns: list[Touchdown] = []
        self.lift_offs: list[float] = []
        self._u = np.zeros(4)

    # ------------------------------------------------------------------ where it is
    def stand(self, stance: Stance, family: DoubleSupportFamily, beta: float) -> None:
        """Stand at rest on both feet."""
        self.stance, self.double = stance, True
        self.family = family
        self.state = State(family.at(beta).q, np.zeros(4))
        self._foot_y = {stance: 0.5 * stance.sign * family.width, stance.other: -0.5 * stance.sign * family.width}

    def lift(self, stance: Stance, state: State) -> None:
        """Stand on one foot, the other one just leaving the ground."""
        self.stance, self.double, self._off = stance, False, False
        self.state = State(state.q.copy(), state.dq.copy())
        width = float(self.biped.joint_positions(state.q)[-1, 0])
        self._foot_y = {stance: 0.5 * stance.sign * width, stance.other: -0.5 * stance.sign * width}

    def read(self, t: float) -> Reading:
        """True values of everything a sensor measures."""
        coordinates, stance, (q, dq) = self.biped.stance_map, self.stance, self.state
        return Reading(
            t,
            coordinates.positions_to_urdf(q, stance),
            coordinates.velocities_to_urdf(dq, stance),
            -stance.sign * float(self.biped.pelvis_roll(q)),
            -stance.sign * float(dq[0] + dq[1]),
            (self.double or stance is Stance.LEFT, self.double or stance is Stance.RIGHT),
        )

    def stance_state(self, stance: Stance) -> State:
        """The state for a foot taken as the stance foot."""
        state = self.state if stance is self.stance else self.state.relabelled()
        return State(state.q.copy(), state.dq.copy())

    def foot_y(self, stance: Stance) -> float:
        """y of a foot's ankle [m]."""
        if self.double or stance is self.stance:
            return self._foot_y[stance]
        return self._foot_y[self.stance] - self.stance.sign * float(self.biped.joint_positions(self.state.q)[-1, 0])

    def reactions(self) -> dict[Stance, Reaction]:
        """What the ground does to either foot, along the h axis of that foot."""
        stance = self.stance
        if not self.double:
            return {stance: self._motion[stance].reaction(self.state), stance.other: Reaction(0.0, 0.0, float("nan"))}
        forces = SupportPoint.of(self.family, self.state.beta).under(self._u, self.state.dbeta**2)[1]
        return {stance: _reaction(forces.stance, 1.0), stance.other: _reaction(forces.swing, -1.0)}

    # ------------------------------------------------------------------ motion
    def advance(self, t: float, end: float, tau: FloatArray) -> EventKind | str | None:
        """Under held joint torques (4,) [N m] from t to ``end`` [s]; how the robot fell, if it did."""
        self._u = self.biped.stance_map.torques_to_stance(tau, self.stance)
        stays = False
        fell: EventKind | str | None
        while end - t > 1e-12:
            h = min(end - t, MAX_STEP)
            if self.double and not stays:
                fell = self._release(t)
                if fell is not None:
                    return fell
            if self.double:
                self._along_family(h)
                t += h
                continue
            used, fell = self._on_one_foot(t, h)
            stays = self.double
            t += used
            if fell is not None:
                return fell
        return EventKind.COLLAPSED if float(self.biped.com(self.state.q)[1]) < self._lowest else None

    def _release(self, t: float) -> EventKind | None:
        """Does a foot leave the ground, or does the ground fail to hold one?"""
        point = SupportPoint.of(self.family, self.state.beta)
        forces = point.under(self._u, self.state.dbeta**2)[1]
        weight = self.biped.weight
        outer, inner = self.biped.sole
        for wrench, low, high in ((forces.stance, outer, inner), (forces.swing, -inner, -outer)):
            F_v = float(wrench[F_V])
            if (
                F_v > LOADED * weight
                and not (low - BEYOND_SOLE * (high - low)) * F_v
                <= wrench[N_0]
                <= (high + BEYOND_SOLE * (high - low)) * F_v
            ):
                return EventKind.ROLLED
            if self.friction is not None and F_v > LOADED * weight and abs(float(wrench[F_H])) > self.friction * F_v:
                return EventKind.SLIPPED
        if float(forces.swing[F_V]) < -HELD * weight:
            self._leave(t)
        elif float(forces.stance[F_V]) < -HELD * weight:
            self.stance, self.state, self._u = self.stance.other, self.state.relabelled(), relabel(self._u)
            self._leave(t)
        return None

    def _leave(self, t: float) -> None:
        self.double, self._off = False, False
        self.lift_offs.append(t)

    def _along_family(self, h: float) -> None:
        """A Runge-Kutta step of order 4 of the one freedom."""

        def slope(x: FloatArray) -> FloatArray:
            beta, speed = x.tolist()
            return np.array([speed, SupportPoint.of(self.family, beta).under(self._u, speed**2)[0]])

        x = np.array([self.state.beta, self.state.dbeta])
        k_1 = slope(x)
        k_2 = slope(x + 0.5 * h * k_1)
        k_3 = slope(x + 0.5 * h * k_2)
        k_4 = slope(x + h * k_3)
        beta, speed = (x + (h / 6.0) * (k_1 + 2.0 * (k_2 + k_3) + k_4)).tolist()
        at = self.family.at(beta)
        self.state = State(at.q, at.dq * speed)

    def _on_one_foot(self, t: float, h: float) -> tuple[float, EventKind | str | None]:
        """A step on one foot, to its end or to a landing: the time that passed, and how the robot fell."""
        motion, biped = self._motion[self.stance], self.biped
        motion.u = self._u
        after = motion.advance(self.state, h)
        clearance = biped.swing_clearance(after.q)
        if not self._off:
            self._off = clearance > LIFTED
            self.state = after
            return h, EventKind.EARLY_LANDING if clearance < -LEAVING else None
        if clearance > 0.0:
            self.state = after
            outer = biped.sole[0]
            tipped = float(biped.com(after.q)[0]) < outer
            return h, EventKind.TIPPED_OUTWARDS if tipped else None

        def height(used: float) -> float:
            return biped.swing_clearance(motion.advance(self.state, used).q)

        used = float(brentq(height, 0.0, h, xtol=1e-12)) if height(0.0) > 0.0 else 0.0
        self.state = motion.advance(self.state, used)
        return used, self._land(t + used)

    def _land(self, t: float) -> EventKind | str | None:
        biped, (q, dq) = self.biped, self.state
        if abs(float(biped.swing_foot_rotation(q))) > FLAT_LANDING:
            return EventKind.EDGE_LANDING
        width = float(biped.joint_positions(q)[-1, 0])
        family = DoubleSupportFamily(biped, width)
        point = SupportPoint.of(family, float(q[0]))
        slope = point.at.dq
        momentum = biped.D(point.at.q) @ slope
        dbeta = float(momentum @ dq / (momentum @ slope))
        change = biped.momentum_map(point.at.q) @ (dbeta * slope - dq)
        # joints get no impulse: J' L_2 is the change of the joints' momenta
        landing = np.linalg.lstsq(point.J.T, change[TORQUES], rcond=None)[0]
        pulled = max(0.0, float(landing[F_V] - change[F_V]))
        descent = float(-(biped.swing_sole_jacobian(q)[:, 1] @ dq).min())
        if pulled > AT_ONCE * biped.weight:
            return TORN
        new = State(point.at.q, dbeta * slope).relabelled()
        swing = self.stance.other
        self._foot_y[swing] = self._foot_y[self.stance] - self.stance.sign * width
        self._u = relabel(self._u)
        self.stance, self.state, self.double, self.family = swing, new, True, family
        self.touchdowns.append(Touchdown(t, descent, float(landing[F_V]), pulled, new.dbeta))
        return None


def _reaction(wrench: FloatArray, sign: float) -> Reaction:
    F_h, F_v, moment = wrench.tolist()
    return Reaction(sign * F_h, F_v, sign * moment / F_v if F_v > 0.0 else float("nan"))
