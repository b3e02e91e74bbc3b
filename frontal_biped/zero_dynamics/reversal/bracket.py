"""The reversal point for given Bezier parameters: where it can lie, that it exists, where it is.

For fixed parameters, Z(beta) of [O] eq. marginalcond is evaluated with the phases' own polynomials, the rising one
ending and the falling one starting at beta instead of where they plan to. [O] Sec. III-E: a reversal point lies in
]beta_r+, beta_r^max[, where beta_r^max brings the centre of mass over the FRI target with the joints frozen in the
pose of the reversal; Z is positive just above beta_r+ (the robot arrives with energy and has not risen yet), so a
negative value further on proves by continuity that one exists.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from frontal_biped.exceptions import ReversalError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.phase import Phase
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics, step_orbit

SCAN_POINTS = 64  # of the search for a change of sign
ROOT_TOLERANCE = 1e-14  # [rad]


@dataclass(frozen=True)
class ReversalAnalysis:
    """Where the step reverses.

    Attributes:
        bracket: beta_r+ and beta_r^max [rad].
        defined_to: largest scanned beta at which Z is defined: beyond it I_P changes sign [rad].
        exists: was a change of sign of Z, from positive to negative, found in the bracket?
        sign_changes: changes of sign of Z, either way, found on the scanned points; more than one means that the
            reversal point is not unique, one does not prove that it is.
        beta: the zero nearest to the planned reversal [rad]; nan where none was found.
        planned: beta_r- of the phases [rad].
        sign_change: two values of beta between which Z changes sign [rad]; nan where none was found.
        zeta_residual: |rho_r(zeta_f*)| at ``beta`` relative to the energy taken by the rising phase (HIP1) [-].
        acceleration: ddbeta at ``beta``, negative at a reversal (HIP2) [rad/s^2].
        com_offset: p_cm_h - p_FRI at ``beta``, positive at a reversal [m].
    """

    bracket: tuple[float, float]
    defined_to: float
    exists: bool
    sign_changes: int
    beta: float
    planned: float
    sign_change: tuple[float, float]
    zeta_residual: float
    acceleration: float
    com_offset: float

    @property
    def is_reversal(self) -> bool:
        """HIP1 and HIP2: halted there, and turning back."""
        return bool(self.exists and self.zeta_residual < 1e-9 and self.acceleration < 0.0 and self.com_offset > 0.0)


def marginal_condition(
    biped: FrontalBiped, rising: Phase, falling: Phase, step_width: float, nodes: int
) -> Callable[[float], float]:
    """Z(beta) for fixed Bezier parameters [kg^2 m^4/s^2]; nan where the zero dynamics is not defined up to beta."""

    def Z(beta: float) -> float:
        try:
            with np.errstate(over="ignore", invalid="ignore"):  # beyond a zero of I_P: found just below
                step = step_orbit(biped, rising, falling, step_width, nodes, beta)
        except ReversalError:
            return float("nan")
        if np.any(step.rising.restricted.I_P <= 0.0) or np.any(step.falling.restricted.I_P <= 0.0):
            return float("nan")
        return HybridZeroDynamics(biped, step).marginal_condition

    return Z


def beta_maximum(biped: FrontalBiped, rising: Phase) -> float:
    """beta_r^max: joints frozen in the reversal pose, the centre of mass above the FRI target [rad].

    Raises:
        ReversalError: the centre of mass never gets there before beta = 0.
    """
    end = rising.motion(np.array([rising.beta_end]))
    pose, p_fri = end.q[0], float(end.p_fri[0])

    def offset(beta: float) -> float:
        frozen = pose.copy()
        frozen[0] = beta
        return float(biped.com(frozen)[0]) - p_fri

    # turning the frozen robot about its ankle moves the centre of mass on a circle: down to beta = 0 it crosses once
    if offset(rising.beta_end) <= 0.0:
        raise ReversalError(
            f"the centre of mass is already outside the FRI target at the planned reversal {rising.beta_end:.6g} rad"
        )
    high = rising.beta_end
    while high < 0.0:
        high += 0.1
        if offset(high) < 0.0:
            return float(brentq(offset, high - 0.1, high, xtol=ROOT_TOLERANCE))
    raise ReversalError("the centre of mass stays inside the FRI target for every beta below 0")


def analyse_reversal(
    biped: FrontalBiped, rising: Phase, falling: Phase, step_width: float, nodes: int
) -> ReversalAnalysis:
    """Find the reversal point in the bracket and check HIP1 and HIP2.

    Args:
        biped: the robot.
        rising: virtual constraints of the rising phase.
        falling: virtual constraints of the falling phase.
        step_width: distance between the ankles [m].
        nodes: quadrature nodes a phase.
    """
    low, high = rising.beta_start, beta_maximum(biped, rising)
    Z = marginal_condition(biped, rising, falling, step_width, nodes)
    planned = rising.beta_end
    # the planned point divides the bracket, so that its neighbourhood is scanned at the scale of the rising phase
    reach = max(0.0, planned - low)
    grid = np.unique(
        np.concatenate(
            [
                low + (high - low) * np.linspace(0.0, 1.0, SCAN_POINTS + 2)[1:-1],
                planned + reach * np.linspace(-0.5, 0.5, SCAN_POINTS),  # an even number: not the point itself
            ]
        )
    )
    grid = grid[(grid > low) & (grid < high)]
    values = np.array([Z(beta) for beta in grid])
    defined = np.isfinite(values)
    defined_to = float(grid[defined][-1]) if np.any(defined) else float("nan")
    changes = [i for i in range(len(grid) - 1) if defined[i] and defined[i + 1] and values[i] >= 0.0 > values[i + 1]]
    signs = np.sign(values[defined])
    sign_changes = int(np.sum(signs[1:] != signs[:-1]))
    if not changes:
        nan = float("nan")
        return ReversalAnalysis((low, high), defined_to, False, sign_changes, nan, planned, (nan, nan), nan, nan, nan)
    nearest = min(changes, key=lambda i: abs(0.5 * (grid[i] + grid[i + 1]) - planned))
    left, right = float(grid[nearest]), float(grid[nearest + 1])
    beta = float(brentq(Z, left, right, xtol=ROOT_TOLERANCE, rtol=4.0 * np.finfo(float).eps))
    step = step_orbit(biped, rising, falling, step_width, nodes, beta)
    hzd = HybridZeroDynamics(biped, step)
    # kappa_2 = -m g (p_cm_h - p_FRI)
    offset = -float(step.rising.restricted.kappa_2[0]) / biped.weight
    return ReversalAnalysis(
        bracket=(low, high),
        defined_to=defined_to,
        exists=True,
        sign_changes=sign_changes,
        beta=beta,
        planned=planned,
        sign_change=(left, right),
        zeta_residual=abs(hzd.rho_r(hzd.fixed_point)) / abs(hzd.barrier_r),
        acceleration=float(step.rising.ddbeta[0]),
        com_offset=offset,
    )
