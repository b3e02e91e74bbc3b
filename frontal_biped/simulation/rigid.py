"""The hybrid system as an engine: rigid impacts, located events, one foot on the ground ([O] eq. hybridsystem)."""

from copy import copy

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Reading
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import UPRIGHT
from frontal_biped.model.perturbation import ModelErrors, Plant
from frontal_biped.model.stance_map import Stance, relabel
from frontal_biped.model.state import State
from frontal_biped.simulation.engine import AT_ONCE, Move, first_foothold
from frontal_biped.simulation.guard_watch import GuardWatch, reaches
from frontal_biped.simulation.hybrid_system import EventKind, Guards, land, walking_guards
from frontal_biped.simulation.pushes import PushForces
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.stance_motion import Reaction, StanceMotion
from frontal_biped.virtual_constraints.phase import StepPhase

MAX_STEP = 1e-3
"""Longest Runge-Kutta step under held torques [s]: at order 4 it is exact to rounding."""

BEYOND_SOLE = 1e-3
"""Share of the way from ankle to end of the sole that a FRI may be beyond that end before the foot rolls.

A controller keeps the FRI inside at its ticks; torques that are held between them let it pass by 1e-6 of that way."""

MOST_TURNS = 20
"""Times a push may turn the robot outwards again within one step."""


class RigidEngine:
    """The robot on its stance foot, and the events that change phase and foot.

    Args:
        biped: the robot of the files.
        errors: how the one that walks differs from it.
        settings: friction and the rotation up to which a foot settles flat.

    Attributes:
        plant: the robot that walks.
        stance: the foot it stands on.
        motion: how it moves on that foot.
        state: where it is.
        phase: rising or falling.
    """

    name = "ours"

    def __init__(self, biped: FrontalBiped, errors: ModelErrors | None, settings: SimulationSettings) -> None:
        self.biped, self.settings = biped, settings
        self.plant = Plant.of(biped, errors)
        self._motion = {side: StanceMotion(self.plant.on(side), side) for side in Stance}
        self._reach = {side: reaches(self.plant.on(side).chain) for side in Stance}
        self._ground = dict.fromkeys(Stance, 0.0)
        self._next_ground = dict.fromkeys(Stance, 0.0)
        self._friction = settings.disturbances.friction or float("inf")
        self._may_roll = settings.disturbances.rolls
        self._holds = settings.disturbances.friction is None and not self._may_roll
        outer, inner = biped.sole
        self._sole = (1.0 + BEYOND_SOLE) * outer, (1.0 + BEYOND_SOLE) * inner  # how far the FRI may come [m]

    def place(self, stance: Stance, state: State) -> None:
        """Stand on a foot right after an impact; the feet are level about y = 0, as in a walk on the spot."""
        self.stance, self.motion, self.phase = stance, self._motion[stance], StepPhase.RISING
        self.state = State(state.q.copy(), state.dq.copy())
        self._foot_y = {stance: first_foothold(self.plant.on(stance), stance, state.q)}
        self._turns = 0
        self._guard()

    def copy(self) -> "RigidEngine":
        """The robot where it is, to move on by itself; states and torques are values, and shared."""
        twin = copy(self)
        twin._motion = {side: motion.copy() for side, motion in self._motion.items()}
        twin.motion = twin._motion[self.stance]
        twin._ground, twin._next_ground = {**self._ground}, {**self._next_ground}
        twin._watch = copy(self._watch)
        return twin

    @property
    def guards(self) -> Guards:
        """Whose crossing ends the present phase."""
        return self._guards

    # ------------------------------------------------------------------ what can be known
    def read(self, t: float) -> Reading:
        """True values of everything a sensor measures."""
        coordinates, stance, (q, dq) = self.biped.stance_map, self.stance, self.state
        outwards, left_stands = -stance.sign, stance.sign > 0.0
        return Reading(
            t,
            coordinates.positions_to_urdf(q, stance),
            coordinates.velocities_to_urdf(dq, stance),
            outwards * (q.item(0) + q.item(1) - 2.0 * UPRIGHT),  # the pelvis' roll, without an array of it
            outwards * (dq.item(0) + dq.item(1)),
            (left_stands, not left_stands),
        )

    def stance_state(self, stance: Stance) -> State:
        """The state for a foot taken as the stance foot."""
        state = self.state if stance is self.stance else self.state.relabelled()
        return State(state.q.copy(), state.dq.copy())

    def reaction(self, stance: Stance) -> Reaction:
        """Ground reaction on a foot."""
        return self.motion.reaction(self.state) if stance is self.stance else Reaction(0.0, 0.0, float("nan"))

    def foot_position(self, stance: Stance) -> tuple[float, float]:
        """y of a foot's ankle [m] and the foot's rotation about +X [rad]."""
        if stance is self.stance:
            return self._foot_y[stance], 0.0
        sign = self.stance.sign
        return self._foot_y[self.stance] - sign * self._width(), -sign * float(
            self.biped.swing_foot_rotation(self.state.q)
        )

    def _width(self) -> float:
        return float(self.plant.on(self.stance).joint_positions(self.state.q)[-1, 0])

    # ------------------------------------------------------------------ motion
    def raise_ground(self, stance: Stance, height: float) -> None:
        """Height of the ground on which a foot in the air will land [m]."""
        self._next_ground[stance] = height
        self._guard()

    def _guard(self) -> None:
        here, swing = self._ground[self.stance], self.stance.other
        guards = walking_guards(self.plant.on(self.stance), self._ground[swing] - here, self._next_ground[swing] - here)
        self._guards = guards.rising if self.phase is StepPhase.RISING else guards.falling
        self._watch = GuardWatch(self._guards, self._reach[self.stance], self.state)

    def advance(self, t: float, end: float, tau: FloatArray, pushes: PushForces) -> Move:
        """Under held joint torques (4,) [N m] from t to ``end`` [s], or to the first event."""
        motion, pushed, watch = self.motion, pushes.any, self._watch
        motion.u = self.biped.stance_map.torques_to_stance(tau, self.stance)
        steps: list[tuple[float, float, State]] = []
        while end - t > AT_ONCE:
            if pushed:
                motion.feel(pushes, t)
            ddq = None
            if not self._holds:
                ddq = motion.acceleration(self.state)
                gave_way = self._gives_way(motion.reaction(self.state, ddq))
                if gave_way is not None:
                    return Move(t, steps, gave_way, gave_way)
            h = min(end - t, MAX_STEP)
            after = motion.advance(self.state, h, ddq)
            values = watch.look(after)
            if values is not None:
                guards = self._guards
                hit = motion.first_crossing(self.state, h, guards, guards.values(*self.state), values)
                if hit is not None:
                    h, kind = hit
                    t += h
                    self.state = motion.advance(self.state, h)
                    steps.append((h, t, self.state))
                    return Move(t, steps, kind, self.cross(kind))
            t = end if h == end - t else t + h
            self.state = after
            steps.append((h, t, after))
        return Move(t, steps)

    def _gives_way(self, reaction: Reaction) -> EventKind | None:
        """How the ground fails to hold the stance foot, where the settings say that it can."""
        if reaction.friction_used > self._friction:
            return EventKind.SLIPPED
        return EventKind.ROLLED if self._rolls(reaction.F_v, reaction.p_fri) else None

    def _rolls(self, upwards: float, place: float) -> bool:
        """Does a foot roll over its edge? By what the ground does: upwards [N, N s], and where along h [m]."""
        outer, inner = self._sole
        return self._may_roll and not (upwards > 0.0 and outer <= place <= inner)

    def cross(self, kind: EventKind) -> EventKind | None:
        """Pass an event at the present state; how the robot fell, if it did."""
        if kind is EventKind.REVERSAL:
            self.phase = StepPhase.FALLING
            self._guard()
            lands_on = self._next_ground[self.stance.other] - self._ground[self.stance]
            below = self.plant.on(self.stance).swing_clearance(self.state.q) < lands_on
            return EventKind.EARLY_LANDING if below else None
        if kind is EventKind.TURNED_OUTWARDS and self._turns < MOST_TURNS:
            self.phase, self._turns = StepPhase.RISING, self._turns + 1
            self._guard()
            return None
        return self._land() if kind is EventKind.IMPACT else kind

    def _land(self) -> EventKind | None:
        swing = self.stance.other
        landing = land(self.plant.on(self.stance), *self.state, self.settings.flat_landing)
        if landing is None:
            return EventKind.EDGE_LANDING
        if landing.friction_used > self._friction:
            return EventKind.SLIPPED
        if self._rolls(float(landing.impulse[1]), -landing.center_of_pressure):  # the new h points the other way
            return EventKind.ROLLED
        self._foot_y = {swing: self.foot_position(swing)[0]}
        self._motion[swing].u = relabel(self.motion.u)  # joint torques persist through the impact
        self.state = landing.state
        self._ground[swing] = self._next_ground[swing]
        self.stance, self.motion, self.phase, self._turns = swing, self._motion[swing], StepPhase.RISING, 0
        self._guard()
        return None
