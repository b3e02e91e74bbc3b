"""The walking controller: virtual constraints and FRI target through the quadratic program."""

import logging
from collections.abc import Callable
from math import isfinite
from typing import NamedTuple, TypeVar

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Commands
from frontal_biped.control.settings import ControllerSettings
from frontal_biped.control.stabilisers.transitions import FixedTransitions, ReanchoringTransitions, Stabiliser
from frontal_biped.control.torques.linearisation import BODY_JOINTS, JOINTS, StanceDynamics, Targets
from frontal_biped.control.torques.linearising_many import keep_all, linearising_motions
from frontal_biped.control.torques.lyapunov import LyapunovFunction, least_acceleration
from frontal_biped.control.torques.torque_program import CLOSED_FORM, Source, TorqueProgram
from frontal_biped.control.torques.tracking import ErrorDynamics
from frontal_biped.control.torques.walking_qp import FORCES, OUTPUT_ACCELERATION
from frontal_biped.exceptions import ReversalError, UnreachablePoseError
from frontal_biped.gait.planned_step import PlannedStep
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.model.state import State
from frontal_biped.numerics.between import between
from frontal_biped.virtual_constraints.contract import RisingConstraints, VirtualConstraints
from frontal_biped.virtual_constraints.phase import StepPhase
from frontal_biped.zero_dynamics.half_steps import ConstrainedState

Constraints = TypeVar("Constraints", bound=VirtualConstraints)

_log = logging.getLogger(__name__)


SOLVED = (Source.CLOSED_FORM, Source.PROGRAM)
"""Sources of torques that keep every limit."""

SHIFT_ROOM = 0.7
"""Share of the sole, from the ankle outwards, inside which a shifted FRI target stays [-]: a robot that is a fifth
lighter than its model puts the FRI a fifth further out."""


class Command(NamedTuple):
    """Answer of one control tick.

    Attributes:
        u: (4,) torques [N m].
        ddq: (4,) accelerations the program expects [rad/s^2].
        force: (2,) ground reaction it expects [N].
        y: (3,) output [rad].
        dy: (3,) its rate [rad/s].
        p_fri_target: wanted FRI [m].
        source: where the torques come from.
        relaxation: delta of the control Lyapunov function [rad/s^2], zero without one.
    """

    u: FloatArray
    ddq: FloatArray
    force: FloatArray
    y: FloatArray
    dy: FloatArray
    p_fri_target: float
    source: Source
    relaxation: float = 0.0

    @property
    def solved(self) -> bool:
        """Are these the torques of the program as posed, every limit kept?"""
        return self.source in SOLVED


class QpController:
    """Drives y = q_b - h_d(beta) to zero with the FRI on its target, within the limits.

    By input-output linearisation, or by a control Lyapunov function (`ControllerSettings.outputs`).
    Where no torques keep every limit, the limits give way in order (see `relaxation`); where even that cannot be
    solved, or the state is not finite, the last command is given again. Both are logged (`logging`, level INFO) and
    counted.

    Args:
        biped: the robot.
        gait: what to track: a gait, or the step between two of them.
        settings: gains and limits; default: those of the gait's specification.
        stabiliser: chooses the virtual constraints of each phase; default: the paper's fixed ones.

    Attributes:
        lyapunov: the control Lyapunov function, or None.
        counts: commands given, by their source.
        declined: phases for which the stabiliser had no answer, walked as `ReanchoringTransitions` would.
    """

    def __init__(
        self,
        biped: FrontalBiped,
        gait: PlannedStep,
        settings: ControllerSettings | None = None,
        stabiliser: Stabiliser | None = None,
    ) -> None:
        self.biped = biped
        self.gait = gait
        self.settings = settings or ControllerSettings.for_gait(gait)
        self.program = TorqueProgram(biped, self.settings)
        self._errors = ErrorDynamics(self.settings.frequency, self.settings.damping)
        self._exact = self.settings.solver == "exact"
        clf = self.settings.outputs == "clf"
        self.lyapunov = LyapunovFunction(self.settings.epsilon) if clf else None
        self._price = self.settings.relaxation_price * OUTPUT_ACCELERATION
        self.counts = dict.fromkeys(Source, 0)
        self.declined = 0
        self._last: Command | None = None
        self.stabiliser: Stabiliser = FixedTransitions(gait) if stabiliser is None else stabiliser
        self._fallback = ReanchoringTransitions(biped, gait)
        self._rising: RisingConstraints = gait.rising
        self._phases: dict[StepPhase, VirtualConstraints] = {
            StepPhase.RISING: gait.rising,
            StepPhase.FALLING: gait.falling,
        }

    def copy(self) -> "QpController":
        """A controller that has been told what this one has, and goes on by itself."""
        twin = QpController(self.biped, self.gait, self.settings, self.stabiliser)
        twin.counts, twin.declined, twin._last = {**self.counts}, self.declined, self._last
        twin._rising, twin._phases = self._rising, {**self._phases}
        return twin

    @property
    def ticks(self) -> int:
        """Commands given."""
        return sum(self.counts.values())

    @property
    def relaxed(self) -> int:
        """Commands for which limits had to give way."""
        return self.counts[Source.RELAXED]

    @property
    def held(self) -> int:
        """Commands that repeated the last one."""
        return self.counts[Source.HELD]

    @property
    def unsolved(self) -> int:
        """Commands that are not the program's own solution: relaxed or held."""
        return self.relaxed + self.held

    def begin(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> None:
        """A phase begins at q (4,) [rad], dq (4,) [rad/s]: ask the stabiliser for its virtual constraints."""
        if phase is StepPhase.FALLING:
            reversal = float(q[0])
            self._phases[phase] = self._chosen(lambda by: by.falling(self._rising, reversal)) or self.gait.falling
        else:
            rate = float(dq[0])
            landed = ConstrainedState(q.copy(), dq[1:] / rate if rate else np.zeros(BODY_JOINTS), rate)
            self._phases[phase] = self._rising = self._chosen(lambda by: by.rising(landed)) or self.gait.rising

    def _chosen(self, ask: Callable[[Stabiliser], Constraints]) -> Constraints | None:
        """What the stabiliser answers, or where it has no answer the fallback; None where that has none either."""
        for stabiliser in (self.stabiliser, self._fallback):
            try:
                return ask(stabiliser)
            except (ReversalError, UnreachablePoseError):
                self.declined += stabiliser is not self._fallback
        return None

    def command(self, phase: StepPhase, q: FloatArray, dq: FloatArray, fri_shift: float = 0.0) -> Command:
        """Torques at a state.

        Args:
            phase: rising or falling.
            q: (4,) stance coordinates [rad].
            dq: (4,) their rates [rad/s].
            fri_shift: moves the FRI target, inside the sole [m].

        Returns:
            The command; ``source`` and ``solved`` say what it is worth.
        """
        state = State(q, dq)
        if not _finite(state):
            return self._without_a_state(phase, state)
        if self.lyapunov is None:
            return self._tracked(phase, state, fri_shift)
        targets, y, dy = self.targets(phase, state)
        if fri_shift:
            targets = targets._replace(p_fri=self._shifted(targets.p_fri, fri_shift))
        return self._answered(phase, state, targets, y, dy)

    def _tracked(self, phase: StepPhase, state: State, fri_shift: float) -> Command:
        """The command of a tick that linearises: most of them end where no limit is active."""
        q, dq = state
        h_d, h_d1, h_d2, p_fri = self._phases[phase].desired(q.item(0))
        if fri_shift:
            p_fri = self._shifted(p_fri, fri_shift)
        line, y, dy, ddy, curve = self._errors.at(q, dq, dq.item(0), h_d, h_d1, h_d2)
        dynamics = self.program.dynamics(state)
        command, oversteps = self._on_line(state, dynamics, line, y, dy, p_fri)
        return command or self._answered(phase, state, Targets(h_d1, curve, ddy, p_fri), y, dy, dynamics, oversteps)

    def _on_line(
        self, state: State, dynamics: StanceDynamics, line: FloatArray, y: FloatArray, dy: FloatArray, p_fri: float
    ) -> tuple[Command | None, bool]:
        """The command that linearises; where there is none, does one overstep limits?

        Not sought where the last tick was at limits, for this one mostly is too, nor where another solver is asked.
        """
        motion = dynamics.on_line(line, p_fri) if self._exact and not self.program.at_limits else None
        if motion is None:
            return None, False
        if not self.program.qp.limits.keep(state, motion):
            return None, True
        ddq, forces = motion
        command = self._last = Command(forces[BASE:], ddq, forces[:FORCES], y, dy, p_fri, CLOSED_FORM)
        self.counts[CLOSED_FORM] += 1
        return command, False

    def _shifted(self, p_fri: float, shift: float) -> float:
        """A FRI target moved, inside the sole [m]."""
        outer, inner = self.biped.sole
        return between(SHIFT_ROOM * outer, p_fri + shift, SHIFT_ROOM * inner)

    def follow(
        self,
        phase: StepPhase,
        state: State,
        targets: Targets,
        y: FloatArray,
        dy: FloatArray,
        dynamics: StanceDynamics | None = None,
        line: FloatArray | None = None,
    ) -> Command:
        """Torques for targets at a state, wherever the targets come from.

        Args:
            phase: rising or falling.
            state: stance coordinates.
            targets: what is asked of it.
            y: (3,) output that they are for [rad].
            dy: (3,) its rate [rad/s].
            dynamics: at the state, where they are known already.
            line: `Targets.line` of the targets, where it is known already.
        """
        oversteps = False
        if dynamics is not None and line is not None:
            # of a state that is not finite no motion keeps the limits
            command, oversteps = self._on_line(state, dynamics, line, y, dy, targets.p_fri)
            if command is not None:
                return command
        if not _finite(state):
            return self._without_a_state(phase, state)
        return self._answered(phase, state, targets, y, dy, dynamics, oversteps)

    def _without_a_state(self, phase: StepPhase, state: State) -> Command:
        return self._counted(self._held(), phase, state, "the state is not finite")

    def _answered(
        self,
        phase: StepPhase,
        state: State,
        targets: Targets,
        y: FloatArray,
        dy: FloatArray,
        dynamics: StanceDynamics | None = None,
        oversteps: bool = False,
    ) -> Command:
        """The program's answer at a finite state; is it known that what meets all targets does not keep all limits?"""
        answer = self.program.solve(state, targets, dynamics, oversteps)
        if answer is None:
            return self._counted(self._held(y, dy, targets.p_fri), phase, state, "the relaxed program is not solved")
        source, u, ddq, force, violation, delta = answer
        command = Command(u, ddq, force, y, dy, targets.p_fri, source, delta)
        self._last = command
        if source is Source.RELAXED:
            return self._counted(command, phase, state, f"limits overstepped by up to {violation:.2e}")
        self.counts[source] += 1
        return command

    def commands(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> Commands | None:
        """Torques at many states, the same as of `command` for each of them, to rounding.

        Args:
            phase: rising or falling.
            q: (m, 4) stance coordinates [rad].
            dq: (m, 4) their rates [rad/s].

        Returns:
            The answers; None unless all of them are known in closed form: ask for them one by one.
        """
        if self.lyapunov is not None or not self._exact or not isfinite((q * q + dq * dq).sum()):
            return None
        wanted = self._phases[phase].motion(q[:, 0])
        y, dy = q[:, 1:] - wanted.q[:, 1:], dq[:, 1:] - wanted.dq[:, 1:] * dq[:, :1]
        states = State(q, dq)
        motions = linearising_motions(self.biped, states, wanted, self._errors.asked(y, dy))
        if not keep_all(self.program.qp.limits, states, motions):
            return None
        self.counts[Source.CLOSED_FORM] += len(q)
        ddq, forces, p_fri = motions.ddq, motions.forces, wanted.p_fri
        last = (forces[-1, BASE:], ddq[-1], forces[-1, :FORCES], y[-1], dy[-1], p_fri.item(-1))
        self._last = Command(*last, Source.CLOSED_FORM)
        return Commands(forces[:, BASE:], y, p_fri)

    def _counted(self, command: Command, phase: StepPhase, state: State, why: str) -> Command:
        """A command that is not the program's own solution, counted and logged."""
        self.counts[command.source] += 1
        _log.info(
            "%s, %s phase, beta %.4f rad, dbeta %.4f rad/s: no torques keep every limit, %s: %s",
            self.biped.name,
            phase.value,
            state.beta,
            state.dbeta,
            "last command held" if command.source is Source.HELD else "limits relaxed",
            why,
        )
        return command

    def targets(self, phase: StepPhase, state: State) -> tuple[Targets, FloatArray, FloatArray]:
        """What is asked of a state: targets, output y (3,) [rad] and its rate (3,) [rad/s]."""
        q, dq = state
        h_d, h_d1, h_d2, p_fri = self._phases[phase].desired(q.item(0))
        _, y, dy, ddy, curve = self._errors.at(q, dq, dq.item(0), h_d, h_d1, h_d2)
        targets = Targets(h_d1, curve, ddy, p_fri)
        if self.lyapunov is not None:
            decrease = self.lyapunov.decrease(y, dy)
            ddy, delta = least_acceleration(decrease, self._price)
            targets = targets._replace(ddy=ddy, decrease=decrease, relaxation=delta)
        return targets, y, dy

    def _held(self, y: FloatArray | None = None, dy: FloatArray | None = None, p_fri: float | None = None) -> Command:
        """The last command again, before the first no torques; output and target, where known, of this tick."""
        joints, body = np.zeros(JOINTS), np.zeros(BODY_JOINTS)
        none = Command(joints, joints, np.zeros(FORCES), body, body, 0.0, Source.HELD)
        held = (self._last or none)._replace(source=Source.HELD)
        return held if y is None or dy is None or p_fri is None else held._replace(y=y, dy=dy, p_fri_target=p_fri)

    @property
    def rising(self) -> RisingConstraints:
        """Virtual constraints of the rising phase, as the stabiliser last chose them."""
        return self._rising

    def phase(self, phase: StepPhase) -> VirtualConstraints:
        """Virtual constraints of a phase, as the stabiliser last chose them."""
        return self._phases[phase]


def _finite(state: State) -> bool:
    """Is every number of a state finite? Where one is not, no sum is."""
    return isfinite(sum(state.q.tolist()) + sum(state.dq.tolist()))
