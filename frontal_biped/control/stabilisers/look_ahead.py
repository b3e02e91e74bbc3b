r"""Re-anchoring that looks ahead: of the ways to re-anchor a phase, the one whose step the contact can carry.

`ReanchoringTransitions` re-anchors to any state, but far from the gait what it asks for overloads the robot: the joints
brake within 0.1 rad where a reversal is late, I_P nearly vanishes where an early falling phase must rejoin its path.
The same end poses can be reached more gently:

- *the rising phase is stretched*, so that its last pose is reached later in beta. A fast robot, which reverses late,
  then has less to brake; the least stretch that keeps the limits is taken, for without any the map is the paper's
  affine rho. A slow robot reverses before the end of its phase; stretching makes it reverse later, in an earlier pose,
  and gains it the speed that rho promises.
- *the falling phase is rescaled* to the actual reversal as a whole, its inner columns moved along with its start,
  where rejoining its planned path would take I_P away.

Which of them is taken is decided by the closed form of the step to come: every contact margin, and the next
post-impact speed beside the one of rho. No ankle torque is spent on the energy error, and the landing is always as
planned: this is re-anchoring alone.

**Looked up.** To compute this takes tens of milliseconds a step, which a simulation waits for and a robot cannot. After
a landing as planned the choice depends on the speed alone; `tabulation` asks for every speed beforehand, and the table
is kept with the gait. With it, what is chosen after any landing is what is chosen after the planned one at that speed;
the phases are still anchored to the pose that there is. Where a landing is off its pose the computed choice may be
another: under 1 kHz control, up to 0.2 mrad off, it is a neighbouring stretch, or another one near the gait, where
phases of equal merit are told apart by the fourth digit of the next speed.
"""

import hashlib
import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from frontal_biped.control.stabilisers.transitions import AS_PLANNED, REJOINS, ReanchoringTransitions
from frontal_biped.exceptions import ReversalError
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.look_ahead_table import Choice, Descent, LookAheadTable, Way
from frontal_biped.gait.margins import ContactMargins, Margin
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.anchoring import anchored_falling, rescaled_falling
from frontal_biped.virtual_constraints.contract import RisingConstraints, VirtualConstraints
from frontal_biped.virtual_constraints.piecewise import ContinuedPhase
from frontal_biped.zero_dynamics.energy import PhaseEnergy, phase_energy
from frontal_biped.zero_dynamics.half_steps import ConstrainedState, falling_energy, land_on_constraints, rising_energy

STRETCHES = (0.0, 0.25, 0.5, 1.0, 2.0, 4.0)
"""Stretches tried, relative to the range of the rising phase."""

HALVINGS = 3
"""Bisections between two stretches."""

RESERVE = 0.05
"""Margin kept of every limit, or half of the gait's own where that is less [-]."""

NEAR = 0.003
"""Relative speed error up to which a landing is re-anchored without looking ahead; 1 kHz control leaves this much."""

CLOSE = 0.05
"""Error of the next speed, relative to this one's, that needs no better phase."""

REJOINING = 0.03
"""Relative speed error beyond which an early falling phase does not try to rejoin its planned path."""

METHOD = 1
"""Number of the method, to be raised with every change of what is answered that the numbers above do not show."""

SOLE_RESERVE = 0.006
"""Distance from the end of the sole at which the FRI target of a stretched phase's continuation stops [m]."""


@dataclass(frozen=True)
class Outlook:
    """What a phase leads to.

    Attributes:
        room: least margin beyond the reserve, over the phases that are known [-].
        miss: next post-impact speed minus that of rho, relative to the gait's [-].
    """

    room: float
    miss: float

    @property
    def rank(self) -> tuple[float, float]:
        """Larger is better: limits first, then the speed."""
        return min(self.room, 0.0), -abs(self.miss)

    @property
    def enough(self) -> bool:
        """Within the limits, and at least as fast as rho."""
        return self.room >= 0.0 and self.miss >= 0.0


NOWHERE = Outlook(-np.inf, -np.inf)


class Foreseen(NamedTuple):
    """A step that has not been walked yet.

    Attributes:
        choice: the answers.
        reversal: where it reverses [rad].
        keeps_limits: are all limits kept?
    """

    choice: Choice
    reversal: float
    keeps_limits: bool


def made_for(biped: FrontalBiped, gait: Gait) -> str:
    """Digest of all that the answers depend on: robot, gait, and the numbers of the method."""
    phases = [
        [phase.beta_start, phase.beta_end, phase.joint_bezier.tolist(), phase.fri_bezier.tolist()]
        for phase in (gait.rising, gait.falling)
    ]
    method = [STRETCHES, HALVINGS, RESERVE, NEAR, CLOSE, REJOINING, SOLE_RESERVE, REJOINS, METHOD]
    numbers = [biped.fingerprint, phases, asdict(gait.orbit), gait.specification.as_dict(), method]
    return hashlib.sha256(json.dumps(numbers, sort_keys=True).encode()).hexdigest()


@dataclass(frozen=True)
class LookAheadTransitions:
    """Reversal-adaptive transitions within the limits of the contact: the stabiliser "adaptive", default of `simulate`.

    Attributes:
        biped: the robot.
        gait: the gait.
        look_up: answer from the table that is kept with the gait, if there is one? Otherwise, and where the table does
            not know, every answer is computed; it takes tens of milliseconds.
    """

    biped: FrontalBiped
    gait: Gait
    look_up: bool = True

    name = "adaptive"

    def __post_init__(self) -> None:
        if self._table is not None:
            self.plain.planned_rising  # noqa: B018  takes 0.1 s, which the first landing must not wait for

    @cached_property
    def plain(self) -> ReanchoringTransitions:
        """Re-anchoring as it comes."""
        return ReanchoringTransitions(self.biped, self.gait, anticipate=False)

    # ------------------------------------------------------------------ what a stabiliser answers
    def rising(self, landed: ConstrainedState) -> ContinuedPhase:
        """The rising phase anchored to the state after the impact, stretched as far as the step to come asks for."""
        phase = self.plain.rising(landed)
        known = None if self._table is None else self._table.stretch(self._ratio(landed.dbeta))
        return self._longer(phase, self._stretch(phase, landed.dbeta) if known is None else known)

    def falling(self, rising: RisingConstraints, reversal: float) -> VirtualConstraints:
        """The falling phase from the actual reversal."""
        known = None if self._table is None else self._table.descent(self._stretch_of(rising), reversal)
        if known is None:
            seen = self._descents.get((rising.beta_end, reversal))
            return (seen or self._falling(rising, reversal, self._speed(rising, reversal)))[0]
        return self._descended(known, rising, reversal)

    @cached_property
    def _table(self) -> LookAheadTable | None:
        """The gait's, if it was made for this robot and gait, by this method."""
        table = self.gait.look_ahead if self.look_up else None
        return table if table is not None and table.made_for == made_for(self.biped, self.gait) else None

    def foreseen(self, ratio: float) -> Foreseen | None:
        """The step after a landing as planned at a speed, relative to the gait's; None: the robot tips over."""
        dbeta = ratio * self.gait.orbit.beta_dot_after_impact
        planned = self.plain.planned_rising
        stretch = self._stretch(planned, dbeta)
        rising = self._longer(planned, stretch)
        try:
            reversal = self._energy(rising, dbeta).reversal(dbeta)
        except ReversalError:
            return None
        falling, way, _ = self._descents.get((rising.beta_end, reversal)) or self._falling(rising, reversal, dbeta)
        early = way is Way.ANCHORED and reversal < rising.beta_end
        rejoin = REJOINS.index(self.plain.rejoin_of(rising, reversal)) if early else None
        room = min(
            self._room(self.limits.rising(self._energy(rising, dbeta), dbeta, reversal)),
            self._falling_outlook(falling, reversal, dbeta).room,
        )
        return Foreseen(Choice(stretch, Descent(way, rejoin)), reversal, room > -RESERVE)

    # ------------------------------------------------------------------ rising
    def _ratio(self, dbeta: float) -> float:
        return dbeta / self.gait.orbit.beta_dot_after_impact

    def _stretch(self, phase: ContinuedPhase, dbeta: float) -> float:
        """By how much to stretch a phase begun with dbeta [rad/s], relative to the planned range."""
        self._descents.clear()
        ratio = self._ratio(dbeta)
        if abs(ratio - 1.0) < NEAR or dbeta <= 0.0:
            return 0.0
        plain = self._rising_outlook(phase, dbeta)
        if plain.room >= 0.0 and abs(plain.miss) <= CLOSE * abs(ratio - 1.0):
            return 0.0
        return self._best_stretch(phase, dbeta, plain)

    def _best_stretch(self, phase: ContinuedPhase, dbeta: float, plain: Outlook) -> float:
        """Of the stretches, the least that keeps the limits and brings the speed of rho, or the best there is."""

        def tried(stretch: float) -> tuple[float, Outlook]:
            return stretch, self._rising_outlook(self._longer(phase, stretch), dbeta)

        fast = dbeta > self.gait.orbit.beta_dot_after_impact
        found = [(0.0, plain)]
        for stretch in STRETCHES[1:]:
            found.append(tried(stretch))
            if found[-1][1].enough:
                break  # the next speed grows with the stretch
        best = max(range(len(found)), key=lambda i: found[i][1].rank)
        # it would be just enough somewhere between two of these
        pair = found[best - 1 : best + 1] if found[best][1].miss >= 0.0 else found[best : best + 2]
        if len(pair) == 2 and found[best][1].room >= 0.0:
            low, high = pair[0][0], pair[1][0]
            for _ in range(HALVINGS):
                found.append(tried(0.5 * (low + high)))
                middle, outlook = found[-1]
                # too long a stretch overloads a slow robot, too short a one a fast robot
                too_long = outlook.enough or (outlook.room < 0.0 and not fast)
                low, high = (low, middle) if too_long else (middle, high)
        return max(found, key=lambda item: item[1].rank)[0]

    def _longer(self, phase: ContinuedPhase, stretch: float) -> ContinuedPhase:
        """The phase with its end moved outwards; past it the FRI target may use the sole up to `SOLE_RESERVE`."""
        if stretch == 0.0:
            return phase
        if phase is self.plain.planned_rising:
            if stretch not in self._planned_longer:
                self._planned_longer[stretch] = self._lengthened(phase, stretch)
            return self._planned_longer[stretch]
        return self._lengthened(phase, stretch)

    def planned(self, stretch: float) -> ContinuedPhase:
        """The rising phase after a landing as planned, stretched relative to its range [-]."""
        return self._longer(self.plain.planned_rising, stretch)

    @cached_property
    def _planned_longer(self) -> dict[float, ContinuedPhase]:
        """The phase of a landing as planned by its stretch: some dozen, met at every such landing."""
        return {}

    def _stretch_of(self, rising: RisingConstraints) -> float:
        """By how much a phase was stretched: wherever it began, it keeps its end."""
        return (rising.beta_end - self.gait.rising.beta_end) / abs(self.gait.rising.range)

    def _lengthened(self, phase: ContinuedPhase, stretch: float) -> ContinuedPhase:
        longer = phase.stretched(phase.beta_end + stretch * abs(self.gait.rising.range))
        at = longer.motion(np.array([longer.beta_end]))
        slope, p_fri, (outer, inner) = float(at.dp_fri[0]), float(at.p_fri[0]), self.biped.sole
        room = (inner - p_fri if slope > 0.0 else p_fri - outer) - SOLE_RESERVE
        return replace(longer, fri_taper=max(room, 1e-4) / max(abs(slope), 1e-9))

    def _rising_outlook(self, phase: ContinuedPhase, dbeta: float) -> Outlook:
        try:
            energy = self._energy(phase, dbeta)
            reversal = energy.reversal(dbeta)
        except ReversalError:
            return NOWHERE
        room = self._room(self.limits.rising(energy, dbeta, reversal))
        if room < 0.0:  # no falling phase can mend that
            return Outlook(room, -np.inf)
        descent = self._descents[phase.beta_end, reversal] = self._falling(phase, reversal, dbeta)
        outlook = descent[2]
        return Outlook(min(room, outlook.room), outlook.miss)

    def _energy(self, phase: ContinuedPhase, dbeta: float) -> PhaseEnergy:
        """Of a rising phase as far as a speed takes it [rad/s]; of the phases of a landing as planned found once."""
        if not any(phase is planned for planned in (self.plain.planned_rising, *self._planned_longer.values())):
            return rising_energy(self.biped, phase, dbeta)
        if phase.beta_end not in self._planned_energies:
            self._planned_energies[phase.beta_end] = rising_energy(self.biped, phase)
        return self._planned_energies[phase.beta_end]

    @cached_property
    def _planned_energies(self) -> dict[float, PhaseEnergy]:
        """By the end of the phase [rad]."""
        return {}

    # ------------------------------------------------------------------ falling
    @cached_property
    def _descents(self) -> dict[tuple[float, float], tuple[VirtualConstraints, Way, Outlook]]:
        """What `_falling` has answered in this step, by the end of the rising phase and the reversal [rad]."""
        return {}

    def _falling(
        self, rising: RisingConstraints, reversal: float, dbeta: float
    ) -> tuple[VirtualConstraints, Way, Outlook]:
        """The first falling phase that keeps the limits with about the speed of rho, or the best there is."""
        best: tuple[VirtualConstraints, Way, Outlook] | None = None
        error = abs(self._ratio(dbeta) - 1.0)
        if error < NEAR:
            return self.plain.falling(rising, reversal), Way.ANCHORED, NOWHERE
        for way in self._ways(rising, reversal, error):
            phase = self._descended(Descent(way), rising, reversal)
            outlook = self._falling_outlook(phase, reversal, dbeta)
            if outlook.room >= 0.0 and abs(outlook.miss) <= CLOSE * error:
                return phase, way, outlook
            if best is None or outlook.rank > best[2].rank:
                best = (phase, way, outlook)
        assert best is not None
        return best

    def _ways(self, rising: RisingConstraints, reversal: float, error: float) -> Iterator[Way]:
        late = reversal >= rising.beta_end
        if late or error < REJOINING:
            yield Way.ANCHORED
        if late and abs(rising.beta_end - self.gait.falling.beta_start) > AS_PLANNED:
            yield Way.RETRACED
        yield Way.RESCALED

    def _descended(self, descent: Descent, rising: RisingConstraints, reversal: float) -> VirtualConstraints:
        planned = self.gait.falling
        if descent.way is Way.RESCALED:
            return rescaled_falling(planned, rising, reversal)
        if descent.way is Way.RETRACED:
            return anchored_falling(rescaled_falling(planned, rising, rising.beta_end), rising, reversal)
        if descent.rejoin is not None:
            return self.plain.rejoining(rising, reversal, REJOINS[descent.rejoin])
        return self.plain.falling(rising, reversal)

    def _falling_outlook(self, phase: VirtualConstraints, reversal: float, dbeta: float) -> Outlook:
        try:
            energy = falling_energy(self.biped, phase, reversal)
            landed = land_on_constraints(self.biped, energy)
            room = self._room(self.limits.falling(energy, reversal))
        except ReversalError:
            return NOWHERE
        speed = self.gait.orbit.beta_dot_after_impact
        wanted = 1.0 + self.gait.orbit.multiplier * ((dbeta / speed) ** 2 - 1.0)
        return Outlook(room, landed.dbeta / speed - float(np.sqrt(max(wanted, 0.0))))

    def _speed(self, rising: RisingConstraints, reversal: float) -> float:
        """The speed after the landing with which the rising phase reverses there [rad/s]; the gait's if none does."""
        try:
            energy = phase_energy(self.biped, rising, rising.beta_start, reversal, rising.breaks)
            return energy.speed(reversal)
        except ReversalError:
            return self.gait.orbit.beta_dot_after_impact

    # ------------------------------------------------------------------ limits
    @cached_property
    def limits(self) -> ContactMargins:
        """Those of the gait's specification."""
        return ContactMargins(self.biped, self.gait)

    @cached_property
    def required(self) -> dict[str, float]:
        """By limit, the margin to keep: the reserve, or half of what the gait itself keeps."""
        gait = self.gait
        energy: PhaseEnergy = rising_energy(self.biped, self.plain.planned_rising)
        own = [
            *self.limits.rising(energy, gait.orbit.beta_dot_after_impact, gait.beta_reversal),
            *self.limits.falling(falling_energy(self.biped, gait.falling, gait.beta_reversal), gait.beta_reversal),
        ]
        return {margin.name: min(RESERVE, 0.5 * margin.value) for margin in own}

    def _room(self, margins: list[Margin]) -> float:
        """Least margin beyond what is to be kept [-]."""
        room = min(margin.value - self.required[margin.name] for margin in margins)
        return room if np.isfinite(room) else -np.inf
