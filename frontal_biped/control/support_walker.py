r"""A walker that stands, sets off, walks with finite double supports, stops and stands, from readings alone.

*Double support.* beta follows a `SupportPlan`, made when the phase begins from where the robot is,

.. math:: \ddot\beta = \ddot\beta_d + 2 \omega (\dot\beta_d - \dot\beta) + \omega^2 (\beta_d - \beta),

and `SupportProgram` finds torques that share the load. dbeta is the rate along the family that has the robot's
momentum, q' D dq / (q' D q'), with one foot taken to be at rest. Either may be: the foot that has just landed settles
for some milliseconds, and so does the one that is about to leave. beta and dbeta are those seen from either, weighed as
the load is meant to pass from one to the other.

*Single support.* The virtual constraints and the FRI through the quadratic program (`QpController`), falling along the
curve of the rising phase. Feet never land exactly where they should, and torques that see an error at the lift-off
would press the foot that is to rise into the ground: the error of the outputs is taken over as it is and led to zero by
a polynomial of degree 5 in time, so that the first accelerations are the planned ones. Where the robot is back at the
pose of the landing and no foot has touched, the swing foot is lowered until it does.
"""

from dataclasses import dataclass
from enum import Enum

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.controller import QpController
from frontal_biped.control.interface import Reading
from frontal_biped.control.settings import ControllerSettings, sampled_frequency
from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions
from frontal_biped.control.support_torques import SupportProgram
from frontal_biped.control.torques.linearisation import Targets
from frontal_biped.control.walker.measured_state import measured_state
from frontal_biped.exceptions import ControllerError, ReversalError
from frontal_biped.gait.support_gait import SupportGait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.numerics.quintic import Kinematics, Quintic
from frontal_biped.virtual_constraints.contract import RisingConstraints, VirtualConstraints
from frontal_biped.virtual_constraints.double_support import DoubleSupportFamily
from frontal_biped.virtual_constraints.phase import StepPhase
from frontal_biped.virtual_constraints.piecewise import ContinuedPhase
from frontal_biped.zero_dynamics.half_steps import ConstrainedState
from frontal_biped.zero_dynamics.support_dynamics import SupportPoint
from frontal_biped.zero_dynamics.support_plan import HandOver, SingleSupportEnd, SupportPlan, rest_to_rest

FREQUENCY = 20.0
"""omega of the motion along the family [rad/s]."""

LOWERING = 0.03
"""Speed at which a foot is lowered that has not found the ground [m/s]."""

AIRBORNE = 0.02
"""Time after the lift-off before a touch may be a landing [s]."""

FADING = 0.1
"""Time in which the error of the outputs at the lift-off is led to zero [s]."""

SETTLED = 0.02
"""dbeta below which a robot that has come to rest stands [rad/s]."""


class SupportMode(Enum):
    """What the walker is doing."""

    STANDING = "standing"
    SETTING_OFF = "setting off"
    SINGLE = "single support"
    HAND_OVER = "double support"
    STOPPING = "coming to rest"


@dataclass(frozen=True)
class Retraced:
    """A stabiliser for gaits whose falling phase is the rising one backwards, wherever it reverses.

    Attributes:
        curve: the rising phase with its continuation.
    """

    curve: ContinuedPhase

    name = "retraced"

    def rising(self, landed: ConstrainedState) -> RisingConstraints:
        """The curve."""
        return self.curve

    def falling(self, rising: RisingConstraints, reversal: float) -> VirtualConstraints:
        """The same curve."""
        return self.curve


@dataclass(frozen=True)
class SupportCommand:
    """Answer to one reading.

    Attributes:
        joint_torques: (4,) URDF order [N m].
        mode: what the walker is doing.
        stance: the foot that carries, or in double support takes, the weight.
        u: (4,) the same torques in stance coordinates [N m].
        q: (4,) state [rad].
        dq: (4,) [rad/s].
        speed: dbeta, in double support along the family [rad/s].
        q_b_desired: (3,) where the other joints should be [rad].
        p_target: where all that the ground does should act, from the stance ankle [m].
        rising: does the robot move outwards?
        began: the mode that begins with this command; None where it goes on.
    """

    joint_torques: FloatArray
    mode: SupportMode
    stance: Stance
    u: FloatArray
    q: FloatArray
    dq: FloatArray
    speed: float
    q_b_desired: FloatArray
    p_target: float
    rising: bool
    began: SupportMode | None


class SupportWalker:
    """Stands and walks on command.

    Args:
        biped: the robot as the walker believes it to be.
        gait: what to walk.
        period: time between readings [s].
        settings: gains and limits of single support; default: the gait's, and the gains of `sampled_frequency`.
        dead_beat: does each double support lift off with the speed of the orbit, whatever the robot landed with? If
            not, with the speed that it landed with.

    Attributes:
        walking: is the robot to walk? Set it at any time: it sets off, or comes to rest at the next landing.
        mode: what it is doing.
        stance: the foot that carries, or takes, the weight.
        landings: so far.
    """

    def __init__(
        self,
        biped: FrontalBiped,
        gait: SupportGait,
        *,
        period: float = 1e-3,
        settings: ControllerSettings | None = None,
        dead_beat: bool = True,
    ) -> None:
        self.biped, self.gait, self.period, self.dead_beat = biped, gait, period, dead_beat
        self.family: DoubleSupportFamily = gait.family(biped)
        self.half_way = self.family.half_way()
        self._support = SupportProgram(gait.limits(biped), gait.p_fri)
        if settings is None:
            limits = ControllerSettings.for_gait(gait)
            settings = ControllerSettings(
                frequency=sampled_frequency(period),
                friction=limits.friction,
                min_normal_force=limits.min_normal_force,
                max_torque=limits.max_torque,
            )
        self.curve = ReanchoringTransitions(biped, gait).planned_rising
        self._single = QpController(biped, gait, settings, Retraced(self.curve))
        self.walking = False
        self.reset(Stance.LEFT)

    def reset(self, stance: Stance) -> None:
        """Stand half-way, the first step to be taken on ``stance``."""
        self.stance, self.mode, self.landings = stance, SupportMode.STANDING, 0
        self.family = self.gait.family(self.biped)
        self._over = self._hand_over(self.gait.speed)
        self._plan: SupportPlan = rest_to_rest(self.family, self.half_way, self.half_way, 1.0)
        self._since = self._low = 0.0
        self._fading: list[Quintic] = []

    def begin_single_support(self, stance: Stance) -> None:
        """Take the robot over right at a lift-off, standing on ``stance``."""
        self.reset(stance)
        self._enter(SupportMode.SINGLE)

    def _hand_over(self, speed: float) -> HandOver:
        """The double support between feet that stand as they do, and where it is to lift off."""
        return HandOver.mirrored(self.family, SingleSupportEnd(self.gait.rising.beta_start, self.gait.p_fri), speed)

    def tick(self, reading: Reading) -> SupportCommand:
        """Torques for a reading, one period after the last.

        Raises:
            ControllerError: the reading tells no rates.
        """
        before, landed = self.mode, False
        state = self._state(reading, self.stance)
        if self.mode is SupportMode.SINGLE:
            touches = reading.contact[1 if self.stance is Stance.LEFT else 0]
            if touches and state.dbeta < 0.0 and self._since > AIRBORNE:
                self.landings += 1
                landed = True
                self._take_weight(state)
                state = self._state(reading, self.stance)
        elif self._since >= self._plan.duration - 0.5 * self.period:
            if self.mode in (SupportMode.SETTING_OFF, SupportMode.HAND_OVER):
                self._enter(SupportMode.SINGLE)
                self._fade(state)
            elif self.mode is SupportMode.STOPPING and abs(self._along_family(reading)[1]) < SETTLED:
                self._stand(self._plan.at(self._plan.duration).x)
        if self.mode is SupportMode.STANDING and self.walking:
            self._over = self._hand_over(self.gait.speed)
            self._plan = self._over.setting_off(self._along_family(reading)[0], self.gait.setting_off)
            self._enter(SupportMode.SETTING_OFF)
        single = self.mode is SupportMode.SINGLE
        command = self._in_single_support(state) if single else self._in_double_support(state, reading)
        self._since += self.period
        if landed or self.mode is not before:
            return _with_beginning(command, self.mode)
        return command

    def counters(self) -> dict[str, int]:
        """What happened so far."""
        return {
            "landings": self.landings,
            "single_support_ticks": self._single.ticks,
            "single_support_unsolved": self._single.unsolved,
            "double_support_ticks": self._support.ticks,
            "double_support_bounded": self._support.bounded,
            "double_support_unsolved": self._support.unsolved,
        }

    # ------------------------------------------------------------------ what to do
    def _enter(self, mode: SupportMode) -> None:
        self.mode, self._since, self._low = mode, 0.0, 0.0

    def _fade(self, state: State) -> None:
        h_d, h_d1, *_ = self.curve.desired(state.beta)
        y, dy = state.q[1:] - h_d, state.dq[1:] - h_d1 * state.dbeta
        nothing = Kinematics(0.0, 0.0, 0.0)
        starts = (Kinematics(*pair, 0.0) for pair in zip(y.tolist(), dy.tolist(), strict=True))
        self._fading = [Quintic.between(start, nothing, FADING) for start in starts]

    def _stand(self, beta: float) -> None:
        self._plan = rest_to_rest(self.family, beta, beta, 1.0)
        self._enter(SupportMode.STANDING)

    def _take_weight(self, state: State) -> None:
        """Hand over, or come to rest, after a landing in a state seen from the foot that stood until then."""
        self.stance = self.stance.other
        self.family = DoubleSupportFamily(self.biped, float(self.biped.joint_positions(state.q)[-1, 0]))
        beta, speed = self._from_other(state)
        self._over = self._hand_over(self.gait.speed if self.dead_beat else speed)
        if self.walking:
            try:
                self._plan = self._over.plan(speed, beta)
                self._enter(SupportMode.HAND_OVER)
                return
            except ReversalError:
                pass  # too slow to get over: come to rest instead
        self._plan = self._over.coming_to_rest(self.half_way, self.gait.setting_off, speed, beta)
        self._enter(SupportMode.STOPPING)

    def _state(self, reading: Reading, stance: Stance) -> State:
        q, dq = measured_state(self.biped.stance_map, reading, stance)
        if dq is None:
            raise ControllerError("SupportWalker needs joint velocities; give readings that have them")
        return State(q, dq)

    def _speed(self, state: State) -> float:
        """dbeta along the family that has the robot's momentum [rad/s]."""
        slope = self.family.at(state.beta).dq
        momentum = self.biped.D(state.q) @ slope
        return float(momentum @ state.dq / (momentum @ slope))

    def _from_other(self, state: State) -> tuple[float, float]:
        """beta [rad] and dbeta [rad/s] along the family, of a state seen from the other foot."""
        at = self.family.at(state.beta)
        return float(at.q[3]), float(at.dq[3]) * self._speed(state)

    def _along_family(self, reading: Reading) -> tuple[float, float]:
        """beta [rad] and dbeta [rad/s] along the family, seen from both feet."""
        state = self._state(reading, self.stance)
        own = np.array([state.beta, self._speed(state)])
        other = np.array(self._from_other(self._state(reading, self.stance.other)))
        passed = min(self._since / self._plan.duration, 1.0)
        share = {
            SupportMode.HAND_OVER: passed,
            SupportMode.SETTING_OFF: max(0.5, passed),
            SupportMode.STOPPING: min(0.5, passed),
        }.get(self.mode, 0.5)
        beta, speed = share * own + (1.0 - share) * other
        return float(beta), float(speed)

    # ------------------------------------------------------------------ torques
    def _in_double_support(self, state: State, reading: Reading) -> SupportCommand:
        beta, speed = self._along_family(reading)
        point = SupportPoint.of(self.family, beta)
        wanted = self._plan.at(self._since)
        omega = FREQUENCY
        acceleration = wanted.ddx + 2.0 * omega * (wanted.dx - speed) + omega**2 * (wanted.x - beta)
        answer = self._support.solve(point, speed, acceleration)
        p = point.pressure_point(answer.acceleration, speed**2)
        outwards = wanted.dx > 0.0  # as planned: at rest the sign of the measured rate is noise
        return self._command(answer.u, state, speed, point.at.q[1:], p, outwards)

    def _in_single_support(self, state: State) -> SupportCommand:
        rising = state.dbeta > 0.0
        phase = StepPhase.RISING if rising else StepPhase.FALLING
        low = not rising and state.beta < self.curve.beta_start
        if low:
            self._low += self.period
            at = self.family.at(state.beta)
            down, fall = self._downwards(at.q), LOWERING * self._low
            h_d, h_d1, h_d2 = at.q[1:] + fall * down, at.dq[1:], at.ddq[1:]
            p_fri = self.gait.p_fri
            rate, drift = LOWERING * down, np.zeros(len(h_d))
        else:
            h_d, h_d1, h_d2, p_fri = self.curve.desired(state.beta)
            rate = drift = np.zeros(len(h_d))
            if self._since < FADING and self._fading:
                fading = [path.at(self._since) for path in self._fading]
                h_d = h_d + np.array([at.x for at in fading])
                rate, drift = np.array([at.dx for at in fading]), np.array([at.ddx for at in fading])
        settings = self._single.settings
        kp, kd = settings.frequency**2, 2.0 * settings.damping * settings.frequency
        y = state.q[1:] - h_d
        dy = state.dq[1:] - h_d1 * state.dbeta - rate
        targets = Targets(h_d1, h_d2 * state.dbeta**2, drift - kd * dy - kp * y, p_fri)
        u = self._single.follow(phase, state, targets, y, dy).u
        return self._command(u, state, state.dbeta, h_d, p_fri, rising)

    def _downwards(self, q: FloatArray) -> FloatArray:
        """(3,) motion of the other joints that lowers the swing foot by one metre, flat and on the spot [rad/m]."""
        inner, outer = self.biped.swing_sole_jacobian(q)[:, :, 1:]
        rows = np.vstack([0.5 * (inner + outer), np.ones(3)])
        return np.asarray(np.linalg.solve(rows, np.array([0.0, -1.0, 0.0])))

    def _command(
        self, u: FloatArray, state: State, speed: float, q_b: FloatArray, p: float, rising: bool
    ) -> SupportCommand:
        tau = self.biped.stance_map.torques_to_urdf(u, self.stance)
        return SupportCommand(tau, self.mode, self.stance, u, *state, speed, q_b, p, rising, None)


def _with_beginning(command: SupportCommand, mode: SupportMode) -> SupportCommand:
    values = {name: getattr(command, name) for name in command.__dataclass_fields__}
    return SupportCommand(**(values | {"began": mode}))
