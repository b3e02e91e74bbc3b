"""Rising and falling phase of a step in one array, one behind the other: half as many array operations.

The formulas of `virtual_constraints` and `zero_dynamics` are asked about both at once, and what belongs to a phase is a
slice of what was found.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, cast

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.numerics.quadrature import ReversalQuadrature
from frontal_biped.virtual_constraints.invariance import PhaseParameters
from frontal_biped.virtual_constraints.phase import (
    ConstrainedMotion,
    PhasePolynomials,
    StepPhase,
    constrained_motion,
    phase_basis,
)
from frontal_biped.zero_dynamics.orbit import PhaseOrbit, integrate_from_reversal
from frontal_biped.zero_dynamics.restricted import ProjectedDynamics, RestrictedDynamics


class PhaseOrbits(NamedTuple):
    """The orbits of a step.

    Attributes:
        rising: from impact to reversal.
        falling: from reversal to impact.
    """

    rising: PhaseOrbit
    falling: PhaseOrbit


class _OnEach(NamedTuple):
    """A matrix (n, n) that acts on the nodes of each phase.

    As one matrix it would be so large that BLAS shares it out among threads, and digits depend on their number.
    """

    matrix: FloatArray
    slices: tuple[slice, slice]

    def __matmul__(self, values: FloatArray) -> FloatArray:
        return np.concatenate([self.matrix @ values[nodes] for nodes in self.slices])


class BothPhases:
    """Nodes, bases and integration of a step.

    Args:
        rule: quadrature of one phase on n nodes.
        degree: M of the joints.
        fri_degree: M_FRI.

    Attributes:
        slices: which nodes belong to the rising and to the falling phase.
    """

    def __init__(self, rule: ReversalQuadrature, degree: int, fri_degree: int) -> None:
        n, tau_squared = rule.size, rule.tau**2
        self.slices = slice(0, n), slice(n, 2 * n)
        tau, weights, barycentric = (np.tile(part, 2) for part in (rule.tau, rule.weights, rule.barycentric))
        self._rule = ReversalQuadrature(tau, weights, cast("FloatArray", _OnEach(rule.Q, self.slices)), barycentric)
        self._bases = tuple(phase_basis(degree, fri_degree, s) for s in (1.0 - tau_squared, tau_squared))
        self._phase = np.repeat([0, 1], n)
        self._sign = np.repeat([phase.sign for phase in StepPhase], n)

    def motion(self, rising: PhaseParameters, falling: PhaseParameters) -> tuple[FloatArray, ConstrainedMotion]:
        """(2,) |beta_r- - beta_impact| of the phases [rad], and the robot at the nodes of both."""
        Delta = rising.beta_end - np.stack([rising.beta_start, falling.beta_end])
        beta = rising.beta_end - Delta[self._phase] * self._rule.tau**2
        of_phases = [
            basis.polynomials(phase.joint_bezier, phase.fri_bezier)
            for phase, basis in zip((rising, falling), self._bases, strict=True)
        ]
        value, first, second = (np.concatenate(parts) for parts in zip(*(of.joints for of in of_phases), strict=True))
        p_fri, dp_fri = (np.concatenate(parts) for parts in zip(*(of.fri for of in of_phases), strict=True))
        polynomials = PhasePolynomials((value, first, second), (p_fri, dp_fri))
        return Delta, constrained_motion(beta, Delta[self._phase] * self._sign, polynomials)

    def orbit(self, Delta: FloatArray, motion: ConstrainedMotion, restricted: RestrictedDynamics) -> PhaseOrbit:
        """The orbit through both, by the formulas of one; of what it says, only the sign of dbeta is not the falling's.

        Args:
            Delta: (2,) as `motion` gives it.
            motion: at the nodes of both phases.
            restricted: likewise.
        """
        return integrate_from_reversal(
            self._rule, StepPhase.RISING, cast("float", Delta[self._phase]), motion, restricted
        )

    def apart(self, Delta: FloatArray, both: PhaseOrbit) -> PhaseOrbits:
        """What `orbit` has found, as the orbits of the two phases."""
        kinds = StepPhase.RISING, StepPhase.FALLING
        of_phases = zip(kinds, self.slices, (Delta[0], Delta[1]), strict=True)
        return PhaseOrbits(*(_part(both, kind, nodes, cast("float", D)) for kind, nodes, D in of_phases))


@dataclass(frozen=True)
class _DynamicsPart(RestrictedDynamics):
    """A slice of the dynamics at the nodes of both phases."""

    both: RestrictedDynamics
    nodes: slice

    @cached_property
    def I_P(self) -> FloatArray:
        return self.both.I_P[self.nodes]

    @cached_property
    def kappa_2(self) -> FloatArray:
        return self.both.kappa_2[self.nodes]


@dataclass(frozen=True)
class _OrbitPart(PhaseOrbit):
    """A slice of the orbit through both phases."""

    both: PhaseOrbit
    nodes: slice

    @cached_property
    def dbeta(self) -> FloatArray:
        return self.kind.sign * self.both.dbeta[self.nodes]

    @cached_property
    def ddbeta(self) -> FloatArray:
        return self.both.ddbeta[self.nodes]

    @cached_property
    def generalized_forces(self) -> FloatArray:
        return self.both.generalized_forces[:, self.nodes]

    @cached_property
    def time_density(self) -> FloatArray:
        return self.both.time_density[self.nodes]


def _part(both: PhaseOrbit, kind: StepPhase, nodes: slice, Delta: float) -> PhaseOrbit:
    motion = ConstrainedMotion(*(part[nodes] for part in both.motion))
    projected = ProjectedDynamics(*(rows[:, nodes] for rows in both.restricted.projected))
    restricted = _DynamicsPart(projected, motion.p_fri, motion.dp_fri, both.restricted, nodes)
    tau, weights, exponent, z = (part[nodes] for part in (both.tau, both.weights, both.log_delta_squared, both.z))
    return _OrbitPart(tau, weights, kind, Delta, motion, restricted, exponent, z, both, nodes)
