"""Ankle law: the FRI target moves inside the sole, once a phase, by what the energy error asks for.

After the impact the shift is chosen so that the robot reverses where it was planned to; at the reversal, so that the
next post-impact speed is the gait's. Shift and FRI target together stay inside the sole less a margin, and what the
sole cannot give is left to the transitions below. A shift is constant over the phase, so the closed form of the zero
dynamics holds with it. At the reversal the FRI target steps from one shift to the other, and the ankle torque with it;
the robot is at rest there, and its energy takes no notice.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, cached_property

import numpy as np
from scipy.optimize import brentq

from frontal_biped.arrays import FloatArray
from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions, Stabiliser
from frontal_biped.exceptions import ReversalError
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.contract import RisingConstraints, VirtualConstraints
from frontal_biped.zero_dynamics.energy import PhaseEnergy, phase_energy
from frontal_biped.zero_dynamics.half_steps import (
    BLOCKED,
    SURPLUS_ACCURACY,
    ConstrainedState,
    Stretching,
    falling_energy,
    landing_at_end,
    speed_at_end,
    surplus_at_end,
)

SOLE_MARGIN = 0.004
"""Distance the shifted FRI target keeps from the ends of the sole [m]."""

SHIFT_ACCURACY = 1e-9
"""[m]"""

ROOM_LOOKS = 33
"""Points of a phase, evenly spaced in beta, at which the FRI target's room in the sole is looked at."""


@dataclass(frozen=True)
class AnkleLaw:
    """Shifts the FRI target of the phases another stabiliser answers with.

    Attributes:
        biped: the robot.
        gait: the gait.
        inner: whose phases are shifted; default: `ReanchoringTransitions` that leaves the stretching to this law.
        margin: distance from the ends of the sole [m].
        in_falling: act in the falling phase as well?
    """

    biped: FrontalBiped
    gait: Gait
    inner: Stabiliser = field(kw_only=True, default=None)  # type: ignore[assignment]
    margin: float = field(kw_only=True, default=SOLE_MARGIN)
    in_falling: bool = field(kw_only=True, default=True)

    def __post_init__(self) -> None:
        if self.inner is None:
            object.__setattr__(self, "inner", ReanchoringTransitions(self.biped, self.gait, anticipate=False))

    @property
    def name(self) -> str:
        """For reports."""
        return "ankle" if self.inner.name == "re-anchored" else f"ankle + {self.inner.name}"

    def rising(self, landed: ConstrainedState) -> RisingConstraints:
        """The inner phase, shifted so that the robot reverses at its planned end.

        A robot too fast for the sole gets a stretched phase: the same poses, the last one reached where it reverses.
        """
        phase = self.inner.rising(landed)
        known = self._known(phase)
        try:
            energy = known.energy
        except ReversalError:
            return phase

        def surplus(shift: float) -> float:
            try:
                return surplus_at_end(energy.shifted(shift), landed.dbeta)
            except ReversalError:
                return BLOCKED

        shift = self.best_shift(phase, surplus, phase.beta_start, phase.beta_end)
        if surplus(shift) <= SURPLUS_ACCURACY:
            return phase.shifted(shift)
        return known.shifted(shift).to_reversal(landed.dbeta)

    def _known(self, phase: RisingConstraints) -> "_ToBeShifted":
        """What is known of a rising phase; of one is remembered, for landings as planned are answered with the same."""
        if not self._met or self._met[0].phase is not phase:
            self._met[:] = [_ToBeShifted(self.biped, phase)]
        return self._met[0]

    @cached_property
    def _met(self) -> "list[_ToBeShifted]":
        return []

    def falling(self, rising: RisingConstraints, reversal: float) -> VirtualConstraints:
        """The inner phase, shifted so that the next post-impact speed is the gait's."""
        phase = self.inner.falling(rising.unshifted(), reversal)
        if not self.in_falling:
            return phase
        target = self.gait.orbit.beta_dot_after_impact
        energy = falling_energy(self.biped, phase, reversal)
        landing = landing_at_end(self.biped, energy)  # of the path alone, whatever the FRI

        def missing(shift: float) -> float:
            try:
                return target - landing.speed_ratio * speed_at_end(energy.shifted(shift))
            except ReversalError:
                return target  # it does not fall: far too slow

        return phase.shifted(self.falling_shift(phase, missing, reversal))

    def falling_shift(self, phase: VirtualConstraints, error: Callable[[float], float], reversal: float) -> float:
        """`best_shift` of a falling phase; the robot falls from rest only while it leans inwards of its FRI [m]."""
        at = phase.motion(np.array([reversal]))
        leaning = float(self.biped.com(at.q[0])[0] - at.p_fri[0])
        return self.best_shift(phase, error, reversal, phase.beta_end, most=leaning - self.margin)

    def best_shift(
        self, phase: VirtualConstraints, error: Callable[[float], float], start: float, end: float, most: float = np.inf
    ) -> float:
        """The shift at which an error vanishes, or the end of the sole that comes nearest, at most ``most`` [m]."""
        error = cache(error)  # a root finder asks for the ends again
        low, high = self.room(phase, start, end)
        high = max(min(high, most), 0.0)
        if low >= high:
            return 0.0
        if abs(error(0.0)) < 1e-12:
            return 0.0
        at_low, at_high = error(low), error(high)
        if at_low * at_high > 0.0:
            return low if abs(at_low) < abs(at_high) else high
        return float(brentq(error, low, high, xtol=SHIFT_ACCURACY))

    def room(self, phase: VirtualConstraints, start: float, end: float) -> tuple[float, float]:
        """Shifts that keep the FRI target inside the sole less the margin; 0 is always allowed [m]."""
        p: FloatArray = phase.motion(np.linspace(start, end, ROOM_LOOKS)).p_fri
        outer, inner = self.biped.sole
        low, high = outer + self.margin - float(p.min()), inner - self.margin - float(p.max())
        return min(low, 0.0), max(high, 0.0)


@dataclass(frozen=True)
class _ToBeShifted:
    """A rising phase, and what is found once and serves every speed with which it begins."""

    biped: FrontalBiped
    phase: RisingConstraints

    @cached_property
    def energy(self) -> PhaseEnergy:
        """Of the phase as it is, up to its planned end."""
        return phase_energy(self.biped, self.phase, self.phase.beta_start, self.phase.beta_end)

    def shifted(self, shift: float) -> Stretching[RisingConstraints]:
        """The phase with its FRI target moved [m], to be stretched: the ends of the sole are met at many speeds."""
        if shift not in self._shifted:
            self._shifted[shift] = Stretching(self.biped, self.phase.shifted(shift))
        return self._shifted[shift]

    @cached_property
    def _shifted(self) -> dict[float, Stretching[RisingConstraints]]:
        return {}
