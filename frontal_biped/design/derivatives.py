"""Exact derivatives of the calls into Pinocchio, and of what follows from them at a node, for `Dual` arrays.

Inverse dynamics along a curve needs only first derivatives of RNEA without gravity at (q, q', q''), which is B. They
tell A = M q', that at (q, 0, q'), and G, what a ground accelerated upwards by g would ask for, and their derivatives
(`design.side_by_side`). No second derivative of the model appears. Each node is differentiated by its own numbers, and
products with tables of these take the derivatives to the P variables (`design.node_table`).
"""

from dataclasses import replace
from typing import NamedTuple, cast

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.forward_mode import Dual
from frontal_biped.design.node_table import NodeTable, told
from frontal_biped.design.side_by_side import GROUND, InverseDynamics, side_by_side
from frontal_biped.design.tape import Tape, written
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.phase import ConstrainedMotion
from frontal_biped.zero_dynamics.orbit import PhaseOrbit
from frontal_biped.zero_dynamics.restricted import TORQUES, ProjectedDynamics, RestrictedDynamics

# rows of a node's table: how the orbit passes it, then the virtual constraints there
TIME_DENSITY, DDBETA, DBETA_SQUARED, SHARE, DBETA = range(5)
Q, DQ, DDQ, FRI = slice(5, 9), slice(9, 13), slice(13, 17), slice(17, 19)
MOTION_ROWS = 19
_PASSING, _MOVING, _CURVE = slice(0, 5), slice(1, 17), slice(5, 19)

# rows of its second table: the scalar dynamics, then what of it and of the step the orbit passes it by
RATE, DRIVE, A_H, SOLES = 0, 1, slice(2, 3), slice(3, 5)
I_P, KAPPA_2, B_P, Z, DELTA, STEP_WIDTH = range(5, 11)
SCALAR_ROWS = 11
_SCALARS, _PASSED_BY = slice(0, 8), slice(5, 11)

# rows of what the robot feels there
_FORCES, _WEIGHTED, _VELOCITIES = slice(0, 7), slice(7, 11), slice(11, 15)


class Nodes(NamedTuple):
    """The tables of n nodes, rows as above.

    Attributes:
        motion: (n, 19, 1 + P).
        scalars: (n, 11, 1 + P).
    """

    motion: NodeTable
    scalars: NodeTable

    @classmethod
    def empty(cls, n: int, variables: int, tape: Tape | None) -> "Nodes":
        """Of n nodes and P variables, with nothing in them yet."""
        return cls(NodeTable(n, MOTION_ROWS, variables, tape), NodeTable(n, SCALAR_ROWS, variables, tape))

    def constrained_motion(self) -> ConstrainedMotion:
        """The virtual constraints in the table."""
        q, dq, ddq = (cast("FloatArray", self.motion.by_node(part)) for part in (Q, DQ, DDQ))
        p_fri, dp_fri = (cast("FloatArray", row) for row in self.motion.rows(FRI))
        return ConstrainedMotion(q, dq, ddq, p_fri, dp_fri)


class Projection(NamedTuple):
    """What the model has to say along a curve of n configurations.

    Attributes:
        restricted: the scalar dynamics; of A, B and G it has A_h, all else that an orbit needs being told.
        soles: (2, n) heights of the swing sole's inner and outer end [m].
        terms: (15, 3, 7, n) A, B and G of w = A ddbeta + B dbeta^2 + G, as last computed: the values, then derivatives
            with respect to q, q', q'' (4 each) and the FRI (2); rows as in `zero_dynamics.restricted`.
    """

    restricted: RestrictedDynamics
    soles: FloatArray
    terms: FloatArray


class Passing(NamedTuple):
    """An orbit that knows its speeds and forces, and what of its torques counts.

    Attributes:
        orbit: the orbit.
        weighted: (4, n) u sqrt(weight dt/dtau / L_s), whose squares add up to J.
    """

    orbit: PhaseOrbit
    weighted: FloatArray


class DifferentiableBiped:
    """Projected dynamics, sole heights and forces of a robot at the nodes of a curve.

    Args:
        biped: the robot.
    """

    def __init__(self, biped: FrontalBiped) -> None:
        self._biped, self._many = biped, side_by_side(biped)
        self._ends = np.array([[-biped.chain.sole_inner], [biped.chain.sole_outer]])

    def project(self, nodes: Nodes) -> Projection:
        """`zero_dynamics.on_constraints` and the sole heights at nodes whose motion is known."""
        motion, scalars = nodes
        n, tape = len(motion.block), motion.tape
        terms, soles = np.zeros((15, 3, 7, n)), np.zeros((15, 2, n))
        at_rest, moving, weight = terms.swapaxes(0, 1)  # A, B, G

        def fill() -> None:
            states = motion.block[:, 5:17, 0].T.copy().reshape(3, 4, n)
            J = self._many.at(states, moving[:13])
            self._many.from_rest(moving[:13], J, states[1], InverseDynamics(at_rest[0], at_rest[1:5]))
            at_rest[5:9] = moving[9:13]
            self._many.weight(moving[9:13], InverseDynamics(weight[0], weight[1:5]))
            self._sole_heights(states[0].T, J, soles)

        written(tape, fill)
        A, B, G = (cast("FloatArray", Dual(part[:, GROUND], tape)) for part in (at_rest, moving, weight))
        p_fri, dp_fri = (cast("FloatArray", row) for row in motion.local(_CURVE)[12:])
        local = RestrictedDynamics(ProjectedDynamics(A, B, G), p_fri, dp_fri)
        found = [local.rate[None], local.drive[None], A[:1], Dual(soles, tape)]
        found += [local.I_P[None], local.kappa_2[None], local.B_P[None]]
        scalars.take(_SCALARS, cast("list[Dual]", found), motion, _CURVE)

        A_h, nothing = (cast("FloatArray", scalars.rows(part)) for part in (A_H, slice(0, 0)))
        *_, p_fri, dp_fri = nodes.constrained_motion()
        rows = {"rate": RATE, "drive": DRIVE, "I_P": I_P, "kappa_2": KAPPA_2, "B_P": B_P}
        restricted = told(
            RestrictedDynamics(ProjectedDynamics(A_h, nothing, nothing), p_fri, dp_fri),
            **{name: scalars.row(row) for name, row in rows.items()},
        )
        return Projection(restricted, cast("FloatArray", scalars.rows(SOLES)), terms)

    def _sole_heights(self, q: FloatArray, J: FloatArray, found: FloatArray) -> None:
        """Heights of the sole's ends at n configurations (n, 4).

        Turning a joint moves a point by a quarter turn of its lever: J (4, 2, n), the velocity of the world's origin as
        if it belonged to the foot, is the vertical and minus the horizontal place of each joint.

        Args:
            q: configurations.
            J: there.
            found: (5 or more, 2, n) filled with values and derivatives with respect to q.
        """
        rotation, ends, h_a = self._biped.swing_foot_rotation(q), self._ends, self._biped.ankle_height
        cos, sin = np.cos(rotation), np.sin(rotation)
        np.add(sin * ends, J[-1, 0] - cos * h_a, out=found[0])
        np.add(cos * ends + (sin * h_a - J[-1, 1]), J[:, None, 1], out=found[1:5])

    def passing(
        self, nodes: Nodes, orbit: PhaseOrbit, step_width: Dual, sign: FloatArray, terms: FloatArray
    ) -> Passing:
        """The orbit, where it is known at what speed and under which forces it passes its nodes.

        Args:
            nodes: their motion, I_P, kappa_2, B_P, z and Delta.
            orbit: through them.
            step_width: L_s [m].
            sign: (n,) of dbeta.
            terms: (15, 3, 7, n) what `project` has found there.
        """
        motion, scalars = nodes
        scalars.put(STEP_WIDTH, step_width)
        inertia, moment, bent, z, Delta, width = (cast("FloatArray", row) for row in scalars.local(_PASSED_BY))
        restricted = told(replace(orbit.restricted), I_P=inertia, kappa_2=moment, B_P=bent)
        local = replace(orbit, tau=sign * orbit.tau, Delta=cast("float", Delta), restricted=restricted, z=z)
        squared = local.dbeta**2
        share = np.sqrt(local.time_density / width) * np.sqrt(orbit.weights)
        found = [local.time_density, restricted.acceleration(squared), squared, share, local.dbeta]
        motion.take(_PASSING, [cast("Dual", row[None]) for row in found], scalars, _PASSED_BY)

        felt = NodeTable(len(motion.block), 15, motion.block.shape[2] - 1, motion.tape)
        by_node = np.zeros((len(motion.block), 15, 17))
        own_speed = np.einsum("nii->ni", by_node[:, _VELOCITIES, 9:13])  # a view: of each velocity by its own dq/dbeta
        written(motion.tape, _feel, by_node, own_speed, motion.block[:, :, 0], terms)
        felt.carry(slice(0, 15), by_node, motion, _MOVING)
        known = {"dbeta": DBETA, "ddbeta": DDBETA, "time_density": TIME_DENSITY}
        walked = told(
            replace(orbit, z=cast("FloatArray", scalars.row(Z))),
            generalized_forces=felt.rows(_FORCES),
            velocities=felt.by_node(_VELOCITIES),
            **{name: motion.row(row) for name, row in known.items()},
        )
        return Passing(walked, cast("FloatArray", felt.rows(_WEIGHTED)))


def _feel(by_node: FloatArray, own_speed: FloatArray, motion: FloatArray, terms: FloatArray) -> None:
    """Forces, weighted torques and velocities.

    Args:
        by_node: (n, 15, 17) filled with their values and derivatives with respect to the rows `_MOVING`.
        own_speed: (n, 4) the elements of it that are derivatives of a velocity by its own dq/dbeta.
        motion: (n, 19) values of the table.
        terms: (15, 3, 7, n) as in `Projection`.
    """
    (A, B, G), (ddbeta, squared, share, dbeta) = terms.swapaxes(0, 1), motion[:, DDBETA : DBETA + 1].T.copy()
    forces, weighted, velocities = by_node[:, _FORCES], by_node[:, _WEIGHTED], by_node[:, _VELOCITIES]
    w = B[:13] * squared
    w[:9] += A[:9] * ddbeta
    w[:5] += G[:5]
    forces[:, :, 0], forces[:, :, 1], forces[:, :, 2] = w[0].T, A[0].T, B[0].T
    forces[:, :, 5:] = w[1:].transpose(2, 1, 0)
    torques = forces[:, TORQUES]
    np.multiply(torques, share[:, None, None], out=weighted)
    weighted[:, :, 3] = torques[:, :, 0]
    dq = motion[:, DQ]
    np.multiply(dq, dbeta[:, None], out=velocities[:, :, 0])
    velocities[:, :, 4] = dq
    own_speed[:] = dbeta[:, None]
