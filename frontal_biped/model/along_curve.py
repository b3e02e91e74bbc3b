r"""Inverse dynamics along curves in the configuration space, at many points, with derivatives, in closed form.

On a curve q(beta) inverse dynamics is A ddbeta + B dbeta^2 + G, with A the forces of q' as an acceleration from rest,
B those of q' as velocity and q'' as acceleration, G the weight. Rows of each: F_h, F_v [N], N_0 [N m] about the ground
point below the stance ankle, u_1..u_4 [N m]; for one state they are Pinocchio's (`FrontalBiped.inverse_dynamics`).

A point of the plane is a complex number h + i v, so that turning is multiplying, and Im(conj(r) f) is the moment of a
force f at r. What joint k carries, of mass M_k, is told by its place p_k and two moments of its masses, from there:

.. math:: S_k = \sum m (c - p_k), \qquad L_k = \sum \operatorname{Im} m\,\overline{(c - p_k)}\,(c - p_k)^{\cdot\cdot}
          + I \theta^{\cdot\cdot},

whose force is S_k'' + M_k p_k'', and whose moment about p_k is L_k + Im(conj(S_k) p_k''). Joint k turns all that as a
whole: its lever, velocities and accelerations from p_k by a quarter turn each, and nothing else. So derivatives of the
moment about p_i want nothing but W = Re(conj(p_m - p_i) S_k'') - Re(conj(S_m) p_k''), m the later one of i and k; of A
and of the mass matrix the same with fewer primes.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frontal_biped.arrays import FloatArray
from frontal_biped.model.chain import GRAVITY, UPRIGHT, FrontalChain

ComplexArray = NDArray[np.complex128]

JOINTS = 4
ROWS = 3 + JOINTS

_CARRIED = np.tril(np.ones((JOINTS, JOINTS)))
"""Sums over all links that a joint carries; transposed, over all joints that carry a link."""

_LATER = np.vstack([np.arange(JOINTS), np.maximum.outer(np.arange(JOINTS), np.arange(JOINTS))])
"""(5, 4) the later one of two joints; the ground point, the first row, is before them all."""


class CurveDerivatives(NamedTuple):
    """Of A, B and G at n points.

    Attributes:
        by_q: (3, n, 7, 4) of each with respect to q.
        by_dq: (n, 7, 4) of B with respect to q'.
        by_ddq: (n, 7, 4) of B with respect to q'', and of A with respect to q'.
    """

    by_q: FloatArray
    by_dq: FloatArray
    by_ddq: FloatArray


class ChainMasses:
    """The masses of a chain that stands on its first body.

    Args:
        chain: at the upright reference.
    """

    def __init__(self, chain: FrontalChain) -> None:
        joints, (foot, *bodies) = _complex(chain.joints), chain.bodies
        mass = np.array([body.mass for body in bodies])
        com = _complex(np.array([body.com for body in bodies])) - joints
        self.links: ComplexArray = np.append(np.diff(joints), 0.0)  # from each joint to the next
        beyond = np.append(np.cumsum(mass[:0:-1])[::-1], 0.0)  # carried by the next joint
        # what turned links add up to: places of the joints that they carry, moments of the joints that carry them
        self.places_of_links: ComplexArray = self.links[:, None] * np.triu(np.ones((JOINTS, JOINTS)), k=1)
        self.moments_of_links: ComplexArray = (mass * com + beyond * self.links)[:, None] * _CARRIED
        inertia = np.array([body.inertia for body in bodies])
        self.second_moments: FloatArray = inertia + mass * np.abs(com) ** 2 + beyond * np.abs(self.links) ** 2
        self.armature, self.ankle, self.mass = chain.armature, joints[0], chain.mass
        self.foot_moment = foot.mass * float(foot.com[0])

    def along(self, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> "AlongCurve":
        """The robot at n points of a curve.

        Args:
            q: (n, 4) configurations [rad].
            dq: (n, 4) dq/dbeta [-].
            ddq: (n, 4) d2q/dbeta2 [1/rad].
        """
        return AlongCurve(self, q, dq, ddq)


class AlongCurve:
    """Forces at n points of a curve; see the module.

    Args:
        masses: of the robot.
        q: (n, 4) configurations [rad].
        dq: (n, 4) dq/dbeta [-].
        ddq: (n, 4) d2q/dbeta2 [1/rad].

    Attributes:
        places: (3, n, 4) joints, and their first and second derivative with respect to beta [m].
    """

    def __init__(self, masses: ChainMasses, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> None:
        self._masses, n = masses, len(q)
        self._by_joint = np.empty((2, n, JOINTS))
        self._by_joint[:] = dq, ddq
        self._rates = self._by_joint @ _CARRIED.T
        rate, change = self._rates
        turned = np.empty((3, n, JOINTS), dtype=complex)
        np.exp(1j * ((q - UPRIGHT) @ _CARRIED.T), out=turned[0])
        np.multiply(1j * rate, turned[0], out=turned[1])
        np.multiply(1j * change - rate * rate, turned[0], out=turned[2])
        self._links = turned[:, :, :-1] * masses.links[:-1]
        self.places: ComplexArray = turned @ masses.places_of_links
        self.places[0] += masses.ankle
        self._S: ComplexArray = turned @ masses.moments_of_links

    @cached_property
    def forces(self) -> FloatArray:
        """(3, 7, n) A, B and G."""
        masses, S = self._masses, self._S
        found = np.zeros((3, ROWS, S.shape[1]))
        # of each link, against what the next joint carries
        bend = self._links[0].conj() * S[1:, :, 1:] + S[0, :, 1:].conj() * self._links[1:]
        turning = self._rates * masses.second_moments
        turning[:, :, :-1] += bend.imag
        moment = turning @ _CARRIED
        force = S[1:, :, 0]
        found[:2, 0], found[:2, 1] = force.real, force.imag
        found[:2, 2] = moment[:, :, 0] + (masses.ankle.conjugate() * force).imag
        moment += (S[0].conj() * self.places[1:]).imag
        moment += masses.armature * self._by_joint
        found[:2, 3:] = moment.transpose(0, 2, 1)
        found[2, 1] = masses.mass
        found[2, 2] = S[0, :, 0].real + masses.foot_moment
        found[2, 3:] = S[0].real.T
        found[2] *= GRAVITY
        return found

    @cached_property
    def derivatives(self) -> CurveDerivatives:
        """Of `forces`, by the configuration and its derivatives at the same point."""
        S, p, n = self._S, self.places, self._S.shape[1]
        of_later, joint = (np.take(points[0], _LATER, axis=1) for points in (S.conj(), p))
        lever = joint.conj()
        lever[:, 1:] -= p[0].conj()[:, :, None]
        W = (lever * S[:, :, None] - of_later * p[:, :, None]).real
        # what a moment about the joint itself keeps, for the mass matrix and, of half the velocities' forces, its rate
        links, beyond = self._links[:2], S[:2, :, 1:]
        bend = (links[0].conj() * beyond + beyond[0].conj() * links).real
        own = np.zeros((2, n, JOINTS))
        own[:, :, :-1] = bend
        own[0] += self._masses.second_moments
        own = own @ _CARRIED + (S[0].conj() * p[:2]).real
        by_q, by_dq, by_ddq = np.zeros((3, n, ROWS, JOINTS)), np.empty((n, ROWS, JOINTS)), np.empty((n, ROWS, JOINTS))
        by_q[:2, :, 0], by_q[:2, :, 1], by_q[:2, :, 2:] = -S[1:].imag, S[1:].real, W[1:]
        by_q[2, :, 2:] = GRAVITY * of_later.imag
        by_ddq[:, 0], by_ddq[:, 1], by_ddq[:, 2:] = -S[0].imag, S[0].real, W[0] + own[0].take(_LATER, axis=1)
        by_ddq[:, 3:] += np.diag(self._masses.armature)
        by_dq[:, 0], by_dq[:, 1], by_dq[:, 2:] = -S[1].imag, S[1].real, W[1] + own[1].take(_LATER, axis=1)
        by_dq *= 2.0
        return CurveDerivatives(by_q, by_dq, by_ddq)


def _complex(points: FloatArray) -> ComplexArray:
    return points[:, 0] + 1j * points[:, 1]
