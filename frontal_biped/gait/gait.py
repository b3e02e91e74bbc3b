"""A gait: two phases, a step width, and the numbers of its periodic orbit."""

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.files.shown import ShownAsPage
from frontal_biped.gait.look_ahead_table import LookAheadTable
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.gait.whole_orbit import whole_orbit
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.robot import Robot
from frontal_biped.model.space.whole_motion import WholeMotion
from frontal_biped.model.state import State
from frontal_biped.virtual_constraints.invariance import invariance_residuals
from frontal_biped.virtual_constraints.phase import Phase
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics, StepOrbit, step_orbit

QUADRATURE_ACCURACY = 1e-11
"""Relative change of zeta at the impact, duration and cost on doubling the nodes that counts as converged."""

MIN_NODES, MAX_NODES = 16, 128


@dataclass(frozen=True)
class RobotReference:
    """Which robot a gait was designed for.

    Attributes:
        name: of the description.
        description: its file, named as `robot_path` says.
        fingerprint: SHA-256 of URDF and description.
    """

    name: str
    description: str
    fingerprint: str


@dataclass(frozen=True)
class OrbitNumbers:
    """The periodic orbit in five numbers.

    Attributes:
        beta_dot_after_impact: dbeta_r+ [rad/s].
        zeta_f_star: fixed point of the Poincare map [kg^2 m^4/s^2].
        step_duration: [s].
        cost: J [N^2 m s].
        multiplier: slope of the Poincare map [-].
    """

    beta_dot_after_impact: float
    zeta_f_star: float
    step_duration: float
    cost: float
    multiplier: float


@dataclass(frozen=True)
class Gait(ShownAsPage):
    """A gait, ready for the controller.

    Attributes:
        robot: which robot.
        rising: virtual constraints from impact to reversal.
        falling: virtual constraints from reversal to impact.
        step_width: distance between the ankles [m].
        orbit: the periodic orbit.
        specification: what it was designed for.
        provenance: versions, seed, solver status, residuals.
        look_ahead: what looking ahead answers at every speed (`control.stabilisers.tabulation`); None: to be computed.
    """

    robot: RobotReference
    rising: Phase
    falling: Phase
    step_width: float
    orbit: OrbitNumbers
    specification: GaitSpecification = field(default_factory=GaitSpecification)
    provenance: Mapping[str, Any] = field(default_factory=dict)
    look_ahead: LookAheadTable | None = None

    def __repr__(self) -> str:
        orbit = self.orbit
        return (
            f"Gait of {self.robot.name!r}: steps of {orbit.step_duration:.4f} s, {self.step_width:.3f} m wide,"
            f" J = {orbit.cost:.4g} N^2 m s, multiplier {orbit.multiplier:.4f}"
        )

    @property
    def beta_reversal(self) -> float:
        """beta_r- [rad]."""
        return self.rising.beta_end

    @property
    def speed_after_impact(self) -> float:
        """dbeta_r+ on the periodic orbit [rad/s]."""
        return self.orbit.beta_dot_after_impact

    def step(self, biped: FrontalBiped, nodes: int | None = None) -> StepOrbit:
        """The step of the zero dynamics; by default on as many nodes as `converged_nodes` finds necessary."""
        size = converged_nodes(biped, self.rising, self.falling, self.step_width) if nodes is None else nodes
        return step_orbit(biped, self.rising, self.falling, self.step_width, size)

    def state_after_impact(self) -> State:
        """The state at the start of the rising phase on the periodic orbit."""
        motion = self.rising.motion(np.array([self.rising.beta_start]))
        return State(motion.q[0], motion.dq[0] * self.orbit.beta_dot_after_impact)

    def trajectory(self, robot: Robot | FrontalBiped, rate: float, steps: int = 2) -> WholeMotion:
        """Steps of the periodic orbit as a motion of every joint of the URDF, for a driver, Pinocchio or MuJoCo.

        Args:
            robot: the whole robot, or its view from the front.
            rate: samples per second.
            steps: how many, the first on the left foot from right after an impact.

        Raises:
            SpecificationError: rate or steps is not positive.
            RobotError: virtual legs do not reach a pose; one line.
            HypothesisError: the robot is no frontal biped (HR1 to HR5).
        """
        biped = robot if isinstance(robot, FrontalBiped) else FrontalBiped(robot)
        return whole_orbit(biped, (self.rising, self.falling), self.step(biped), self.step_width, rate, steps)

    def residuals(self, biped: FrontalBiped, step: StepOrbit | None = None) -> dict[str, float]:
        """How far the gait is from being one; every entry should be below 1e-9.

        Invariance at impact and reversal (see `invariance_residuals`), the energy balance of a step (the fixed point
        against the energy integrated from the reversal, relative) and the stored orbit against a new integration.

        Args:
            biped: the robot.
            step: the integrated step, where it is at hand.
        """
        step = step or self.step(biped)
        hzd = HybridZeroDynamics(biped, step)
        zeta_f = hzd.rho_f(0.0)  # released at rest from the reversal
        residuals = invariance_residuals(biped, self.rising, self.falling, self.step_width)
        residuals["energy_balance"] = abs(hzd.rho_r(zeta_f)) / abs(hzd.barrier_r)
        fresh = orbit_numbers(biped, step)
        residuals["stored_orbit"] = max(
            abs(a - b) / abs(b) for a, b in zip(asdict(self.orbit).values(), asdict(fresh).values(), strict=True)
        )
        return residuals


def orbit_numbers(biped: FrontalBiped, step: StepOrbit) -> OrbitNumbers:
    """The periodic orbit of a step in five numbers."""
    hzd = HybridZeroDynamics(biped, step)
    return OrbitNumbers(hzd.speed_after_impact, hzd.fixed_point, float(step.duration), float(step.cost), hzd.multiplier)


class Quadrature(NamedTuple):
    """A number of quadrature nodes, and what it is worth.

    Attributes:
        nodes: a phase.
        error: largest relative change of zeta at both ends, duration, cost and multiplier on doubling them [-].
    """

    nodes: int
    error: float


def quadrature_error(biped: FrontalBiped, rising: Phase, falling: Phase, step_width: float, nodes: int) -> float:
    """Largest relative change of zeta at both ends, duration, cost and multiplier from ``nodes`` to twice as many."""
    figures = _figures_by_nodes(biped, rising, falling, step_width)
    return _relative_change(figures(nodes), figures(2 * nodes))


def converged_quadrature(biped: FrontalBiped, rising: Phase, falling: Phase, step_width: float) -> Quadrature:
    """Fewest quadrature nodes a phase, from 16 up in steps of 8, whose measured error is below `QUADRATURE_ACCURACY`.

    Where rounding keeps the error above that, or the orbit does not exist, `MAX_NODES`.
    """
    figures = _figures_by_nodes(biped, rising, falling, step_width)
    for nodes in range(MIN_NODES, MAX_NODES, 8):
        error = _relative_change(figures(nodes), figures(2 * nodes))
        if error < QUADRATURE_ACCURACY:
            return Quadrature(nodes, error)
    return Quadrature(MAX_NODES, _relative_change(figures(MAX_NODES), figures(2 * MAX_NODES)))


def converged_nodes(biped: FrontalBiped, rising: Phase, falling: Phase, step_width: float) -> int:
    """The nodes of `converged_quadrature`."""
    return converged_quadrature(biped, rising, falling, step_width).nodes


def _figures_by_nodes(
    biped: FrontalBiped, rising: Phase, falling: Phase, step_width: float
) -> Callable[[int], FloatArray]:
    @cache  # twice 16 nodes are asked for again as 32
    def figures(size: int) -> FloatArray:
        step = step_orbit(biped, rising, falling, step_width, size)
        return np.array([step.rising.z[-1], step.falling.z[-1], step.duration, step.cost, step.multiplier])

    return figures


def _relative_change(coarse: FloatArray, fine: FloatArray) -> float:
    error = float(np.max(np.abs(coarse - fine) / np.abs(fine)))
    return error if math.isfinite(error) else math.inf
