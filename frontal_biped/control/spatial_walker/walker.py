"""The walking controller of the whole robot: sensor readings in, torques of every joint out, no simulator in sight.

At every reading: estimate the state (`SpatialEstimator`), decide whether the swing foot has landed (`PhaseMachine`),
predict the state at the time when the torques will act, see the frontal plane in it (`SpaceState.frontal`) and ask
`FrontalLaw` for its outputs and FRI, `SagittalLaw` for the centre of pressure and the next foothold, `LegLengths` for
the legs' lengths; the whole-body program finds the torques that give all of it.
"""

from collections import deque

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.frontal_law import TURNED, FrontalLaw, FrontalSettings
from frontal_biped.control.interface import PhaseEvent
from frontal_biped.control.spatial_walker.estimator import SpatialEstimator, SpatialEstimatorSettings
from frontal_biped.control.spatial_walker.interface import SpatialCommand, SpatialReading
from frontal_biped.control.spatial_walker.leg_lengths import LegLengths, LengthSettings
from frontal_biped.control.spatial_walker.sagittal import SagittalLaw, SagittalSettings
from frontal_biped.control.spatial_walker.swing_path import SwingPath
from frontal_biped.control.walker.phase_machine import PhaseMachine, PhaseSettings
from frontal_biped.control.whole_body.program import WholeBodyProgram
from frontal_biped.control.whole_body.settings import WholeBodySettings
from frontal_biped.control.whole_body.targets import LegLength, WholeBodyTargets
from frontal_biped.exceptions import SimulationError
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.impact import impact
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import LENGTH, SpaceState
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.model.sway import Sway

SOFT = (0.009, 0.039, 0.15)
"""After a landing the contact rings: feedback is at the last of these shares until the first of these times [s], and
grows to all of it until the second."""

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
        speed: of the present step [m/s].
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
        self._posture = free.posture[BASE + 1 :].copy()
        self._still = np.zeros(free.model.nv)
        self._asked = speed
        self.reset(Stance.LEFT, free.posture, self._still)

    def command(self, speed: float | None = None, lateral: float | None = None, turn: float | None = None) -> None:
        """Walk at this speed [m/s] from the next step on.

        Raises:
            SimulationError: a lateral speed or a turn is asked for.
        """
        for name, value in (("lateral", lateral), ("turn", turn)):
            if value:
                raise SimulationError(f"{name} = {value:g}: a walk in space goes forwards and backwards only; leave it")
        if speed is not None:
            self._asked = speed

    def reset(self, stance: Stance, q: FloatArray, v: FloatArray) -> None:
        """Start right after an impact, standing on ``stance`` at q (nq,), v (nv,)."""
        self.stance = stance
        self.phases.reset()
        self.frontal.reset(stance)
        self.estimator.reset(stance, q, v)
        self.program.reset()
        self.landings = 0
        self.speed = 0.0
        self.left = self.frontal.orbit.duration
        self.swing.start(float(self.estimator.sole(stance.other)[0]), 0.0)
        self.lengths.start(LegLength(), LegLength())
        self._since = np.inf
        self._sent: deque[FloatArray] = deque(maxlen=self._on_the_way + 1)  # accelerations, the oldest act now
        self._expected: float | None = None

    def tick(self, reading: SpatialReading) -> SpatialCommand:
        """Torques for a reading, one period after the last."""
        estimator = self.estimator
        if self._sent:
            estimator.predict(self._sent[0])
        estimator.correct(reading)
        event: PhaseEvent | None = None
        touches = reading.contact[1 if self.stance is Stance.LEFT else 0]
        if self.phases.landing(touches, estimator.clearance(self.stance.other)):
            event = PhaseEvent.LANDING
            self._land()
        self._since += self.period
        q, v = estimator.ahead(list(self._sent)[1:])
        state, stance = self.state.at(q, v), self.stance
        seen, sway = state.frontal(stance), state.sway(stance)
        if event is None:
            event = self.phases.turn(-sway.rate)
        phase = self.phases.phase
        wanted = self.frontal.at(phase, State(seen.q, seen.dq), sway, event, self._unexplained(sway))

        left = self.left = self.frontal.orbit.left(phase, sway.value, sway.rate)
        foot, other = state.feet[stance], state.feet[stance.other]
        law = self.sagittal
        length, following = self.speed * law.duration, self._next_speed() * law.duration
        xi = float(state.com[0] - foot.position[0] + state.com_velocity[0] / law.omega)
        cop = law.cop(xi, length, left)
        ahead = float(foot.position[0]) + law.foothold(xi, length, following, left)
        self.swing.advance(ahead, left, law.duration, self.period)
        soft = self._softness()
        frequency = self.settings.swing
        swing = self.swing.ddx + soft * (
            frequency**2 * (self.swing.x - float(other.position[0]))
            + 2.0 * frequency * (self.swing.dx - float(other.velocity[0]))
        )
        targets = wanted.targets._replace(ddy=soft * wanted.targets.ddy)
        lengths = self.lengths
        lengths.advance(left, self.period)
        asked = WholeBodyTargets(stance, targets, cop, swing, self._posture, soft, lengths.stance, lengths.swing)
        solution = self.program.solve(state, asked)
        self._expected = sway.rate + self.period * float(sway.J @ solution.dv + sway.drift)
        if not self._sent:  # nothing else was on its way
            self._sent.extend([solution.dv] * self._on_the_way)
        self._sent.append(solution.dv)
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
            np.array([self.swing.goal, other.position[1], 0.0]),
            solution.wrench,
            self.speed,
            solution.solved,
            solution.given_way,
        )

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
        before = self.state.at(estimator.q, estimator.v).frontal(self.stance)
        after = impact(self.biped, before.q, before.dq)
        estimator.land()
        self.landings += 1
        self.stance, self.speed = landed, self._next_speed()
        self._since, self._expected = 0.0, None
        # what is on its way was made for the other foot: nobody knows what it does now
        self._sent = deque([self._still] * len(self._sent), maxlen=self._sent.maxlen)
        self.swing.start(float(estimator.sole(landed.other)[0]), 0.0)
        self.phases.stands(estimator.clearance(landed.other))
        state = self.state.at(estimator.q, estimator.v)
        self.lengths.start(*(self._length(state, side) for side in (landed, landed.other)))
        self.frontal.land(landed, state.sway(landed), State(state.frontal(landed).q, after.dq_plus))

    @staticmethod
    def _length(state: SpaceState, side: Stance) -> LegLength:
        leg = state.legs[side]
        return LegLength(float(leg.values[LENGTH]) - state.lengths[side], float(leg.rates[LENGTH]))

    def _next_speed(self) -> float:
        """Of the next step: as near to the command as one step may come [m/s]."""
        most = self.sagittal.settings.speed_change
        return self.speed + min(max(self._asked - self.speed, -most), most)

    def _unexplained(self, sway: Sway) -> float:
        """Acceleration of the sway in the last period beyond what the program expected [m/s^2]."""
        return 0.0 if self._expected is None else (sway.rate - self._expected) / self.period

    def _softness(self) -> float:
        begin, end, least = SOFT
        return min(max(least + (1.0 - least) * (self._since - begin) / (end - begin), least), 1.0)
