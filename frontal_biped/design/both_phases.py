"""Rising and falling phase of a step in one array, one behind the other: half as many array operations.

The formulas of `virtual_constraints` and `zero_dynamics` are asked about both at once, and what belongs to a phase is a
slice of what was found.
"""

from typing import NamedTuple, cast

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.derivatives import DELTA, FRI, Nodes, Q
from frontal_biped.design.forward_mode import Dual
from frontal_biped.design.node_table import told
from frontal_biped.design.tape import done, written
from frontal_biped.numerics.quadrature import ReversalQuadrature
from frontal_biped.virtual_constraints.invariance import PhaseParameters
from frontal_biped.virtual_constraints.phase import ConstrainedMotion, StepPhase, phase_basis
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

    def __matmul__(self, values: Dual) -> Dual:
        n, size = len(self.matrix), len(values.block)
        by_phase = values.reshape(2, n).block.transpose(1, 2, 0)
        found = done(values.tape, np.matmul, self.matrix, by_phase)
        return Dual(found.reshape(2 * n, size).T, values.tape)


class BothPhases:
    """Nodes, bases and integration of a step.

    Args:
        rule: quadrature of one phase on n nodes.
        degree: M of the joints.
        fri_degree: M_FRI.

    Attributes:
        slices: which nodes belong to the rising and to the falling phase.
        sign: (2 n,) of dbeta at the nodes.
    """

    def __init__(self, rule: ReversalQuadrature, degree: int, fri_degree: int) -> None:
        n, tau_squared = rule.size, rule.tau**2
        self.slices = slice(0, n), slice(n, 2 * n)
        tau, weights, barycentric = (np.tile(part, 2) for part in (rule.tau, rule.weights, rule.barycentric))
        self._rule = ReversalQuadrature(tau, weights, cast("FloatArray", _OnEach(rule.Q)), barycentric)
        bases = [phase_basis(degree, fri_degree, s) for s in (1.0 - tau_squared, tau_squared)]
        self._joint_basis = np.array([basis.joints for basis in bases])  # (phase, order, n, M + 1)
        self._fri_basis = np.array([basis.fri for basis in bases])
        self._way = tau_squared[:, None]
        self.sign = np.repeat([phase.sign for phase in StepPhase], n)

    def motion(self, rising: PhaseParameters, falling: PhaseParameters) -> tuple[Dual, Nodes]:
        """(2,) |beta_r- - beta_impact| of the phases [rad], and the nodes of both with the robot's motion there."""
        reversal = cast("Dual", rising.beta_end)
        Delta = reversal - np.stack([rising.beta_start, falling.beta_end])
        beziers = [cast("Dual", phase.joint_bezier).block for phase in (rising, falling)]
        fris = [cast("Dual", phase.fri_bezier).block for phase in (rising, falling)]
        columns = np.empty((2, 3, *beziers[0].T.shape))  # of q and its derivatives with respect to beta
        fri_columns = np.empty((2, 2, *fris[0].T.shape))
        nodes = Nodes.empty(len(self.sign), len(Delta.block) - 1, Delta.tape)
        of_phases = [table.block.reshape(2, -1, *table.block.shape[1:]) for table in nodes]

        def fill(motion: FloatArray, scalars: FloatArray) -> None:
            """Both tables, with the phases apart."""
            for phase in range(2):
                columns[phase, 0], fri_columns[phase, 0] = beziers[phase].T, fris[phase].T
            range_of_phase = Delta.block.T
            slope = np.array([[1.0], [-1.0]]) / range_of_phase[:, :1]  # ds/dbeta
            by_slope = -slope * range_of_phase[:, 1:] / range_of_phase[:, :1]
            for order in range(2):
                _times(columns[:, order], slope[:, :, None, None], by_slope[:, None, None], columns[:, order + 1])
            _times(fri_columns[:, 0], slope[:, :, None], by_slope[:, None], fri_columns[:, 1])
            beta = motion[:, :, Q.start]
            np.multiply(self._way, range_of_phase[:, None], out=beta)
            np.subtract(reversal.block, beta, out=beta)
            motion[:, :, Q.start + 4, 0] = 1.0
            curve = motion[:, :, Q.start : FRI.start].reshape(*motion.shape[:2], 3, -1).swapaxes(1, 2)
            joints = curve[..., motion.shape[-1] :]  # q and its derivatives without those of beta
            np.matmul(self._joint_basis, columns.reshape(2, 3, columns.shape[2], -1), out=joints)
            np.matmul(self._fri_basis, fri_columns, out=motion[:, :, FRI].swapaxes(1, 2))
            scalars[:, :, DELTA] = range_of_phase[:, None]

        written(Delta.tape, fill, *of_phases)
        return Delta, nodes

    def orbit(self, nodes: Nodes, restricted: RestrictedDynamics) -> PhaseOrbit:
        """The orbit through both, by the formulas of one; of what it says, only the sign of dbeta is not the falling's.

        Args:
            nodes: of both phases, as `motion` gives them.
            restricted: the scalar dynamics there.
        """
        Delta = cast("float", nodes.scalars.row(DELTA))
        return integrate_from_reversal(self._rule, StepPhase.RISING, Delta, nodes.constrained_motion(), restricted)

    def in_turn(self, rows: Dual) -> Dual:
        """(rows 2 n,) rows at the nodes of both phases, (rows, 2 n), those of the rising phase before the other's."""
        size, count, nodes = rows.block.shape
        source = rows.block.reshape(size, count, 2, -1).transpose(2, 1, 3, 0)
        found = np.empty((2, count, nodes // 2, size))
        written(rows.tape, np.copyto, found, source)
        return Dual(found.reshape(-1, size).T, rows.tape)

    def apart(self, Delta: Dual, both: PhaseOrbit) -> PhaseOrbits:
        """What `orbit` has found, as the orbits of the two phases."""
        kinds = StepPhase.RISING, StepPhase.FALLING
        of_phases = zip(kinds, self.slices, (Delta[0], Delta[1]), strict=True)
        return PhaseOrbits(*(_part(both, kind, nodes, cast("float", D)) for kind, nodes, D in of_phases))


def _times(block: FloatArray, factor: FloatArray, by_factor: FloatArray, out: FloatArray) -> None:
    """Product with a number whose derivatives are known, all derivatives behind the values."""
    np.multiply(block, factor, out=out)
    out[..., 1:] += block[..., :1] * by_factor


def _part(both: PhaseOrbit, kind: StepPhase, nodes: slice, Delta: float) -> PhaseOrbit:
    motion = ConstrainedMotion(*(part[nodes] for part in both.motion))
    projected = ProjectedDynamics(*(rows[:, nodes] for rows in both.restricted.projected))
    restricted = told(RestrictedDynamics(projected, motion.p_fri, motion.dp_fri), **_cut(both.restricted, nodes))
    tau, weights, exponent, z = (part[nodes] for part in (both.tau, both.weights, both.log_delta_squared, both.z))
    orbit = PhaseOrbit(tau, weights, kind, Delta, motion, restricted, exponent, z)
    return told(orbit, **_cut(both, nodes))


def _cut(known: PhaseOrbit | RestrictedDynamics, nodes: slice) -> dict[str, FloatArray]:
    """What was told of the nodes of both phases, for some of them."""
    fields = known.__dataclass_fields__
    found = {name: values for name, values in vars(known).items() if name not in fields}
    return {name: values[:, nodes] if name == "generalized_forces" else values[nodes] for name, values in found.items()}
