"""The restricted return map with a variable reversal point, in closed form, under any stabiliser.

Anchored transitions keep the state on Z, so a step is one number, the speed after the impact: the energy R of
`phase_energy` says where it reverses, the falling phase that the stabiliser answers with gives the energy at the
impact, and the impact is linear in the speed. Every contact constraint is evaluated along the step.
"""

from dataclasses import dataclass

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.transitions import Stabiliser
from frontal_biped.exceptions import ReversalError
from frontal_biped.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.phase_energy import Landed, PhaseEnergy, falling_energy, land_on_constraints, rising_energy
from frontal_biped.poincare import Landing
from frontal_biped.virtual_constraints.phase import Phase
from frontal_biped.zero_dynamics import F_H, F_V, TORQUES

RETURNED = 0.01
"""Relative speed error that counts as returned."""

STEPS = 20
"""Steps after which a slow return is given up."""


@dataclass(frozen=True)
class Margin:
    """Room left to one limit over a step.

    Attributes:
        name: of the limit.
        value: room, positive inside, in units of a typical size of the quantity [-].
    """

    name: str
    value: float


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
        spec = gait.specification
        self.friction = float(spec.get("friction", 0.6))
        self.min_normal_force = float(spec.get("min_normal_force", 0.1))
        self.max_torque: FloatArray = np.asarray(spec.get("max_torque", biped.max_torque), dtype=float)
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
        landing, dbeta, landed = land_on_constraints(self.biped, down)
        zeta = 0.5 * (up.start_inertia * start.dbeta) ** 2
        margins = [
            *self._along("rising", up, zeta, reversal, rising.beta_start),
            *self._along("falling", down, 0.0, reversal, falling.beta_end),
            *self._at_impact(landing, dbeta),
        ]
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

    def _along(self, name: str, energy: PhaseEnergy, zeta: float, reversal: float, foot_end: float) -> list[Margin]:
        """Contact constraints along a phase; ``foot_end`` is where the swing foot is on the ground [rad]."""
        outer, inner = self.biped.sole
        worst = dict.fromkeys(("friction", "normal force", "FRI in the sole", "torque", "swing foot clearance"), np.inf)
        for panel in energy.panels:
            beta = panel.motion.q[:, 0]
            inside = beta <= reversal + 1e-12
            if not np.any(inside):
                break
            value = np.exp(panel.growth(beta)) * (zeta - panel.spent(beta))
            dynamics = panel.restricted
            speed_squared = np.maximum(2.0 * value, 0.0) / dynamics.I_P**2
            A, B, G = dynamics.projected
            forces = (A * dynamics.acceleration(speed_squared) + B * speed_squared + G)[:, inside]
            p = dynamics.p_fri[inside]
            share = (beta[inside] - foot_end) / (reversal - foot_end)
            lifted = share > 1e-3
            found = {
                "friction": self.friction - np.abs(forces[F_H] / forces[F_V]),
                "normal force": forces[F_V] / self.biped.weight - self.min_normal_force,
                "FRI in the sole": np.minimum(p - outer, inner - p) / (inner - outer),
                "torque": np.min(1.0 - np.abs(forces[TORQUES]) / self.max_torque[:, None], axis=0),
                "swing foot clearance": np.array(
                    [
                        self.biped.swing_sole(q)[:, 1].min() / (0.01 * s)
                        for q, s in zip(panel.motion.q[inside][lifted], share[lifted], strict=True)
                    ]
                ),
            }
            for key, values in found.items():
                worst[key] = min(worst[key], float(np.min(values, initial=np.inf)))
        return [Margin(f"{key}, {name}", value) for key, value in worst.items()]

    def _at_impact(self, landing: Landing, dbeta: float) -> list[Margin]:
        outer, inner = self.biped.sole
        L = landing.impulse * dbeta
        lever = float(L[2] / L[1])
        return [
            Margin("touchdown speed", float(np.min(-landing.touchdown * dbeta)) / 0.05),
            Margin("normal impulse", float(L[1]) / (0.1 * self.biped.mass)),
            Margin("impulse in the friction cone", self.friction - abs(float(L[0] / L[1]))),
            # the landing foot is mirrored: its inner end points towards -h
            Margin("impulse in the sole", min(lever + inner, -outer - lever) / (inner - outer)),
            Margin("lift-off of the old stance foot", float(np.min(landing.lift_off * dbeta)) / 0.05),
        ]


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
