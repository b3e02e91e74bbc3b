"""The frontal plane of the robot in space: the paper's outputs and FRI target, the energy of the orbit kept.

The same three parts as in the planar `Walker`: virtual constraints that begin where the robot is (`QpController`), the
energy law that moves the FRI inside the sole at every tick, and, from step to step, an offset of the FRI while falling
that holds the energy half-way down. What the planar model leaves out, legs that swing forwards and an impact with every
joint free, comes back at every step and is taken off by the offset.
"""

from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.controller import SHIFT_ROOM, QpController
from frontal_biped.control.interface import PhaseEvent
from frontal_biped.control.settings import ControllerSettings
from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions
from frontal_biped.control.torques.linearisation import Targets
from frontal_biped.control.walker.energy_law import EnergyLaw, EnergySettings
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.virtual_constraints.phase import StepPhase

LEARNED = 0.2
"""Share of the sole, from the ankle to either end, that the learned offset may take [-]."""

DISTURBED = 0.12
"""Relative speed error half-way down from which on a step was disturbed, and is not learned from [-]."""


@dataclass(frozen=True)
class FrontalSettings:
    """How the frontal plane is kept.

    Attributes:
        energy: how the energy of the orbit is kept at every tick; None: not at all.
        learning: share of the energy error half-way down that the offset of the next step on that foot takes off.
        settle: time after a landing when the virtual constraints begin anew, from what is measured [s]; 0: never.
    """

    energy: EnergySettings | None = field(default_factory=EnergySettings)
    learning: float = 0.5
    settle: float = 0.03


class FrontalTargets(NamedTuple):
    """What the frontal plane asks for.

    Attributes:
        targets: of the paper's outputs and the FRI.
        y: (3,) output error [rad].
    """

    targets: Targets
    y: FloatArray


class FrontalLaw:
    """Targets of the frontal plane along a walk.

    Args:
        biped: the robot as it is believed to be.
        gait: what to walk.
        period: time between ticks [s].
        frequency: of the outputs' error dynamics [rad/s].
        settings: how the plane is kept.

    Attributes:
        controller: virtual constraints of both phases.
        offset: of the FRI target while falling, for either stance foot [m].
        mid_fall: relative speed error half-way down of the last step, NaN before the first [-].
    """

    def __init__(
        self, biped: FrontalBiped, gait: Gait, period: float, frequency: float, settings: FrontalSettings
    ) -> None:
        self.biped, self.settings, self._period = biped, settings, period
        limits = replace(ControllerSettings.for_gait(gait), frequency=frequency)
        alone = settings.energy is None
        stabiliser = ReanchoringTransitions(biped, gait, anticipate=alone, rejoin=alone)
        self.controller = QpController(biped, gait, limits, stabiliser)
        self._energy = EnergyLaw(biped, gait, period, settings.energy or EnergySettings())
        falling = gait.step(biped).falling
        ends = float(falling.beta[0]), float(falling.beta[-1])
        self._half_way = 0.5 * (ends[0] + ends[1])
        # an offset over the upper half of the fall takes this much energy off, per metre
        inertia = float(np.interp(self._half_way, falling.beta[::-1], falling.restricted.I_P[::-1]))
        self._energy_per_offset = 0.5 * abs(ends[1] - ends[0]) * biped.weight / inertia
        outer, inner = biped.sole
        self._room = SHIFT_ROOM * outer, SHIFT_ROOM * inner
        self.reset(Stance.LEFT)

    def reset(self, stance: Stance) -> None:
        """Start right after an impact."""
        self._energy.reset(stance)
        self.offset = dict.fromkeys(Stance, 0.0)
        self.mid_fall = float("nan")
        self._stance, self._begun = stance, False
        self._until_settled = np.inf
        self._fallen = True  # the first step is not learned from: it began where it was put

    def begin(self, phase: StepPhase, q: FloatArray, dq: FloatArray, landed: Stance | None = None) -> None:
        """A phase begins at q (4,) [rad], dq (4,) [rad/s]; with a landing, on which foot."""
        self.controller.begin(phase, q, dq)
        self._begun = True
        self._until_settled = np.inf
        if landed is not None:
            self._energy.land(landed)
            self._stance, self._fallen = landed, False
            self._until_settled = self.settings.settle or np.inf

    def at(
        self, phase: StepPhase, q: FloatArray, dq: FloatArray, event: PhaseEvent | None, unexplained: FloatArray
    ) -> FrontalTargets:
        """Targets at a state.

        Args:
            phase: rising or falling.
            q: (4,) [rad].
            dq: (4,) [rad/s].
            event: a reversal or a turn outwards that was noticed here; a landing is told to `begin`.
            unexplained: (4,) acceleration that the model does not explain [rad/s^2].
        """
        self._until_settled -= self._period
        turned = event is PhaseEvent.REVERSAL or event is PhaseEvent.TURNED_OUTWARDS
        if turned or not self._begun or (self._until_settled <= 0.0 and phase is StepPhase.RISING):
            self.begin(phase, q, dq)
        shift = 0.0
        if self.settings.energy is not None:
            shift = self._energy.fri_shift(phase, q, float(dq[0]), unexplained)
        if phase is StepPhase.FALLING:
            self._learn(q, dq)
            shift += self.offset[self._stance]
        targets, y, _ = self.controller.targets(phase, State(q, dq))
        low, high = self._room
        return FrontalTargets(targets._replace(p_fri=min(max(targets.p_fri + shift, low), high)), y)

    def _learn(self, q: FloatArray, dq: FloatArray) -> None:
        if self._fallen or q[0] > self._half_way:
            return
        self._fallen = True
        error = self._energy.error(StepPhase.FALLING, float(q[0]), float(dq[0]))
        orbit = 0.5 * float(dq[0]) ** 2 - error
        self.mid_fall = abs(float(dq[0])) / float(np.sqrt(2.0 * orbit)) - 1.0 if orbit > 0.0 else float("nan")
        if not abs(self.mid_fall) < DISTURBED:
            return
        learned = self.offset[self._stance] + self.settings.learning * error / self._energy_per_offset
        outer, inner = self.biped.sole
        self.offset[self._stance] = float(np.clip(learned, LEARNED * outer, LEARNED * inner))
