"""The walking controller: virtual constraints and FRI target through the quadratic program."""

from dataclasses import dataclass, replace

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.transitions import AdaptiveTransitions, FixedTransitions, Stabiliser
from frontal_biped.control.walking_qp import DDQ, FORCE, ContactLimits, Targets, U, WalkingQp
from frontal_biped.exceptions import ReversalError, UnreachablePoseError
from frontal_biped.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.phase_energy import Landed
from frontal_biped.quadratic_program import ProxQpSolver, QpSolution
from frontal_biped.virtual_constraints.phase import Phase, StepPhase


@dataclass(frozen=True)
class ControllerSettings:
    """Settings of the controller.

    Attributes:
        frequency: natural frequency of the output error dynamics [rad/s].
        damping: damping ratio of the output error dynamics [-].
        friction: coefficient of friction of the cone [-].
        min_normal_force: smallest normal force, as a fraction of the weight [-].
        max_torque: torque limits, chain order [N m]; None: the robot's.
        accuracy: absolute tolerance of the quadratic program.
        max_iterations: of the quadratic program.
    """

    frequency: float = 30.0
    damping: float = 1.0
    friction: float = 0.6
    min_normal_force: float = 0.1
    max_torque: tuple[float, float, float, float] | None = None
    accuracy: float = 1e-9
    max_iterations: int = 200

    @classmethod
    def for_gait(cls, gait: Gait) -> "ControllerSettings":
        """Defaults, with the friction, normal force and torque limits that the gait was designed for."""
        shared = ("friction", "min_normal_force", "max_torque")
        return cls(**{key: gait.specification[key] for key in shared if key in gait.specification})


@dataclass(frozen=True)
class Command:
    """Answer of one control tick.

    Attributes:
        u: (4,) torques [N m].
        ddq: (4,) accelerations the program expects [rad/s^2].
        force: (2,) ground reaction it expects [N].
        y: (3,) output [rad].
        dy: (3,) its rate [rad/s].
        p_fri_target: wanted FRI [m].
        solved: did the program reach its accuracy?
    """

    u: FloatArray
    ddq: FloatArray
    force: FloatArray
    y: FloatArray
    dy: FloatArray
    p_fri_target: float
    solved: bool


class QpController:
    """Input-output linearisation of y = q_b - h_d(beta) with the FRI on its target, within the limits.

    Args:
        biped: the robot.
        gait: what to track.
        settings: gains and limits; default: those of the gait's specification.
        stabiliser: chooses the virtual constraints of each phase; default: the paper's fixed ones.

    Attributes:
        ticks: commands given.
        unsolved: of these, programs that did not reach their accuracy.
        declined: phases for which the stabiliser had no answer, walked as `AdaptiveTransitions` would.
    """

    def __init__(
        self,
        biped: FrontalBiped,
        gait: Gait,
        settings: ControllerSettings | None = None,
        stabiliser: Stabiliser | None = None,
    ) -> None:
        self.biped = biped
        self.gait = gait
        self.settings = settings or ControllerSettings.for_gait(gait)
        outer, inner = biped.sole
        torque = biped.max_torque if self.settings.max_torque is None else np.array(self.settings.max_torque)
        limits = ContactLimits(
            self.settings.friction, self.settings.min_normal_force * biped.weight, outer, inner, torque
        )
        self._qp = WalkingQp(biped, limits)
        self._solver = ProxQpSolver(self.settings.accuracy, self.settings.max_iterations)
        self._kp = self.settings.frequency**2
        self._kd = 2.0 * self.settings.damping * self.settings.frequency
        self.ticks = 0
        self.unsolved = 0
        self.declined = 0
        self._last: Command | None = None
        self.stabiliser: Stabiliser = FixedTransitions(gait) if stabiliser is None else stabiliser
        self._fallback = AdaptiveTransitions(biped, gait)
        self._phases = {StepPhase.RISING: gait.rising, StepPhase.FALLING: gait.falling}

    def begin(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> None:
        """A phase begins at q (4,) [rad], dq (4,) [rad/s]: ask the stabiliser for its virtual constraints."""
        self._phases[phase] = self._next_phase(self.stabiliser, phase, q, dq)

    def _next_phase(self, stabiliser: Stabiliser, phase: StepPhase, q: FloatArray, dq: FloatArray) -> Phase:
        rate = float(dq[0])
        try:
            if phase is StepPhase.FALLING:
                return stabiliser.falling(self._phases[StepPhase.RISING], float(q[0]))
            slope = dq[1:] / rate if rate else np.zeros(3)
            return stabiliser.rising(Landed(q.copy(), slope, rate))
        except (ReversalError, UnreachablePoseError):
            if stabiliser is self._fallback:
                return self.gait.rising if phase is StepPhase.RISING else self.gait.falling
            self.declined += 1
            return self._next_phase(self._fallback, phase, q, dq)

    def command(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> Command:
        """Torques at a state.

        Args:
            phase: rising or falling.
            q: (4,) stance coordinates [rad].
            dq: (4,) their rates [rad/s].

        Returns:
            The command. Where the program cannot be solved, the last command's torques, with ``solved`` False; such
            ticks are counted in ``unsolved``.
        """
        constraints = self.phase(phase)
        h_d, h_d1, h_d2, p_fri = constraints.desired(q[0])
        y, dy = q[1:] - h_d, dq[1:] - h_d1 * dq[0]
        targets = Targets(h_d1, h_d2 * dq[0] ** 2, -self._kd * dy - self._kp * y, p_fri)
        solution = self.solve(q, dq, targets)
        self.ticks += 1
        x = solution.x * self._qp.scale
        if not solution.solved:
            self.unsolved += 1
            if self._last is not None:
                return replace(self._last, y=y, dy=dy, p_fri_target=p_fri, solved=False)
        command = Command(x[U].copy(), x[DDQ].copy(), x[FORCE].copy(), y, dy, p_fri, solution.solved)
        self._last = command
        return command

    def solve(self, q: FloatArray, dq: FloatArray, targets: Targets) -> QpSolution:
        """Build and solve the quadratic program at a state, warm-started at the unconstrained answer."""
        program = self._qp.build(q, dq, targets)
        return self._solver.solve(program, guess=self._qp.unconstrained())

    def phase(self, phase: StepPhase) -> Phase:
        """Virtual constraints of a phase, as the stabiliser last chose them."""
        return self._phases[phase]
