r"""Step-to-step law: the distance between the feet, and with it the final pose, chosen anew at each reversal.

The final poses are those with both feet flat from which the next step starts at the gait's beta_r+, so that its rising
phase keeps its range: one for each width. A wider step falls further in beta and gains energy.

- *dead-beat*: the width for which the next step, whose rising phase is anchored to that landing, reverses exactly where
  it was planned to. From there the step is the gait's, so the error is gone after one step if the width is allowed.
- *LQR*: the map from reversal to next reversal linearised at the gait, x+ = a x + b u with x the reversal's error and u
  the width's; u = -K x minimises sum x^2 + (r u)^2, the scalar Riccati equation solved in closed form.
"""

from dataclasses import dataclass, field
from enum import Enum
from functools import cache, cached_property
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from frontal_biped.arrays import FloatArray
from frontal_biped.control.stabilisers.ankle_law import AnkleLaw
from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions
from frontal_biped.exceptions import ReversalError, UnreachablePoseError
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import relabel
from frontal_biped.virtual_constraints.contract import RisingConstraints, VirtualConstraints
from frontal_biped.virtual_constraints.invariance import double_support_pose
from frontal_biped.zero_dynamics.energy import PhaseEnergy
from frontal_biped.zero_dynamics.half_steps import (
    SURPLUS_ACCURACY,
    ConstrainedState,
    energy_surplus,
    falling_energy,
    land_on_constraints,
    rising_energy,
)

NARROWEST, WIDEST = 0.6, 1.5
"""Widths the law may choose, relative to the gait's [-]."""

OFFSETS = (0.01, 0.02, 0.04, 0.08, 0.15, 0.25, 0.4, 0.6)
"""Changes of width tried to bracket the dead-beat one, relative to the gait's width."""

WIDTH_ACCURACY = 1e-10
"""[m]"""


class StepRule(Enum):
    """How the width is chosen."""

    DEAD_BEAT = "dead-beat"
    LQR = "lqr"


@dataclass(frozen=True)
class StepLaw:
    """Chooses the width of each step at its reversal.

    Attributes:
        biped: the robot.
        gait: the gait.
        rule: dead-beat or LQR.
        ankle: shifts the FRI as well: in the rising phase first, in the falling phase where the width is at its limit.
        narrowest: smallest width [m].
        widest: largest width [m].
        effort: r of the LQR, cost of 1 m of width over that of 1 rad of reversal [rad/m].
    """

    biped: FrontalBiped
    gait: Gait
    rule: StepRule = field(kw_only=True, default=StepRule.DEAD_BEAT)
    ankle: AnkleLaw | None = field(kw_only=True, default=None)
    narrowest: float = field(kw_only=True, default=0.0)
    widest: float = field(kw_only=True, default=0.0)
    effort: float = field(kw_only=True, default=0.05)

    def __post_init__(self) -> None:
        if self.narrowest <= 0.0:
            object.__setattr__(self, "narrowest", NARROWEST * self.gait.step_width)
        if self.widest <= 0.0:
            object.__setattr__(self, "widest", WIDEST * self.gait.step_width)

    @property
    def name(self) -> str:
        """For reports."""
        return f"step ({self.rule.value})" if self.ankle is None else f"ankle + step ({self.rule.value})"

    @cached_property
    def _reanchored(self) -> ReanchoringTransitions:
        return ReanchoringTransitions(self.biped, self.gait)

    @cached_property
    def _unstretched(self) -> ReanchoringTransitions:
        return ReanchoringTransitions(self.biped, self.gait, anticipate=False)

    def rising(self, landed: ConstrainedState) -> RisingConstraints:
        """The anchored rising phase, shifted by the ankle law if there is one."""
        return (self.ankle or self._reanchored).rising(landed)

    def falling(self, rising: RisingConstraints, reversal: float) -> VirtualConstraints:
        """The falling phase to the width that the rule asks for."""
        rising = rising.unshifted()
        if self.rule is StepRule.LQR:
            planned = self.gait.beta_reversal
            width = self.gait.step_width - self.gain * (reversal - planned)
            return self.to_width(rising, reversal, float(np.clip(width, self.narrowest, self.widest)))
        phase, error = self._dead_beat(rising, reversal)
        if self.ankle is None or error == 0.0 or not np.isfinite(error):
            return phase

        energy = falling_energy(self.biped, phase, reversal)

        def left(shift: float) -> float:
            try:
                return -self._surplus_of(energy.shifted(shift))
            except (ReversalError, UnreachablePoseError):
                return -error

        return phase.shifted(self.ankle.falling_shift(phase, left, reversal))

    # ------------------------------------------------------------------ widths
    def to_width(self, rising: RisingConstraints, reversal: float, width: float) -> VirtualConstraints:
        """The falling phase from a reversal to a landing of the given width [m].

        Raises:
            UnreachablePoseError: the feet cannot stand so far apart.
        """
        if abs(width - self.gait.step_width) <= WIDTH_ACCURACY:
            return self._reanchored.falling(rising, reversal)
        pose = self.final_pose(width)
        return self._reanchored.falling_to(rising, reversal, float(pose[0]), pose[1:])

    def final_pose(self, width: float) -> FloatArray:
        """(4,) pose of a landing of the given width, from which the next step starts at the gait's beta_r+ [rad].

        It is the pose in which the next step starts, seen from the foot that still stands.

        Raises:
            UnreachablePoseError: the feet cannot stand so far apart.
        """
        next_start = self.gait.falling.joint_bezier.item(2, -1)  # the swing ankle that becomes the stance ankle
        return relabel(double_support_pose(self.biped, next_start, width))

    # ------------------------------------------------------------------ rules
    def surplus(self, falling: VirtualConstraints, reversal: float) -> float:
        """Energy after the landing of a falling phase beyond what rising to the planned reversal takes.

        In kg^2 m^4/s^2; zero where the next step reverses as planned.

        Raises:
            ReversalError: the robot stops before the landing.
        """
        return self._surplus_of(falling_energy(self.biped, falling, reversal))

    def _surplus_of(self, falling: PhaseEnergy) -> float:
        landed = land_on_constraints(self.biped, falling)
        phase = self._unstretched.rising(landed)
        return energy_surplus(self.biped, phase, landed.dbeta)

    def _dead_beat(self, rising: RisingConstraints, reversal: float) -> tuple[VirtualConstraints, float]:
        """The falling phase, and the surplus left where no allowed width makes it vanish."""

        @cache
        def falling(width: float) -> VirtualConstraints:
            return self.to_width(rising, reversal, width)

        @cache
        def error(width: float) -> float:
            try:
                return self.surplus(falling(width), reversal)
            except (ReversalError, UnreachablePoseError, ValueError):
                return float("nan")

        planned = self.gait.step_width
        worse = error(planned)
        if abs(worse) <= SURPLUS_ACCURACY:
            return falling(planned), 0.0
        offsets = np.array([0.0, *(sign * offset for offset in OFFSETS for sign in (1.0, -1.0))])
        widths = np.unique(np.clip(planned * (1.0 + offsets), self.narrowest, self.widest)).tolist()
        # outwards from the gait's width, until two neighbours differ in sign; a wider step gains energy
        order = sorted(widths, key=lambda width: ((width - planned) * worse > 0.0, abs(width - planned)))
        values: dict[float, float] = {}
        for width in order:
            values[width] = error(width)
            known = sorted(values)
            place = known.index(width)
            for a, b in pairwise(known[max(place - 1, 0) : place + 2]):
                if values[a] * values[b] <= 0.0:
                    try:
                        width = float(brentq(error, a, b, xtol=WIDTH_ACCURACY))
                    except ValueError:  # not defined somewhere between
                        continue
                    return falling(width), 0.0
        finite = {w: e for w, e in values.items() if np.isfinite(e)}
        if not finite:
            return falling(planned), float("nan")
        best = min(finite, key=lambda w: abs(finite[w]))
        return falling(best), finite[best]

    @cached_property
    def linear_map(self) -> tuple[float, float]:
        """a and b of x+ = a x + b u at the gait: reversal error [rad] and width error [m]; central differences."""
        rising, planned, width = self._reanchored.planned_rising, self.gait.beta_reversal, self.gait.step_width

        def following(reversal: float, chosen: float) -> float:
            falling = self.to_width(rising, reversal, chosen)
            landed = land_on_constraints(self.biped, falling_energy(self.biped, falling, reversal))
            return rising_energy(self.biped, self._unstretched.rising(landed)).reversal(landed.dbeta)

        h = 1e-3 * self.gait.rising.range
        a = (following(planned + h, width) - following(planned - h, width)) / (2.0 * h)
        b = (following(planned, width + h) - following(planned, width - h)) / (2.0 * h)
        return float(a), float(b)

    @cached_property
    def gain(self) -> float:
        """K of the LQR [m/rad]."""
        a, b = self.linear_map
        r = self.effort**2
        # P = 1 + a^2 P - (a b P)^2 / (r + b^2 P), the positive root of b^2 P^2 + (r (1 - a^2) - b^2) P - r = 0
        linear = r * (1.0 - a**2) - b**2
        P = (-linear + np.sqrt(linear**2 + 4.0 * b**2 * r)) / (2.0 * b**2)
        return float(a * b * P / (r + b**2 * P))
