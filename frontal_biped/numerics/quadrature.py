"""Quadrature that starts at the reversal.

With beta = beta_r- - Delta tau^2, tau in [0, 1], the zero dynamics is smooth in tau although time is singular in
beta at the reversal. Every integral from the reversal then has the form

    int_0^tau r g(r) dr = tau^2 (Q g)(tau),     (Q g)(tau) = int_0^1 r g(tau r) dr

and Q, a dense matrix on the nodes, is free of cancellation near tau = 0.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.interpolate import BarycentricInterpolator

from frontal_biped.arrays import FloatArray


@dataclass(frozen=True)
class ReversalQuadrature:
    """Gauss-Lobatto nodes on [0, 1]: tau = 0 is the reversal, tau = 1 the impact.

    Attributes:
        tau: (n,) nodes, both ends included [-].
        weights: (n,) of int_0^1 f dtau [-].
        Q: (n, n) matrix of the operator above [-].
        barycentric: (n,) weights of the polynomial through the nodes [-].
    """

    tau: FloatArray
    weights: FloatArray
    Q: FloatArray
    barycentric: FloatArray

    @property
    def size(self) -> int:
        """Number of nodes."""
        return len(self.tau)


@lru_cache(maxsize=16)
def reversal_quadrature(size: int) -> ReversalQuadrature:
    """Nodes, weights and integration matrix with ``size`` nodes; exact for polynomials of degree size - 1."""
    tau = _lobatto_nodes(size)
    weights = 1.0 / (size * (size - 1) * np.polynomial.Legendre.basis(size - 1)(2.0 * tau - 1.0) ** 2)
    # int_0^1 r l_j(tau_i r) dr by Gauss quadrature, exact: the integrand has degree size
    r, w = np.polynomial.legendre.leggauss(size // 2 + 2)
    r, w = 0.5 * (r + 1.0), 0.5 * w
    # closed form at Gauss-Lobatto nodes; scipy would compute them in a random order, different in the last digits
    barycentric = np.where(np.arange(size) % 2, -1.0, 1.0) * np.sqrt(weights)
    cardinal = BarycentricInterpolator(tau, np.eye(size), wi=barycentric)
    values = cardinal(np.outer(tau, r).ravel()).reshape(size, len(r), size)
    Q = np.einsum("k,ikj->ij", w * r, values)
    return ReversalQuadrature(tau, weights, Q, barycentric)


def _lobatto_nodes(size: int) -> FloatArray:
    interior = np.polynomial.Legendre.basis(size - 1).deriv().roots()
    # one Newton step on P'_{n-1} takes the companion-matrix roots to full precision
    derivative = np.polynomial.Legendre.basis(size - 1).deriv()
    interior = np.sort(np.real(interior))
    interior = interior - derivative(interior) / derivative.deriv()(interior)
    nodes = np.concatenate([[-1.0], interior, [1.0]])
    return 0.5 * (0.5 * (nodes - nodes[::-1]) + 1.0)
