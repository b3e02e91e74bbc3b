"""The restricted return map with a variable reversal point, in closed form, under any stabiliser.

Anchored transitions keep the state on Z, so a step is one number, the speed after the impact: the energy R of
`phase_energy` says where it reverses, the falling phase that the stabiliser answers with gives the energy at the
impact, and the impact is linear in the speed. Every contact constraint is evaluated along the step.
"""

from dataclasses import dataclass, replace

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.stabilisers.transitions import Stabiliser
from frontal_biped.exceptions import ReversalError
from frontal_biped.files.counted import counted
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.margins import ContactMargins, Margin
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import relabel
from frontal_biped.virtual_constraints.contract import RisingConstraints, VirtualConstraints
from frontal_biped.zero_dynamics.energy import PhaseEnergy
from frontal_biped.zero_dynamics.half_steps import ConstrainedState, falling_energy, land_on_constraints, rising_energy

RETURNED = 0.01
"""Relative speed error that counts as returned."""

SAME_POSE = 1e-6
"""[rad] a landing this near to the planned one is followed by the map of the speed alone."""

PATIENCE = 3
"""Steps on end by which the speed may go away from the gait's, on one side of it."""

STEPS = 60
"""Steps after which a slow return is given up."""

KEPT = 64
"""Rising phases that are remembered at most."""

FIRST_PROBE, WIDENING = 0.02, 1.4
"""Search of a basin: relative speed error tried first on either side, and the factor from one to the next."""

FINEST, FINE = 0.004, 0.05
"""Accuracy of an edge of a basin: relative speed error, or share of it where that is more."""


@dataclass(frozen=True)
class RestrictedStep:
    """One step of the restricted map.

    Attributes:
        start: where it began.
        reversal: where it reversed [rad].
        rising: virtual constraints of the rising phase.
        falling: virtual constraints of the falling phase.
        landed: where the next step begins.
        width: distance between the ankles at the landing [m].
        margins: room to every contact constraint, the least over the step.
    """

    start: ConstrainedState
    reversal: float
    rising: RisingConstraints
    falling: VirtualConstraints
    landed: ConstrainedState
    width: float
    margins: tuple[Margin, ...]

    @property
    def tightest(self) -> Margin:
        """The limit with the least room."""
        return min(self.margins, key=lambda margin: margin.value if np.isfinite(margin.value) else -np.inf)


@dataclass(frozen=True)
class Return:
    """What becomes of a post-impact speed.

    Attributes:
        returned: within `RETURNED` of the gait, with every limit kept on the way.
        speeds: post-impact speeds relative to the gait's, the start first [-].
        limited_by: the first limit broken, or why a step does not exist; empty where it returned.
    """

    returned: bool
    speeds: tuple[float, ...]
    limited_by: str


class RestrictedMap:
    """Steps of the hybrid zero dynamics under a stabiliser.

    Args:
        biped: the robot.
        gait: the gait.
        stabiliser: chooses the phases.
    """

    def __init__(self, biped: FrontalBiped, gait: Gait, stabiliser: Stabiliser) -> None:
        self.biped, self.gait, self.stabiliser = biped, gait, stabiliser
        self.limits = ContactMargins(biped, gait)
        self._energies: dict[int, tuple[RisingConstraints, PhaseEnergy | None]] = {}

    def start(self, speed_ratio: float = 1.0) -> ConstrainedState:
        """After the impact of the gait, its speed multiplied."""
        rising = self.gait.rising
        at = rising.motion(np.array([rising.beta_start]))
        return ConstrainedState(at.q[0], at.dq[0, 1:], speed_ratio * self.gait.orbit.beta_dot_after_impact)

    def step(self, start: ConstrainedState) -> RestrictedStep:
        """One step.

        Raises:
            ReversalError: there is none; the message says why.
        """
        rising = self.stabiliser.rising(start)
        up = self._energy(rising, start.dbeta)
        reversal = up.reversal(start.dbeta)
        falling = self.stabiliser.falling(rising, reversal)
        down = falling_energy(self.biped, falling, reversal)
        landed = land_on_constraints(self.biped, down)
        margins = [*self.limits.rising(up, start.dbeta, reversal), *self.limits.falling(down, reversal)]
        q_minus = relabel(landed.q)
        width = float(self.biped.joint_positions(q_minus)[3, 0])
        return RestrictedStep(start, reversal, rising, falling, landed, width, tuple(margins))

    def _energy(self, rising: RisingConstraints, dbeta: float) -> PhaseEnergy:
        """Of a rising phase begun with dbeta [rad/s], as far as it takes the robot.

        The same object is met again at landings as planned: from then on its energy is kept, and serves all speeds.
        """
        if id(rising) not in self._energies:
            if len(self._energies) == KEPT:
                self._energies.clear()
            self._energies[id(rising)] = (rising, None)  # kept, it keeps its id
            return rising_energy(self.biped, rising, dbeta)
        energy = self._energies[id(rising)][1] or rising_energy(self.biped, rising)
        self._energies[id(rising)] = (rising, energy)
        return energy

    def speed_ratio(self, landed: ConstrainedState) -> float:
        """Post-impact speed relative to the gait's [-]."""
        return landed.dbeta / self.gait.orbit.beta_dot_after_impact

    def slope(self, step: float = 1e-4) -> tuple[float, float]:
        """Derivative of the map at the gait from below and from above, one-sided differences of second order [-]."""

        def ratio(x: float) -> float:
            return self.speed_ratio(self.step(self.start(x)).landed)

        below = (3.0 - 4.0 * ratio(1.0 - step) + ratio(1.0 - 2.0 * step)) / (2.0 * step)
        above = (4.0 * ratio(1.0 + step) - ratio(1.0 + 2.0 * step) - 3.0) / (2.0 * step)
        return below, above

    def sample(self, speed_ratios: FloatArray) -> FloatArray:
        """(n,) next speed ratios of given ones; nan where there is no step, or it breaks a limit."""
        following = np.full(len(speed_ratios), np.nan)
        for i, ratio in enumerate(speed_ratios):
            try:
                step = self.step(self.start(float(ratio)))
            except ReversalError:
                continue
            if step.tightest.value >= 0.0:
                following[i] = self.speed_ratio(step.landed)
        return following

    def follow(self, speed_ratio: float, steps: int = STEPS, known: "Known | None" = None) -> Return:
        """Iterate the map from a perturbed post-impact speed until it returns, fails, or the steps are used up.

        Args:
            speed_ratio: relative to the gait's [-].
            steps: after which to give up.
            known: speeds that are known to return; the iteration stops among them, and adds their steps.
        """
        landed, speeds = self.start(speed_ratio), [speed_ratio]
        away = 0
        for _ in range(steps):
            try:
                step = self.step(landed)
            except ReversalError as error:
                return Return(False, tuple(speeds), str(error))
            if not step.tightest.value >= 0.0:
                return Return(False, tuple(speeds), step.tightest.name)
            landed = step.landed
            speeds.append(self.speed_ratio(landed))
            # both the speed and the pose, for a step law changes the pose
            pose_error = float(np.max(np.abs(landed.q - self.start().q)))
            if abs(speeds[-1] - 1.0) < RETURNED and pose_error < RETURNED:
                return Return(True, tuple(speeds), "")
            left = None if known is None or pose_error > SAME_POSE else known.steps(speeds[-1] - 1.0)
            if left is not None:
                if len(speeds) - 1 + left > steps:
                    break
                return Return(True, (*speeds, *(1.0,) * left), "")
            before, after = speeds[-2] - 1.0, speeds[-1] - 1.0
            away = away + 1 if after * before > 0.0 and abs(after) >= abs(before) else 0
            if away == PATIENCE:
                return Return(False, tuple(speeds), "the speed goes away from the gait's")
        return Return(False, tuple(speeds), f"no return within {counted(steps, 'step')}")

    def basin(self, low: float = 0.05, high: float = 3.0) -> "Basin":
        """The interval of post-impact speeds around the gait's from which it returns.

        Searched outwards from the gait, in steps that widen with the distance, the edges refined by bisection. A speed
        whose successors come among those already found to return is taken to return with them.

        Args:
            low: smallest relative speed tried [-].
            high: largest [-].
        """
        known = Known()
        edges: dict[int, tuple[float, str]] = {}
        error = FIRST_PROBE
        while len(edges) < 2:
            for sense, end in ((-1, 1.0 - low), (1, high - 1.0)):
                if sense in edges:
                    continue
                found = self.follow(1.0 + sense * min(error, end), known=known)
                if not found.returned:
                    edges[sense] = self._edge(min(error, end), sense, found.limited_by, known)
                    continue
                known = known.widened(sense * min(error, end), len(found.speeds) - 1)
                if error >= end:
                    edges[sense] = (end, "nothing up to the end of the search")
            error *= WIDENING
        return Basin(1.0 - edges[-1][0], 1.0 + edges[1][0], edges[-1][1], edges[1][1])

    def _edge(self, bad: float, sense: int, why: str, known: "Known") -> tuple[float, str]:
        """Largest relative error that returns, and what is in the way of more."""
        good = known.reach(sense)
        while bad - good > max(FINEST, FINE * good):
            middle = 0.5 * (good + bad)
            found = self.follow(1.0 + sense * middle, known=known)
            if found.returned:
                good, known = middle, known.widened(sense * middle, len(found.speeds) - 1)
            else:
                bad, why = middle, found.limited_by
        return good, why


@dataclass(frozen=True)
class Known:
    """Speeds known to return, as relative errors, nearest first.

    Attributes:
        below: (size of the error, steps it takes) of speeds below the gait's [-].
        above: the same above it.
    """

    below: tuple[tuple[float, int], ...] = ()
    above: tuple[tuple[float, int], ...] = ()

    def side(self, error: float) -> tuple[tuple[float, int], ...]:
        """Those on the side of an error."""
        return self.below if error < 0.0 else self.above

    def reach(self, sense: int) -> float:
        """The largest error known to return below (-1) or above (+1) the gait [-]."""
        return max((size for size, _ in self.side(sense)), default=RETURNED)

    def steps(self, error: float) -> int | None:
        """Steps that the next larger error known takes; None where there is none."""
        return next((steps for size, steps in self.side(error) if abs(error) <= size), None)

    def widened(self, error: float, steps: int) -> "Known":
        """With an error added that returns in so many steps."""
        wider = (*self.side(error), (abs(error), steps))
        return replace(self, below=wider) if error < 0.0 else replace(self, above=wider)


@dataclass(frozen=True)
class Basin:
    """Interval of post-impact speeds that return.

    Attributes:
        low: smallest, relative to the gait's [-].
        high: largest [-].
        low_limited_by: what stands in the way below.
        high_limited_by: what stands in the way above.
    """

    low: float
    high: float
    low_limited_by: str
    high_limited_by: str

    def __str__(self) -> str:
        return (
            f"{100.0 * (self.low - 1.0):+.0f} % (then: {self.low_limited_by}) to"
            f" {100.0 * (self.high - 1.0):+.0f} % (then: {self.high_limited_by})"
        )
