"""The walking robot's own controller: from what its sensors say to torques, with no simulator in sight.

At every reading: estimate the state (`StateEstimator`), decide whether the swing foot has landed (`PhaseMachine`),
predict the state at the time when the torques will act, decide there whether the robot has turned, ask the quadratic
program for the torques, with the FRI target moved so that the energy of the orbit is kept.

The virtual constraints are followed over the sway (`OverSway`), or over beta with phases that a stabiliser chooses
(`OverAnkle`): where one is named, and for gaits whose centre of mass does not move outwards all along the rising phase.
"""

from collections import deque
from dataclasses import replace
from itertools import islice
from math import inf

from frontal_biped.arrays import FloatArray
from frontal_biped.control.controller import QpController
from frontal_biped.control.frontal_law import TURNED, FrontalLaw, FrontalSettings
from frontal_biped.control.interface import PhaseEvent, Reading, WalkerCommand
from frontal_biped.control.settings import ControllerSettings, sampled_frequency
from frontal_biped.control.stabilisers.by_name import make_stabiliser
from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions, Stabiliser
from frontal_biped.control.torques.torque_program import CLOSED_FORM
from frontal_biped.control.walker.energy_law import EnergyLaw, EnergySettings
from frontal_biped.control.walker.estimator_gains import EstimatorSettings
from frontal_biped.control.walker.measured_state import measured_state
from frontal_biped.control.walker.over_ankle import OverAnkle
from frontal_biped.control.walker.over_sway import OverSway
from frontal_biped.control.walker.phase_machine import PhaseMachine, PhaseSettings
from frontal_biped.control.walker.state_estimator import StateEstimator
from frontal_biped.exceptions import SimulationError
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.sideways import AnyGait, SidewaysGait, steps_in_turn
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance, relabel
from frontal_biped.model.state import State
from frontal_biped.virtual_constraints.swayed import runs_one_way

DEFAULT_ENERGY = EnergySettings()
"""How a walker keeps the energy of the orbit unless told otherwise."""

PHASE_VARIABLES = ("sway", "ankle")
"""What virtual constraints may be followed over: the centre of mass over the stance ankle, or the ankle's angle."""

SWING = {Stance.LEFT: 1, Stance.RIGHT: 0}
"""Where in the contact flags, left and right, that of the swing foot is."""

SETTLE = 0.03
"""Time after a landing when the virtual constraints begin anew [s]."""


class Walker:
    """Walks a gait from sensor readings alone; the same object drives any simulator, or a robot.

    Args:
        biped: the robot as the walker believes it to be.
        gait: what to walk; the first of two steps in turn belongs to the foot that stands where the walker is reset.
        period: time between readings [s].
        settings: gains and limits; default: the gait's friction and normal force, the robot's own torque limits, and
            the gains of `sampled_frequency`.
        stabiliser: chooses the virtual constraints of each phase over beta; an object or one of `STABILISERS` by name.
            Default: over the sway, or with ``over`` "ankle" re-anchored transitions that leave the energy to the energy
            law, and rescale an early falling phase.
        delay: known time from a reading to the torques it leads to [s], a multiple of the period.
        phases: when to believe in a landing or a reversal.
        estimator: what to trust of the readings.
        energy: how the energy of the orbit is kept; None: it is left to the stabiliser.
        settle: time after a landing when the virtual constraints begin anew [s]; 0: never.
        over: the phase variable, "sway" or "ankle"; default: the sway, unless a stabiliser is given or the gait
            cannot be followed over it (`runs_one_way`).

    Attributes:
        over: the phase variable.

    Raises:
        SimulationError: the delay is no multiple of the period, stabiliser or phase variable are unknown, or the gait
            cannot be followed over the sway that was asked for.
    """

    def __init__(
        self,
        biped: FrontalBiped,
        gait: AnyGait,
        *,
        period: float = 1e-3,
        settings: ControllerSettings | None = None,
        stabiliser: Stabiliser | str | None = None,
        delay: float = 0.0,
        phases: PhaseSettings | None = None,
        estimator: EstimatorSettings | None = None,
        energy: EnergySettings | None = DEFAULT_ENERGY,
        settle: float = SETTLE,
        over: str | None = None,
    ) -> None:
        self.biped, self.gait, self.period, self.delay = biped, gait, period, delay
        self._on_the_way = round(delay / period)
        if self._on_the_way < 0 or abs(self._on_the_way * period - delay) > 1e-6 * period:
            raise SimulationError(f"a delay of {delay:g} s is no multiple of the period of {period:g} s; make it one")
        first = steps_in_turn(gait)[0]
        if settings is None:
            limits = ControllerSettings.for_gait(first)
            settings = replace(limits, max_torque=None, frequency=sampled_frequency(period))
        self.over = _phase_variable(biped, gait, over, stabiliser, settings.outputs)
        if stabiliser is None:
            alone = energy is None  # otherwise the energy law sees to the speed, and the transitions to the loads
            stabiliser = ReanchoringTransitions(biped, first, anticipate=alone, rejoin=alone)
        elif isinstance(stabiliser, str):
            assert isinstance(gait, Gait)  # two steps in turn are followed over the sway, without a stabiliser
            stabiliser = make_stabiliser(stabiliser, biped, gait)
        self.controller = QpController(biped, first, settings, stabiliser)
        self.estimator = StateEstimator(biped, period, estimator, delay)
        self._law: OverSway | OverAnkle
        if self.over == "sway":
            frontal = FrontalSettings(energy, settle=settle)
            law = FrontalLaw(biped, gait, period, settings.frequency, frontal, settings.damping)
            self._law = OverSway(biped, self.controller, law)
            self.phases = PhaseMachine(period, phases or PhaseSettings(rate=TURNED))
        else:
            assert isinstance(gait, Gait)
            kept = None if energy is None else EnergyLaw(biped, gait, period, energy)
            self._law = OverAnkle(self.controller, kept, period, settle)
            self.phases = PhaseMachine(period, phases)
        self.landings = 0
        self.reset(Stance.LEFT, *gait.state_after_impact())

    def reset(self, stance: Stance, q: FloatArray, dq: FloatArray) -> None:
        """Start right after an impact, standing on ``stance`` at q (4,) [rad], dq (4,) [rad/s]."""
        self.stance = stance
        self.estimator.reset(stance, q, dq)
        self.phases.reset()
        # as `_in_stance` takes them, the oldest act now
        self._sent: deque[tuple[Stance, FloatArray]] = deque(maxlen=self._on_the_way + 1)
        # (4,) acceleration under what acts now [rad/s^2], of a command for the estimate as it is
        self._expected: FloatArray | None = None
        self._law.reset(stance)

    def tick(self, reading: Reading) -> WalkerCommand:
        """Torques for a reading, one period after the last."""
        estimator = self.estimator
        if self._sent:
            estimator.predict(self._in_stance(*self._sent[0]), self._expected)
        event: PhaseEvent | None = None
        swing_touches = reading.contact[SWING[self.stance]]
        q, dq = measured_state(self.biped.stance_map, reading, self.stance)
        clearance = self.biped.swing_clearance(q) if swing_touches else inf
        if self.phases.landing(swing_touches, clearance):
            event = PhaseEvent.LANDING
            self.landings += 1
            estimator.land()
            self.stance = self.stance.other
            self._law.land(self.stance, State(estimator.q, estimator.dq))
            q, dq = measured_state(self.biped.stance_map, reading, self.stance)
        estimator.correct(q, dq)

        waiting = islice(self._sent, 1, None) if self._on_the_way else ()
        q, dq = estimator.ahead([self._in_stance(*sent) for sent in waiting])
        state = State(q, dq)
        if event is None:
            event = self.phases.turn(self._law.outwards(state))
        phase = self.phases.phase
        command = self._law.command(phase, event, state, estimator.error)
        u = command.u
        # of other sources the torques are cut to their limits, or held
        closed_form = command.source is CLOSED_FORM
        self._expected = command.ddq if closed_form and not self._on_the_way else None
        tau = self.biped.stance_map.torques_to_urdf(u, self.stance)
        if not self._sent:  # nothing else was on its way
            self._sent.extend([(self.stance, u)] * self._on_the_way)
        self._sent.append((self.stance, u))
        return WalkerCommand(tau, phase, self.stance, u, q, dq, command.y, command.p_fri_target, command.solved, event)

    def counters(self) -> dict[str, int]:
        """What happened so far."""
        return {
            "ticks": self.controller.ticks,
            "unsolved": self.controller.unsolved,
            "declined": self.controller.declined,
            "landings": self.landings,
            "early_landings": self.phases.early_landings,
            "late_landings": self.phases.late_landings,
            "scuffs": self.phases.scuffs,
        }

    def _in_stance(self, stance: Stance, u: FloatArray) -> FloatArray:
        """Torques (4,) that were sent on a foot, for the present stance foot [N m]."""
        return u if stance is self.stance else relabel(u)


def _phase_variable(
    biped: FrontalBiped, gait: AnyGait, over: str | None, stabiliser: Stabiliser | str | None, outputs: str
) -> str:
    """The phase variable: what was asked for, or what suits."""
    if over is not None and over not in PHASE_VARIABLES:
        raise SimulationError(f"no phase variable {over!r}; known: {', '.join(PHASE_VARIABLES)}")
    plain = stabiliser is None and outputs == "linearising"
    phases = [phase for step in steps_in_turn(gait) for phase in (step.rising, step.falling)]
    sways = plain and over != "ankle" and runs_one_way(biped, phases)
    if over == "sway" and not plain:
        raise SimulationError(
            "stabilisers and control Lyapunov functions act over the ankle's angle; leave them, or write over = 'ankle'"
        )
    if over == "sway" and not sways:
        raise SimulationError(
            f"{biped.name}: the centre of mass does not move outwards all along the rising phase of this gait, and back"
            " along the falling one; write over = 'ankle'"
        )
    if isinstance(gait, SidewaysGait) and not sways:
        raise SimulationError(
            "two steps in turn are followed over the sway alone, without a stabiliser or a control Lyapunov function,"
            " and the centre of mass must run one way along each phase; leave these, or walk it with period=None"
        )
    return "sway" if sways else "ankle"
