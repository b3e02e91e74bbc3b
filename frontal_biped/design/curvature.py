"""Second derivatives for `trust_region_sqp`: what the squares tell, and secants for what they do not.

The Gauss-Newton matrix of a sum of squares needs first derivatives alone. It does not see how residuals and
constraints bend; what a step has found out about that is added by a damped BFGS update.
"""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.local_model import Model, Multipliers, PointEvaluation

REGULAR = 1e-6
"""Added to the diagonal of a Gauss-Newton matrix, which may be singular."""

DAMPED = 0.2
"""Least share of the curvature so far that Powell's damping leaves along a step."""

LEAST_PIVOT = 1e-9
"""Of an update's squared pivots, smallest over largest: programs with less of it are solved for rounding, at length."""


def gauss_newton(point: PointEvaluation, scale: FloatArray, cost_scale: float) -> FloatArray:
    """(P, P) Hessian of the scaled cost, in scaled variables, of residuals that do not bend.

    Args:
        point: where.
        scale: (P,) of the variables.
        cost_scale: of the cost.
    """
    R = point.residual_jacobian * scale
    # einsum, not a BLAS product: the digits must not depend on the number of threads
    return 2.0 * cost_scale * np.einsum("ri,rj->ij", R, R) + REGULAR * np.eye(len(scale))


def updated(model: Model, seen: FloatArray, step: FloatArray, trial: PointEvaluation, price: Multipliers) -> FloatArray:
    """(P, P) Hessian of the Lagrangian after a step: Powell's damped BFGS update of a model's.

    Of the matrix so far with ``seen``, what Gauss-Newton has seen change on the way, so that updates add up to what it
    does not see (a structured secant, cf. Nocedal and Wright, Sec. 10.3); or, where that is not convex, of the matrix
    so far.

    Args:
        model: where the step began.
        seen: (P, P) change of the Gauss-Newton matrix.
        step: (P,) scaled.
        trial: where it ended.
        price: multipliers of its program.
    """
    change = _lagrangian_gradient(model, trial, price) - _lagrangian_gradient(model, model.point, price)
    for hessian in (model.hessian + seen, model.hessian):
        found = _damped_bfgs(hessian, step, change)
        if found is not None:
            return found
    return model.hessian


def _lagrangian_gradient(model: Model, point: PointEvaluation, price: Multipliers) -> FloatArray:
    """(P,) in scaled variables."""
    gradient = model.cost_scale * point.cost_gradient
    pushing = np.flatnonzero(price.margins)
    gradient = gradient - price.margins[pushing] @ point.margins_jacobian[pushing]
    return (gradient - price.equality @ point.equality_jacobian) * model.scale


def _damped_bfgs(hessian: FloatArray, step: FloatArray, change: FloatArray) -> FloatArray | None:
    """A Hessian (P, P) after a step (P,) that changed the gradient by ``change``; None if not positive definite."""
    Hs = hessian @ step
    curvature, along = float(step @ Hs), float(step @ change)
    if curvature <= 0.0:
        return None
    if along < DAMPED * curvature:
        blend = (1.0 - DAMPED) * curvature / (curvature - along)
        change = blend * change + (1.0 - blend) * Hs
        along = float(step @ change)
    found = hessian - np.outer(Hs, Hs) / curvature + np.outer(change, change) / along
    try:
        pivots = np.diagonal(np.linalg.cholesky(found)) ** 2
    except np.linalg.LinAlgError:
        return None
    return found if np.min(pivots) > LEAST_PIVOT * np.max(pivots) else None
