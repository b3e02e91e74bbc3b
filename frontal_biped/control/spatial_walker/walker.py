"""The walking controller of the whole robot: sensor readings in, torques of every joint out, no simulator in sight.

At every reading: estimate the state (`SpatialEstimator`), decide whether the swing foot has landed (`PhaseMachine`),
predict the state at the time when the torques will act, see the frontal plane in it (`SpaceState.frontal`) and ask
`FrontalLaw` for its outputs and FRI, `SagittalLaw` for the centre of pressure and the next foothold, `LegLengths` for
the legs' lengths; the whole-body program finds the torques that give all of it.

A `StepPlanner` says at every landing how far the next step goes, forwards, sideways and about the vertical. A step that
turns is walked in a heading frame of its own, half-way between where both feet look: pelvis and swing foot are led
there in yaw, and at a landing the frame turns on. In it the middle between the feet is not beside the stance ankle but
w/2 sin(turn/2) ahead or behind, and so are the centre of mass and its reference.
"""

from collections import deque

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.frontal_law import TURNED, FrontalLaw, FrontalSettings
from frontal_biped.control.interface import PhaseEvent
from frontal_biped.control.path.pose import Pose
from frontal_biped.control.spatial_walker.estimator import SpatialEstimator, SpatialEstimatorSettings
from frontal_biped.control.spatial_walker.interface import SpatialCommand, SpatialReading
from frontal_biped.control.spatial_walker.leg_lengths import LegLengths, LengthSettings
from frontal_biped.control.spatial_walker.sagittal import SagittalLaw, SagittalSettings
from frontal_biped.control.spatial_walker.step_plan import CommandedSpeeds, StepPlan, StepPlanner
from frontal_biped.control.spatial_walker.swing_path import MinimumJerk, SwingPath
from frontal_biped.control.walker.phase_machine import PhaseMachine, PhaseSettings
from frontal_biped.control.whole_body.program import WholeBodyProgram
from frontal_biped.control.whole_body.settings import WholeBodySettings
from frontal_biped.control.whole_body.targets import LegLength, WholeBodyTargets, Yaw
from frontal_biped.exceptions import SimulationError
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.impact import impact
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import LENGTH, YAW, SpaceState, X, Y
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.model.sway import Sway
from frontal_biped.virtual_constraints.phase import StepPhase

SOFT = (0.009, 0.039, 0.15)
"""After a landing the contact rings: feedback is at the last of these shares until the first of these times [s], and
grows to all of it until the second."""

TURNED_BY = 0.85
"""Share of a step after which the swing foot looks where it is to land: it must not turn on the ground [-]."""

MOST_TURNED = 0.35
"""Largest turn of a step [rad]."""

LIFTED = 0.02
"""Time without a touch after which a foot has left the ground [s]: it leaves slowly, and rings on soft ground."""


class SpatialWalker:
    """Walks a planar gait in space, from sensor readings alone.

    Args:
        free: the robot as the walker believes it to be.
        biped: the same robot in its frontal plane.
        gait: what to walk in the frontal plane.
        period: time between readings [s].
        speed: commanded mean speed forwards [m/s].
        delay: known time from a reading to the torques it leads to [s], a multiple of the period.
        settings: gains and limits of the whole-body program.
        frontal: how the frontal plane is kept.
        sagittal: how the sagittal plane is kept.
        lengths: how the legs are drawn up and put down.
        phases: when to believe in a landing or a reversal.
        estimator: what to trust of the readings.
        planner: decides on the steps; None: at commanded speeds.

    Attributes:
        program: the whole-body program, which counts how ticks were answered.
        estimator: what the readings are taken for.
        phases: when a landing or a reversal is believed.
        frontal: outputs and FRI.
        sagittal: centre of pressure and foothold.
        swing: path of the swing sole forwards.
        lengths: of both legs.
        left: time to the landing [s].
        stance: the foot taken for the stance foot.
        planner: decides on the steps.
        plan: of the present step.
        landings: so far.

    Raises:
        SimulationError: the delay is no multiple of the period, or the centre of mass turns back along a phase of the
            gait.
        RobotError: a leg has not six joints.
    """

    def __init__(
        self,
        free: FreeRobot,
        biped: FrontalBiped,
        gait: Gait,
        *,
        period: float = 1e-3,
        speed: float = 0.0,
        delay: float = 0.0,
        settings: WholeBodySettings | None = None,
        frontal: FrontalSettings | None = None,
        sagittal: SagittalSettings | None = None,
        lengths: LengthSettings | None = None,
        phases: PhaseSettings | None = None,
        estimator: SpatialEstimatorSettings | None = None,
        planner: StepPlanner | None = None,
    ) -> None:
        self.free, self.biped, self.gait, self.period, self.delay = free, biped, gait, period, delay
        self._on_the_way = round(delay / period)
        if self._on_the_way < 0 or abs(self._on_the_way * period - delay) > 1e-6 * period:
            raise SimulationError(f"a delay of {delay:g} s is no multiple of the period of {period:g} s; make it one")
        self.settings = settings or WholeBodySettings()
        self.program = WholeBodyProgram(free, self.settings)
        self.state = SpaceState(free)
        self.estimator = SpatialEstimator(free, period, estimator)
        self.phases = PhaseMachine(period, phases or PhaseSettings(rate=TURNED, lifted=LIFTED))
        self.frontal = FrontalLaw(biped, gait, period, self.settings.output, frontal or FrontalSettings())
        duration = self.frontal.orbit.duration
        self.sagittal = SagittalLaw.of(self.state, duration, sagittal or SagittalSettings())
        self.swing = SwingPath()
        self.lengths = LegLengths(self.state, duration, lengths or LengthSettings())
        self._pelvis_yaw, self._swing_yaw = MinimumJerk(), MinimumJerk()
        # of the divergent component sideways, outwards of the foot that lands [m]
        orbit = self.frontal.orbit
        end = orbit.ends(StepPhase.FALLING)
        speed_down = np.sqrt(2.0 * orbit.energy(StepPhase.FALLING, end))
        self._xi_outwards = float(speed_down / orbit.omega - (self.frontal.widths.width - end))
        self._posture = free.posture[BASE + 1 :].copy()
        self._still = np.zeros(free.model.nv)
        self._speeds = CommandedSpeeds(duration, self.sagittal.settings.speed_change)
        self._speeds.asked = speed
        self.planner: StepPlanner = planner or self._speeds
        self.reset(Stance.LEFT, free.posture, self._still)

    def command(self, speed: float | None = None, lateral: float | None = None, turn: float | None = None) -> None:
        """Walk like this from the next step on; what is None stays as it is.

        Args:
            speed: forwards [m/s].
            lateral: to the left [m/s].
            turn: to the left [rad/s].

        Raises:
            SimulationError: steps so wide, narrow or turned are not known.
        """
        duration, widths = self.frontal.orbit.duration, self.frontal.widths
        speeds = self._speeds
        if lateral is not None:
            aside = abs(lateral) * duration
            if widths.within(aside) != aside or widths.within(-aside) != -aside:
                most = min(widths.widest, -widths.narrowest) / duration
                raise SimulationError(f"lateral = {lateral:g}: the legs do not reach as far; at most {most:.3g} m/s")
            speeds.lateral = lateral
        if turn is not None:
            if abs(turn) * duration > MOST_TURNED:
                raise SimulationError(
                    f"turn = {turn:g}: too much for a step; at most {MOST_TURNED / duration:.3g} rad/s"
                )
            speeds.turning = turn
        if speed is not None:
            speeds.asked = speed

    def reset(self, stance: Stance, q: FloatArray, v: FloatArray) -> None:
        """Start right after an impact, standing on ``stance`` at q (nq,), v (nv,)."""
        self.stance = stance
        self.phases.reset()
        self.frontal.reset(stance)
        self.estimator.reset(stance, q, v)
        self.program.reset()
        self.landings = 0
        self.left = self.frontal.orbit.duration
        foot = self.state.at(q, v).feet[stance]
        yaw = float(foot.turning.angles[YAW])
        self.planner.reset(yaw)
        self.plan = StepPlan(yaw)
        self.swing.start(float(self.state.at(q, v, yaw).feet[stance.other].position[X]), 0.0)
        self._pelvis_yaw.start(0.0, 0.0)
        self._swing_yaw.start(0.0, 0.0)
        self.lengths.start(LegLength(), LegLength())
        self._since = np.inf
        self._sent: deque[FloatArray] = deque(maxlen=self._on_the_way + 1)  # accelerations, the oldest act now
        self._expected: float | None = None

    def tick(self, reading: SpatialReading) -> SpatialCommand:
        """Torques for a reading, one period after the last."""
        event: PhaseEvent | None = None
        self._estimate(reading)
        if self._lands(reading):
            event = PhaseEvent.LANDING
            self._land()
        return self._step(event)

    def _lands(self, reading: SpatialReading) -> bool:
        """Has the swing foot just landed, after `_estimate`?"""
        touches = reading.contact[1 if self.stance is Stance.LEFT else 0]
        return self.phases.landing(touches, self.estimator.clearance(self.stance.other))

    def _estimate(self, reading: SpatialReading) -> None:
        if self._sent:
            self.estimator.predict(self._sent[0])
        self.estimator.correct(reading)

    def _seen(self) -> SpaceState:
        """The state at the time when the torques will act, in the heading frame."""
        q, v = self.estimator.ahead(list(self._sent)[1:])
        return self.state.at(q, v, self.plan.heading)

    def _step(self, event: PhaseEvent | None) -> SpatialCommand:
        """Torques on one foot."""
        self._since += self.period
        plan = self.plan = self.planner.plan()
        state, stance = self._seen(), self.stance
        seen, sway = state.frontal(stance), state.sway(stance)
        if event is None:
            event = self.phases.turn(-sway.rate)
        phase = self.phases.phase
        wanted = self.frontal.at(phase, State(seen.q, seen.dq), sway, event, self._unexplained(sway))

        left = self.left = self.frontal.left(phase, sway)
        foot, other = state.feet[stance], state.feet[stance.other]
        law = self.sagittal
        beside = self._beside(stance, plan.turn)
        xi = float(state.com[X] - foot.position[X] + state.com_velocity[X] / law.omega) - beside
        low, high = law.reach
        cop = min(max(law.cop(xi, plan.length, left) + beside, low), high)
        ahead = float(foot.position[X]) + self._foothold(xi, beside, left)
        self.swing.advance(ahead, left, law.duration, self.period)
        self._lead_yaws(left)
        soft = self._softness()
        frequency = self.settings.swing
        swing = self.swing.ddx + soft * (
            frequency**2 * (self.swing.x - float(other.position[0]))
            + 2.0 * frequency * (self.swing.dx - float(other.velocity[0]))
        )
        targets = wanted.targets._replace(ddy=soft * wanted.targets.ddy)
        lengths = self.lengths
        lengths.advance(left, self.period)
        pelvis_yaw, swing_yaw = (Yaw(led.x, led.dx, led.ddx) for led in (self._pelvis_yaw, self._swing_yaw))
        asked = WholeBodyTargets(
            stance,
            targets,
            cop,
            swing,
            self._posture,
            soft,
            lengths.stance,
            lengths.swing,
            pelvis_yaw,
            swing_yaw,
        )
        solution = self.program.solve(state, asked)
        self._expected = sway.rate + self.period * float(sway.J @ solution.dv + sway.drift)
        self._send(solution.dv)
        place = state.to_world(np.array([self.swing.goal, other.position[Y], 0.0]))
        return SpatialCommand(
            solution.tau,
            phase,
            stance,
            event,
            seen.q,
            seen.dq,
            wanted.y,
            targets.p_fri,
            cop,
            np.array([place[X], place[Y], plan.next_yaw]),
            np.concatenate([state.to_world(solution.wrench[:3]), state.to_world(solution.wrench[3:])]),
            plan.speed,
            solution.solved,
            solution.given_way,
        )

    def _send(self, dv: FloatArray) -> None:
        """Remember accelerations (nv,) that are on their way."""
        if not self._sent:  # nothing else was on its way
            self._sent.extend([dv] * self._on_the_way)
        self._sent.append(dv)

    def _beside(self, stance: Stance, turn: float) -> float:
        """How far ahead of the stance ankle the middle between the feet is in a step that turns [m]."""
        return -0.5 * stance.sign * self.frontal.widths.width * float(np.sin(0.5 * turn))

    def _foothold(self, xi: float, beside: float, left: float) -> float:
        """Where the next ankle is to be, ahead of the stance ankle [m].

        Args:
            xi: divergent component ahead of the middle between the feet [m].
            beside: of the middle ahead of the stance ankle [m].
            left: time to the landing [s].
        """
        law, plan, landing = self.sagittal, self.plan, self.stance.other
        ahead = law.foothold(xi, plan.length, plan.next_length, left)
        if not (plan.turn or plan.next_turn):
            return ahead
        # at the landing the frame turns, and with it the divergent component seen from the foot that has landed
        begin = law.begin(plan.next_length)
        turned = 0.5 * (plan.turn + plan.next_turn)
        wanted = begin + self._beside(landing, plan.next_turn)
        aside = landing.sign * self._xi_outwards
        return ahead + begin + beside - (wanted - np.sin(turned) * aside) / float(np.cos(turned))

    def _lead_yaws(self, left: float) -> None:
        """One period on, pelvis and swing foot, with a time left to the landing [s]."""
        period = self.period
        early = left - (1.0 - TURNED_BY) * self.frontal.orbit.duration
        for led, goal in ((self._pelvis_yaw, 0.0), (self._swing_yaw, 0.5 * self.plan.turn)):
            if early > 3.0 * period:
                led.towards(goal, early, period)
            else:
                led.start(goal, 0.0)

    def counters(self) -> dict[str, int]:
        """What happened so far."""
        return {
            **self.program.counts,
            "landings": self.landings,
            "early_landings": self.phases.early_landings,
            "late_landings": self.phases.late_landings,
            "scuffs": self.phases.scuffs,
        }

    def _land(self) -> None:
        """The swing foot is on the ground: it is the stance foot from now on."""
        estimator, landed = self.estimator, self.stance.other
        before = self.state.at(estimator.q, estimator.v, self.plan.heading).frontal(self.stance)
        after = impact(self.biped, before.q, before.dq)
        estimator.land()
        self.landings += 1
        self._since = 0.0
        # what is on its way was made for the other foot: nobody knows what it does now
        self._sent = deque([self._still] * len(self._sent), maxlen=self._sent.maxlen)
        self.phases.stands(estimator.clearance(landed.other))
        self._begin_step(landed, after.dq_plus)

    def _begin_step(self, stance: Stance, dq: FloatArray | None) -> None:
        """A step begins, on a foot that stands.

        Args:
            stance: the foot.
            dq: (4,) rates of its stance coordinates, for the slope of the frontal plane [rad/s]; None: as estimated,
                out of double support.
        """
        estimator, last = self.estimator, self.plan
        self.stance, self._expected = stance, None
        plan = self.plan = self.planner.begin(stance, Pose(*estimator.place, last.next_yaw))
        state = self.state.at(estimator.q, estimator.v, plan.heading)
        self.swing.start(float(state.feet[stance.other].position[X]), 0.0)
        turned = last.heading - plan.heading
        self._pelvis_yaw.start(self._pelvis_yaw.x + turned, 0.0)
        self._swing_yaw.start(last.yaw - plan.heading, 0.0)
        self.lengths.start(*(self._length(state, side) for side in (stance, stance.other)))
        seen = state.frontal(stance)
        begun = State(seen.q, seen.dq if dq is None else dq)
        self.frontal.land(stance, state.sway(stance), begun, plan.widening(stance), dq is None)

    @staticmethod
    def _length(state: SpaceState, side: Stance) -> LegLength:
        leg = state.legs[side]
        return LegLength(float(leg.values[LENGTH]) - state.lengths[side], float(leg.rates[LENGTH]))

    def _unexplained(self, sway: Sway) -> float:
        """Acceleration of the sway in the last period beyond what the program expected [m/s^2]."""
        return 0.0 if self._expected is None else (sway.rate - self._expected) / self.period

    def _softness(self) -> float:
        begin, end, least = SOFT
        return min(max(least + (1.0 - least) * (self._since - begin) / (end - begin), least), 1.0)
