"""Check a gait against C01 to C09 on a dense grid, far from the optimiser."""

from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

import numpy as np

from frontal_biped.files.shown import html_table
from frontal_biped.gait.constraints import Constraint, SoleHeights, holding_limits, sole_heights, step_constraints
from frontal_biped.gait.gait import MIN_NODES
from frontal_biped.gait.holding_wrench import StepHolding, step_holding
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.impact import Landing
from frontal_biped.virtual_constraints.phase import Phase, StepPhase
from frontal_biped.zero_dynamics.orbit import resample
from frontal_biped.zero_dynamics.poincare import StepOrbit

DENSER = 40
"""Intervals of the check for each of the `MIN_NODES` that an orbit is integrated on, which are the optimiser's."""

DENSE_POINTS = DENSER * MIN_NODES + 1
"""Points a phase of the check."""

FLAT_TOLERANCE = 1e-9
"""Height [m] at which a sole end counts as on the ground at impact (C04)."""

ROUNDING = 1e-9
"""Scaled violation that counts as rounding; needed where a bound is met exactly, as by step_width = [0.3, 0.3]."""


AT_ITS_BOUND = 1e-3
"""Scaled margin below which a report calls a constraint at its bound; the optimiser keeps a ten-thousandth of it."""

TOLD = 4
"""Constraints at their bounds that a line names."""


@dataclass(frozen=True)
class ConstraintCheck:
    """One line of the report: the worst point of one constraint.

    Attributes:
        code: C01..C09, or a key of the specification.
        name: what is bounded.
        unit: of value and bound.
        value: at the worst point.
        bound: the nearer bound.
        margin: distance to it, positive inside.
        scale: a typical size of the quantity.
        satisfied: margin >= 0 but for rounding, or > 0 where the bound itself is excluded.
    """

    code: str
    name: str
    unit: str
    value: float
    bound: float
    margin: float
    scale: float
    satisfied: bool

    @property
    def tightness(self) -> float:
        """Margin in units of the scale; nan, where the orbit does not exist, is the tightest of all [-]."""
        return -np.inf if np.isnan(self.margin) else self.margin / self.scale

    def __str__(self) -> str:
        row = f"{self.code:15} {self.name:43} {self.value:12.6g} {self.bound:10.4g} {self.margin:11.3g}"
        return f"{row} {self.unit}"


@dataclass(frozen=True)
class ConstraintReport:
    """All constraints of a specification on one gait.

    Attributes:
        checks: one per constraint.
        points: grid points a phase.
    """

    checks: tuple[ConstraintCheck, ...]
    points: int

    @property
    def satisfied(self) -> bool:
        """Do all constraints hold?"""
        return all(check.satisfied for check in self.checks)

    @property
    def shortfall(self) -> dict[tuple[str, str], float]:
        """Scaled violations by code and name, for `DesignProblem.tighten`."""
        return {(check.code, check.name): -check.margin / check.scale for check in self.violated}

    @property
    def violated(self) -> tuple[ConstraintCheck, ...]:
        """Those that do not, the worst first."""
        missed = [check for check in self.checks if not check.satisfied]
        return tuple(sorted(missed, key=lambda check: check.tightness))

    @property
    def tightest(self) -> str:
        """The violated constraints, else those at their bounds, else the one with the least margin, in one line."""
        if self.violated:
            return _listed(
                "VIOLATED: ", [f"{c.code} {c.name} {_of(c.value, c)}, bound {_of(c.bound, c)}" for c in self.violated]
            )
        order = sorted(self.checks, key=lambda check: check.tightness)
        bounding = [check for check in order if check.tightness < AT_ITS_BOUND]
        if bounding:
            return _listed("at the bound: ", [f"{c.code} {c.name} {_of(c.bound, c)}" for c in bounding])
        least = order[0]
        return (
            f"{least.code} {least.name} {_of(least.value, least)}, bound {_of(least.bound, least)},"
            f" margin {_of(least.margin, least)}"
        )

    def __repr__(self) -> str:
        return f"ConstraintReport: {len(self.checks)} constraints on {self.points} points a phase; {self.tightest}"

    def _repr_html_(self) -> str:
        return html_table(
            [
                (c.code, c.name, f"{c.value:.6g}", f"{c.bound:.4g}", f"{c.margin:.3g}", c.unit, _kept(c))
                for c in self.checks
            ],
            ("", "constraint", "value", "bound", "margin", "unit", ""),
        )

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "satisfied": self.satisfied,
            "grid_points_per_phase": self.points,
            "checks": [asdict(check) for check in self.checks],
        }

    def __str__(self) -> str:
        head = f"{'':15} {'constraint':43} {'value':>12} {'bound':>10} {'margin':>11}"
        return "\n".join([head, *(f"{check}  {_kept(check)}".rstrip() for check in self.checks)])


def _kept(check: ConstraintCheck) -> str:
    return "" if check.satisfied else "VIOLATED"


def _of(value: float, check: ConstraintCheck) -> str:
    return f"{value:.4g} {check.unit}".removesuffix(" -")


def _listed(head: str, items: list[str]) -> str:
    more = f"; and {len(items) - TOLD} more" if len(items) > TOLD else ""
    return head + "; ".join(items[:TOLD]) + more


def check_constraints(
    biped: FrontalBiped,
    specification: GaitSpecification,
    rising: Phase,
    falling: Phase,
    step: StepOrbit,
    points: int = DENSE_POINTS,
    departure: Landing | None = None,
) -> ConstraintReport:
    """Evaluate every constraint on a grid of ``points`` a phase, uniform in tau from the reversal to the impact.

    Args:
        biped: the robot.
        specification: the bounds.
        rising: virtual constraints of the rising phase.
        falling: virtual constraints of the falling phase.
        step: the step on converged quadrature nodes.
        points: of the grid, both ends included.
        departure: the impact that the step begins with, where it is not the one it ends with.

    Raises:
        RobotError: the holding wrench is bounded, and the length of the soles is not known.
    """
    dense = _on_grid(biped, rising, falling, step, points)
    soles = SoleHeights(*(sole_heights(biped, orbit.motion.q) for orbit in dense[:2]))
    holding = step_holding(biped, dense) if specification.bounds_holding_wrench else None
    # the duration is an integral and keeps the accuracy of the quadrature
    constraints = step_constraints(biped, specification, dense, soles, step.duration, departure, holding)
    checks = [worst_point(constraint) for constraint in constraints]
    ends = biped.swing_sole(step.falling.motion.q[-1])[:, 1]
    flat = float(np.max(np.abs(ends)))
    on_ground = ConstraintCheck(
        "C04",
        "both sole ends on the ground at impact",
        "m",
        flat,
        FLAT_TOLERANCE,
        FLAT_TOLERANCE - flat,
        FLAT_TOLERANCE,
        flat <= FLAT_TOLERANCE,
    )
    first_c04 = next(i for i, check in enumerate(checks) if check.code == "C04")
    checks.insert(first_c04, on_ground)
    return ConstraintReport(tuple(checks), points)


class HoldingCheck(NamedTuple):
    """What the ground must hold when the whole robot walks a gait, asked for or not.

    Attributes:
        holding: the wrenches on the grid.
        checks: against the bounds that the specification has or, where it has none, the whole sole and `friction`.
    """

    holding: StepHolding
    checks: tuple[ConstraintCheck, ...]


def check_holding(
    biped: FrontalBiped,
    specification: GaitSpecification,
    rising: Phase,
    falling: Phase,
    step: StepOrbit,
    points: int = DENSE_POINTS,
) -> HoldingCheck:
    """The rows on the holding wrench, on the grid of `check_constraints`, whether they are asked for or not.

    Raises:
        RobotError: the length of the soles is not known.
    """
    holding = step_holding(biped, _on_grid(biped, rising, falling, step, points))
    friction = specification.friction if specification.yaw_friction is None else specification.yaw_friction
    limits = [
        holding_limits(wrenches, specification.cop_margin_x or 0.0, friction, phase.value)
        for wrenches, phase in zip(holding, StepPhase, strict=True)
    ]
    found = [limit for pair in zip(*limits, strict=True) for limit in pair if limit is not None]
    return HoldingCheck(holding, tuple(worst_point(limit) for limit in found))


def _on_grid(biped: FrontalBiped, rising: Phase, falling: Phase, step: StepOrbit, points: int) -> StepOrbit:
    tau = np.linspace(0.0, 1.0, points)
    up, down = resample(biped, rising, step.rising, tau), resample(biped, falling, step.falling, tau)
    return step._replace(rising=up, falling=down)


def worst_point(constraint: Constraint) -> ConstraintCheck:
    """A constraint at the point where the least is left of it."""
    values = np.atleast_1d(constraint.values)
    candidates = []
    for bound, sign in constraint.sides():
        margins = sign * (values - bound)
        worst = int(margins.argmin())  # nan, where the orbit does not exist, is the least to NumPy
        candidates.append((float(margins[worst]) + 0.0, float(values[worst]), float(bound)))  # + 0.0: no -0
    margin, value, bound = min(candidates, key=lambda row: -np.inf if np.isnan(row[0]) else row[0])
    rounding = ROUNDING * constraint.scale
    satisfied = margin > 0.0 if constraint.strict else margin >= -rounding
    code, name, unit, scale = constraint.code, constraint.name, constraint.unit, constraint.scale
    return ConstraintCheck(code, name, unit, value, bound, margin, scale, bool(satisfied))
