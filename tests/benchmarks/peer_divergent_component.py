r"""A peer that walks in space by the divergent component of motion in both planes, on the same whole-body program.

No virtual constraints, no zero dynamics and no energy: the robot is an inverted pendulum of constant frequency omega
whose divergent component :math:`\xi = h + \dot h/\omega`, h to the side of the swing foot, grows from one side of the
stance foot to where the next foot is put, in a step of fixed duration T and width W,

.. math:: \xi_{ref}(t) = p + \frac{W - 2 p}{1 + e^{\omega T}} e^{\omega t},

p the centre of pressure of an undisturbed step. An error of it dies out at a rate k under the centre of pressure, as
far as the sole reaches, and what is left at the landing moves the foothold: the sagittal plane's law, to the side. The
swing foot has a height profile of its own, the pelvis stays level, the virtual stance leg keeps its length.

Estimator, contact logic, sagittal law, swing path, whole-body program with all limits and weights, gains and the plant
are those of `SpatialWalker`.
"""

from dataclasses import dataclass, field

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import PhaseEvent
from frontal_biped.control.spatial_walker.estimator import SpatialEstimator
from frontal_biped.control.spatial_walker.interface import SpatialCommand, SpatialReading
from frontal_biped.control.spatial_walker.sagittal import SagittalLaw, SagittalSettings
from frontal_biped.control.spatial_walker.swing_path import SwingPath
from frontal_biped.control.spatial_walker.walker import SOFT
from frontal_biped.control.torques.linearisation import Targets
from frontal_biped.control.walker.phase_machine import PhaseMachine
from frontal_biped.control.whole_body.program import WholeBodyProgram
from frontal_biped.control.whole_body.settings import WholeBodySettings
from frontal_biped.control.whole_body.targets import WholeBodyTargets
from frontal_biped.control.whole_body.tasks import LENGTHS, NATURE, OUTPUTS, Rows, TaskRows
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import LENGTH, ROLL, SpaceState, Y, Z
from frontal_biped.model.stance_map import Stance

APART = 0.02
"""Least room between the soles at a foothold [m]."""

ASIDE = 0.2
"""How much wider than an undisturbed step one may be [m]."""

STRETCH = 0.1
"""Time in which the stance leg's length at a landing gives way to that of the posture [s]."""


@dataclass(frozen=True)
class PeerSettings:
    """Tuning of the peer.

    Attributes:
        duration: of a step [s].
        width: between the ankles of an undisturbed step [m].
        rate: k of the lateral plane [1/s].
        sagittal: the other plane's law, as for `SpatialWalker`.
        cop_share: share of half the sole's width inside which the centre of pressure is asked for [-].
        lift: height of the swing sole half-way [m].
        touchdown: speed at which it is lowered in the end [m/s].
    """

    duration: float
    width: float
    rate: float = 3.0
    sagittal: SagittalSettings = field(default_factory=SagittalSettings)
    cop_share: float = 0.8
    lift: float = 0.03
    touchdown: float = 0.1


@dataclass(frozen=True)
class LateralLaw:
    """The peer's lateral plane; lengths from the stance ankle towards the swing foot.

    Attributes:
        omega: sqrt(g/z) [1/s].
        duration: of a step [s].
        width: between the ankles [m].
        rate: k [1/s].
        p_ref: centre of pressure of an undisturbed step [m].
        reach: outermost and innermost centre of pressure [m].
        footholds: nearest and farthest [m].
    """

    omega: float
    duration: float
    width: float
    rate: float
    p_ref: float
    reach: tuple[float, float]
    footholds: tuple[float, float]

    @classmethod
    def of(cls, free: FreeRobot, omega: float, settings: PeerSettings) -> "LateralLaw":
        """The law of a robot."""
        sole = free.soles.left
        middle, half = 0.5 * (sole.inner - sole.outer), 0.5 * sole.width
        reach = settings.cop_share * half
        return cls(
            omega,
            settings.duration,
            settings.width,
            settings.rate,
            middle,
            (middle - reach, middle + reach),
            (2.0 * sole.inner + APART, settings.width + ASIDE),
        )

    def reference(self, left: float) -> float:
        """xi_ref [m] with a time left [s]."""
        grown = float(np.exp(self.omega * (self.duration - left)))
        return self.p_ref + (self.width - 2.0 * self.p_ref) / (1.0 + float(np.exp(self.omega * self.duration))) * grown

    def cop(self, xi: float, left: float) -> float:
        """Centre of pressure [m] asked for."""
        wanted = self.p_ref + (1.0 + self.rate / self.omega) * (xi - self.reference(left))
        return min(max(wanted, self.reach[0]), self.reach[1])

    def foothold(self, xi: float, left: float) -> float:
        """Where the next ankle is to be [m], so that the next step begins on its reference."""
        error = xi - self.reference(left)
        push = (1.0 + self.rate / self.omega) * error
        room = self.reach[error > 0.0] - self.p_ref
        if abs(push) <= abs(room):
            error *= float(np.exp(-self.rate * left))
        else:  # the sole is at its edge: what it cannot brake grows
            error = room + (error - room) * float(np.exp(self.omega * left))
        wanted = self.reference(0.0) + error + self.reference(self.duration)
        return min(max(wanted, self.footholds[0]), self.footholds[1])


@dataclass(frozen=True)
class PeerTargets(WholeBodyTargets):
    """Targets of one tick; of ``frontal`` only the centre of pressure to the side counts.

    Attributes:
        sideways: acceleration of the swing sole along Y, feedback included [m/s^2].
        upwards: along Z [m/s^2].
        stretch: of the stance leg beyond the length of the posture [m].
    """

    sideways: float = 0.0
    upwards: float = 0.0
    stretch: float = 0.0


class PeerRows(TaskRows):
    """The rows of the program with the swing sole's way and both rolls in the place of the paper's outputs."""

    def write(self, state: SpaceState, targets: WholeBodyTargets) -> Rows:
        """The rows at a state."""
        assert isinstance(targets, PeerTargets)
        rows, settings = super().write(state, targets), self.settings
        A, b = rows.A[NATURE:, : state.M.shape[0]], rows.b[NATURE:]
        other, pelvis, soft = state.feet[targets.stance.other], state.pelvis, targets.softness
        A[OUTPUTS] = other.J[Y], pelvis.J[ROLL], other.turning.J[ROLL]
        b[OUTPUTS] = (
            targets.sideways - other.drift[Y],
            -soft * held(settings.pelvis, pelvis.angles[ROLL], pelvis.rates[ROLL]) - pelvis.drift[ROLL],
            -soft * held(settings.foot, other.turning.angles[ROLL], other.turning.rates[ROLL])
            - other.turning.drift[ROLL],
        )
        b[LENGTHS.start] += settings.length**2 * targets.stretch
        A[LENGTHS.start + 1] = other.J[Z]
        b[LENGTHS.start + 1] = targets.upwards - other.drift[Z]
        return rows


def held(frequency: float, error: float, rate: float) -> float:
    """What a critically damped return to zero takes off."""
    return frequency**2 * error + 2.0 * frequency * rate


class PeerWalker:
    """Walks by the divergent component of motion in both planes.

    Args:
        free: the robot.
        tuning: of the peer.
        period: time between readings [s].
        speed: commanded mean speed forwards [m/s].
        settings: gains and limits of the whole-body program.
    """

    def __init__(
        self,
        free: FreeRobot,
        tuning: PeerSettings,
        *,
        period: float = 1e-3,
        speed: float = 0.0,
        settings: WholeBodySettings | None = None,
    ) -> None:
        self.free, self.tuning, self.period = free, tuning, period
        self.settings = settings or WholeBodySettings()
        self.program = WholeBodyProgram(free, self.settings, PeerRows(free, self.settings))
        self.state = SpaceState(free)
        self.estimator = SpatialEstimator(free, period)
        self.phases = PhaseMachine(period)
        self.sagittal = SagittalLaw.of(self.state, tuning.duration, tuning.sagittal)
        self.lateral = LateralLaw.of(free, self.sagittal.omega, tuning)
        self.forwards, self.sideways = SwingPath(), SwingPath()
        self._posture = free.posture[BASE + 1 :].copy()
        self._asked = speed
        self.reset(Stance.LEFT, free.posture, np.zeros(free.model.nv))

    def command(self, speed: float | None = None, lateral: float | None = None, turn: float | None = None) -> None:
        """Walk at this speed [m/s] from the next step on."""
        assert not lateral and not turn, "the peer goes forwards and backwards only"
        if speed is not None:
            self._asked = speed

    def reset(self, stance: Stance, q: FloatArray, v: FloatArray) -> None:
        """Start right after an impact."""
        self.stance, self.speed, self.landings = stance, 0.0, 0
        self.phases.reset()
        self.estimator.reset(stance, q, v)
        self.program.reset()
        self._sent: FloatArray | None = None
        self._begin()

    def tick(self, reading: SpatialReading) -> SpatialCommand:
        """Torques for a reading, one period after the last."""
        estimator, tuning = self.estimator, self.tuning
        if self._sent is not None:
            estimator.predict(self._sent)
        estimator.correct(reading)
        event: PhaseEvent | None = None
        touches = reading.contact[1 if self.stance is Stance.LEFT else 0]
        if self.phases.landing(touches, estimator.clearance(self.stance.other)):
            event = PhaseEvent.LANDING
            self._land()
        self._since += self.period
        state, stance = self.state.at(estimator.q, estimator.v), self.stance
        if event is None:  # a step is half over when half its time is
            event = self.phases.turn(0.5 * tuning.duration - self._since)
        left = max(tuning.duration - self._since, 0.0)
        foot, other = state.feet[stance], state.feet[stance.other]
        inwards = -stance.sign
        xi = state.com[:2] - foot.position[:2] + state.com_velocity[:2] / self.sagittal.omega
        length, following = self.speed * tuning.duration, self._asked * tuning.duration
        cop_x = self.sagittal.cop(float(xi[0]), length, left)
        cop_h = self.lateral.cop(inwards * float(xi[1]), left)
        goal_x = float(foot.position[0]) + self.sagittal.foothold(float(xi[0]), length, following, left)
        goal_y = float(foot.position[1]) + inwards * self.lateral.foothold(inwards * float(xi[1]), left)
        soft = self._softness()
        accelerations = [
            self._follow(path, goal, left, float(other.position[axis]), float(other.velocity[axis]), soft)
            for axis, (path, goal) in enumerate(((self.forwards, goal_x), (self.sideways, goal_y)))
        ]
        z, dz, ddz = self._height(self._since)
        up = ddz - soft * held(self.settings.swing, float(other.position[2]) - z, float(other.velocity[2]) - dz)
        stretch = self._stretch * float(np.exp(-self._since / STRETCH))
        zero = np.zeros(3)
        targets = PeerTargets(
            stance,
            Targets(zero, zero, zero, cop_h),
            cop_x,
            accelerations[0],
            self._posture,
            soft,
            sideways=accelerations[1],
            upwards=up,
            stretch=stretch,
        )
        solution = self.program.solve(state, targets)
        self._sent = solution.dv
        seen = state.frontal(stance)
        return SpatialCommand(
            solution.tau,
            self.phases.phase,
            stance,
            event,
            seen.q,
            seen.dq,
            zero,
            cop_h,
            cop_x,
            np.array([self.forwards.goal, self.sideways.goal, 0.0]),
            solution.wrench,
            self.speed,
            solution.solved,
            solution.given_way,
        )

    def counters(self) -> dict[str, int]:
        """What happened so far."""
        return {**self.program.counts, "landings": self.landings, "early_landings": self.phases.early_landings}

    def _follow(self, path: SwingPath, goal: float, left: float, at: float, rate: float, soft: float) -> float:
        path.advance(goal, left, self.tuning.duration, self.period)
        return path.ddx - soft * held(self.settings.swing, at - path.x, rate - path.dx)

    def _height(self, t: float) -> tuple[float, float, float]:
        """Reference of the swing sole's height, its rate and acceleration: up, down, and on down if nothing is met."""
        half, lift, down = 0.5 * self.tuning.duration, self.tuning.lift, self.tuning.touchdown
        if t >= 2.0 * half:
            return -down * (t - 2.0 * half), -down, 0.0
        s = t / half - (t >= half)
        jerk = np.array([10.0, -15.0, 6.0])  # minimum jerk from 0 to 1
        final = np.array([-4.0, 7.0, -3.0]) * down * half  # from rest at 0 to the rate at 0
        powers = np.array([s**3, s**4, s**5])
        rates = np.array([3 * s**2, 4 * s**3, 5 * s**4]) / half
        accelerations = np.array([6 * s, 12 * s**2, 20 * s**3]) / half**2
        c = lift * jerk if t < half else -lift * jerk - final
        return float(c @ powers) + (0.0 if t < half else lift), float(c @ rates), float(c @ accelerations)

    def _land(self) -> None:
        self.estimator.land()
        self.landings += 1
        self.stance = self.stance.other
        most = self.sagittal.settings.speed_change
        self.speed += min(max(self._asked - self.speed, -most), most)
        self._sent = None
        self._begin()

    def _begin(self) -> None:
        """A step begins."""
        self._since = 0.0
        state = self.state.at(self.estimator.q, self.estimator.v)
        self._stretch = float(state.legs[self.stance].values[LENGTH]) - state.lengths[self.stance]
        at = self.estimator.sole(self.stance.other)
        self.forwards.start(float(at[0]), 0.0)
        self.sideways.start(float(at[1]), 0.0)

    def _softness(self) -> float:
        if not self.landings:
            return 1.0
        begin, end, least = SOFT
        return min(max(least + (1.0 - least) * (self._since - begin) / (end - begin), least), 1.0)
