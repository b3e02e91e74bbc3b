"""A gait that travels sideways: two different steps in turn, a wide and a narrow one, and their periodic orbit.

Step A lands with the ankles farther apart than step B; A stands on the trailing foot. On the left foot first, the robot
travels to its right (-y), on the right foot to its left. `zero_dynamics.two_steps` has the mathematics.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, NamedTuple

import numpy as np

from frontal_biped.gait.gait import Gait, OrbitNumbers, Quadrature, RobotReference, converged_quadrature
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.gait.two_step_constraints import NAMES, TwoPhases
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.state import State
from frontal_biped.virtual_constraints.invariance import invariance_residuals
from frontal_biped.virtual_constraints.phase import Phase
from frontal_biped.zero_dynamics.poincare import StepOrbit, step_orbit
from frontal_biped.zero_dynamics.two_steps import AffineMap, TwoStepMap, TwoSteps


@dataclass(frozen=True)
class SidewaysStep:
    """One of the two steps, a `PlannedStep` that a controller can track.

    Attributes:
        rising: virtual constraints from the other step's impact to the reversal.
        falling: virtual constraints from the reversal to the impact.
        step_width: distance between the ankles where it lands [m].
        orbit: of this step on the periodic orbit; its multiplier is the slope of its own map, which need not be
            below 1, and its cost J of this step alone.
        specification: what both steps were designed for.
    """

    rising: Phase
    falling: Phase
    step_width: float
    orbit: OrbitNumbers
    specification: GaitSpecification

    @property
    def phases(self) -> tuple[Phase, Phase]:
        """Rising and falling phase."""
        return self.rising, self.falling

    @property
    def speed_after_impact(self) -> float:
        """dbeta_r+, with which it begins [rad/s]."""
        return self.orbit.beta_dot_after_impact

    def state_after_impact(self) -> State:
        """The state with which it begins on the periodic orbit."""
        motion = self.rising.motion(np.array([self.rising.beta_start]))
        return State(motion.q[0], motion.dq[0] * self.speed_after_impact)


class StepNumbers(NamedTuple):
    """Periodic orbit of both steps.

    Attributes:
        a: of step A.
        b: of step B.
    """

    a: OrbitNumbers
    b: OrbitNumbers


@dataclass(frozen=True)
class SidewaysGait:
    """A gait of two steps, ready for the controller.

    Attributes:
        robot: which robot.
        a: the step that lands wide.
        b: the step that lands narrow.
        provenance: versions, seed, solver status, residuals.
    """

    robot: RobotReference
    a: SidewaysStep
    b: SidewaysStep
    provenance: Mapping[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        (a, b), times = self.steps, [step.orbit.step_duration for step in self.steps]
        return (
            f"SidewaysGait of {self.robot.name!r}: {self.travel:.3f} m in two steps of {times[0]:.4f} s and"
            f" {times[1]:.4f} s, {a.step_width:.3f} m and {b.step_width:.3f} m wide, J = {self.cost:.4g} N^2 m s,"
            f" multiplier {self.multiplier:.4f}"
        )

    # ------------------------------------------------------------------ numbers
    @property
    def steps(self) -> tuple[SidewaysStep, SidewaysStep]:
        """A and B."""
        return self.a, self.b

    @property
    def specification(self) -> GaitSpecification:
        """What it was designed for."""
        return self.a.specification

    @property
    def phases(self) -> TwoPhases:
        """Virtual constraints of both steps."""
        return TwoPhases(self.a.phases, self.b.phases)

    @property
    def travel(self) -> float:
        """Way sideways in two steps [m]."""
        return self.a.step_width - self.b.step_width

    @property
    def duration(self) -> float:
        """Of two steps [s]."""
        return self.a.orbit.step_duration + self.b.orbit.step_duration

    @property
    def speed(self) -> float:
        """Mean speed sideways [m/s]."""
        return self.travel / self.duration

    @property
    def multiplier(self) -> float:
        """Slope of the map of two steps, m_A m_B [-]."""
        return self.a.orbit.multiplier * self.b.orbit.multiplier

    @property
    def cost(self) -> float:
        """Mean of J over the two steps [N^2 m s]."""
        return 0.5 * (self.a.orbit.cost + self.b.orbit.cost)

    @property
    def squared_torque(self) -> float:
        """Int u'u dt over two steps [N^2 m^2 s]."""
        return sum(step.orbit.cost * step.step_width for step in self.steps)

    @property
    def cost_of_travel(self) -> float:
        """Int u'u dt for each metre on the way [N^2 m s]; inf without travel."""
        return self.squared_torque / self.travel if self.travel > 0.0 else float("inf")

    # ------------------------------------------------------------------ orbit
    def state_after_impact(self) -> State:
        """The state at the start of step A on the periodic orbit."""
        return self.a.state_after_impact()

    def two_steps(self, biped: FrontalBiped, nodes: int | None = None) -> TwoSteps:
        """Both steps of the zero dynamics; by default on as many nodes as `quadrature_of` finds necessary."""
        size = (
            quadrature_of(biped, self.phases, (self.a.step_width, self.b.step_width)).nodes if nodes is None else nodes
        )
        return TwoSteps(*(step_orbit(biped, *step.phases, step.step_width, size) for step in self.steps))

    def residuals(self, biped: FrontalBiped, steps: TwoSteps | None = None) -> dict[str, float]:
        """How far the gait is from being one; every entry should be below 1e-9.

        Invariance of both steps (see `invariance_residuals`), the energy balance at both reversals, the widths against
        the travel asked for [m], and the stored orbit against a new integration.

        Args:
            biped: the robot.
            steps: both, integrated, where they are at hand.
        """
        steps = steps or self.two_steps(biped)
        closed_form = TwoStepMap(biped, steps)
        residuals: dict[str, float] = {}
        pairs = (self.a, self.b), (self.b, self.a)
        for name, (own, following), balance in zip(NAMES, pairs, closed_form.energy_balance, strict=True):
            found = invariance_residuals(biped, *own.phases, own.step_width, following.rising)
            residuals |= {f"{name}: {key}": value for key, value in found.items()}
            residuals[f"{name}: energy_balance"] = balance
        if self.specification.travel is not None:
            residuals["travel"] = abs(self.travel - self.specification.travel)
        fresh = two_step_numbers(biped, steps)
        residuals["stored_orbit"] = max(
            abs(a - b) / abs(b)
            for own, new in zip(self.steps, fresh, strict=True)
            for a, b in zip(asdict(own.orbit).values(), asdict(new).values(), strict=True)
        )
        return residuals


def quadrature_of(biped: FrontalBiped, phases: TwoPhases, widths: tuple[float, float]) -> Quadrature:
    """Quadrature nodes a phase that either step needs, and the larger of both errors; see `converged_quadrature`."""
    found = [converged_quadrature(biped, *own, width) for own, width in zip(phases, widths, strict=True)]
    return Quadrature(max(of.nodes for of in found), max(of.error for of in found))


def two_step_numbers(biped: FrontalBiped, steps: TwoSteps) -> StepNumbers:
    """The periodic orbit of two steps, five numbers each."""
    closed_form = TwoStepMap(biped, steps)
    maps = closed_form.rho_a, closed_form.rho_b
    of_steps = zip(steps, closed_form.fixed_points, maps, strict=True)
    return StepNumbers(*(_numbers(step, zeta, rho) for step, zeta, rho in of_steps))


def _numbers(step: StepOrbit, zeta: float, rho: AffineMap) -> OrbitNumbers:
    return OrbitNumbers(float(step.rising.dbeta[-1]), zeta, float(step.duration), float(step.cost), rho.m)


AnyGait = Gait | SidewaysGait
"""What can be walked: one step again and again, or two in turn."""


def steps_in_turn(gait: AnyGait) -> tuple[Gait | SidewaysStep, ...]:
    """The steps of a gait, in the order in which they are walked again and again."""
    return gait.steps if isinstance(gait, SidewaysGait) else (gait,)


def orbits_in_turn(biped: FrontalBiped, gait: AnyGait) -> tuple[StepOrbit, ...]:
    """The orbits of `steps_in_turn`."""
    return tuple(gait.two_steps(biped)) if isinstance(gait, SidewaysGait) else (gait.step(biped),)
