"""The restricted return map with a variable reversal point, in closed form, under any stabiliser.

Anchored transitions keep the state on Z, so a step is one number, the speed after the impact: the energy R of
`phase_energy` says where it reverses, the falling phase that the stabiliser answers with gives the energy at the
impact, and the impact is linear in the speed. Every contact constraint is evaluated along the step.
"""

from dataclasses import dataclass

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.contact_margins import ContactMargins, Margin
from frontal_biped.control.transitions import Stabiliser
from frontal_biped.exceptions import ReversalError
from frontal_biped.gait import Gait
from frontal_biped.half_steps import Landed, falling_energy, land_on_constraints, rising_energy
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.phase_energy import PhaseEnergy
from frontal_biped.virtual_constraints.phase import Phase

RETURNED = 0.01
"""Relative speed error that counts as returned."""

STEPS = 20
"""Steps after which a slow return is given up."""


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

    start: Landed
    reversal: float
    rising: Phase
    falling: Phase
    landed: Landed
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
        self._last: tuple[Phase, PhaseEnergy] | None = None

    def start(self, speed_ratio: float = 1.0) -> Landed:
        """After the impact of the gait, its speed multiplied."""
        rising = self.gait.rising
        at = rising.motion(np.array([rising.beta_start]))
        return Landed(at.q[0], at.dq[0, 1:], speed_ratio * self.gait.orbit.beta_dot_after_impact)

    def step(self, start: Landed) -> RestrictedStep:
        """One step.

        Raises:
            ReversalError: there is none; the message says why.
        """
        rising = self.stabiliser.rising(start)
        # the unperturbed phase is the same object at every landing as planned: its energy serves all speeds
        if self._last is None or self._last[0] is not rising:
            self._last = (rising, rising_energy(self.biped, rising))
        up = self._last[1]
        reversal = up.reversal(start.dbeta)
        falling = self.stabiliser.falling(rising, reversal)
        down = falling_energy(self.biped, falling, reversal)
        landed = land_on_constraints(self.biped, down)[2]
        margins = [*self.limits.rising(up, start.dbeta, reversal), *self.limits.falling(down, reversal)]
        q_minus = landed.q[::-1]
        width = float(self.biped.joint_positions(q_minus)[3, 0])
        return RestrictedStep(start, reversal, rising, falling, landed, width, tuple(margins))

    def speed_ratio(self, landed: Landed) -> float:
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

    def follow(self, speed_ratio: float, steps: int = STEPS) -> Return:
        """Iterate the map from a perturbed post-impact speed until it returns, fails, or the steps are used up."""
        landed, speeds = self.start(speed_ratio), [speed_ratio]
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
            same_pose = float(np.max(np.abs(landed.q - self.start().q))) < RETURNED
            if abs(speeds[-1] - 1.0) < RETURNED and same_pose:
                return Return(True, tuple(speeds), "")
        return Return(False, tuple(speeds), f"no return within {steps} steps")

    def basin(self, low: float = 0.05, high: float = 3.0, points: int = 16, refine: int = 4) -> "Basin":
        """The interval of post-impact speeds around the gait's from which it returns.

        Searched outwards from the gait on a grid of relative speeds, its edges refined by bisection.
        """
        down = self._edge(np.linspace(1.0, low, points + 1)[1:], refine)
        up = self._edge(np.linspace(1.0, high, points + 1)[1:], refine)
        return Basin(down[0], up[0], down[1], up[1])

    def _edge(self, ratios: FloatArray, refine: int) -> tuple[float, str]:
        good, why = 1.0, "nothing up to the end of the search"
        for ratio in ratios:
            found = self.follow(float(ratio))
            if found.returned:
                good = float(ratio)
                continue
            bad, why = float(ratio), found.limited_by
            for _ in range(refine):
                middle = 0.5 * (good + bad)
                found = self.follow(middle)
                if found.returned:
                    good = middle
                else:
                    bad, why = middle, found.limited_by
            break
        return good, why


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
