"""What a bound costs, and what a degree buys: series of designs, each started from the one before."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from frontal_biped.design.optimise import DesignResult, optimise_gait
from frontal_biped.gait.constraints import energy_margin, reversal_shift
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped


@dataclass(frozen=True)
class StudyPoint:
    """One design of a series.

    Attributes:
        value: of the key that varies.
        result: the design.
        measures: of its gait: "cost" [N^2 m s], "multiplier" [-], "energy_margin" [-], "reversal_shift" [rad],
            "clearance" [m], "pelvis_roll" [rad], "step_duration" [s]; empty without a gait.
    """

    value: Any
    result: DesignResult
    measures: dict[str, float]


def pareto_front(
    biped: FrontalBiped,
    specification: GaitSpecification,
    key: str,
    values: Sequence[Any],
    on_point: Callable[[StudyPoint], None] | None = None,
) -> tuple[StudyPoint, ...]:
    """The cheapest gaits under a bound that tightens: cost against robustness, or against any other key.

    Args:
        biped: the robot.
        specification: what stays.
        key: entry of the specification that varies, for example ``min_energy_margin``.
        values: in the order in which one gait starts the next.
        on_point: called after every design.
    """
    points: list[StudyPoint] = []
    start: Gait | None = None
    for value in values:
        changed = GaitSpecification.from_dict({**specification.as_dict(), key: value})
        result = optimise_gait(biped, changed, start=start)
        start = result.gait or start
        points.append(StudyPoint(value, result, _measures(biped, result)))
        if on_point is not None:
            on_point(points[-1])
    return tuple(points)


def cost_over(
    biped: FrontalBiped,
    specification: GaitSpecification,
    key: str,
    values: Sequence[float],
    on_point: Callable[[StudyPoint], None] | None = None,
) -> tuple[StudyPoint, ...]:
    """The cheapest gaits over one number: a bound, or a duration or width of the step, which is then exactly that.

    Args:
        biped: the robot.
        specification: what stays.
        key: entry of the specification, for example ``max_pelvis_roll`` or ``step_duration``.
        values: of the entry, in the order in which one gait starts the next.
        on_point: called after every design.

    Returns:
        Points whose ``value`` is the number.
    """
    interval = isinstance(getattr(specification, key, None), tuple) and key != "max_torque"
    told = (lambda point: on_point(replace(point, value=_number(point.value)))) if on_point is not None else None
    asked = [[value, value] if interval else value for value in values]
    points = pareto_front(biped, specification, key, asked, told)
    return tuple(replace(point, value=_number(point.value)) for point in points)


def degree_study(
    biped: FrontalBiped,
    specification: GaitSpecification,
    degrees: Sequence[int],
    fri_degrees: Sequence[int],
    on_point: Callable[[StudyPoint], None] | None = None,
) -> dict[int, tuple[StudyPoint, ...]]:
    """Cost over the degree of the joints, a series for each degree of the FRI.

    A polynomial is one of any higher degree too, so every gait starts the next one and the cost cannot rise.
    """
    series = {}
    for fri_degree in fri_degrees:
        fixed = GaitSpecification.from_dict({**specification.as_dict(), "fri_degree": fri_degree})
        series[fri_degree] = pareto_front(biped, fixed, "degree", degrees, on_point)
    return series


def _number(value: Any) -> float:
    return float(value[0]) if isinstance(value, list) else float(value)


def _largest_roll(biped: FrontalBiped, gait: Gait) -> float:
    angles = [phase.beta_start + np.linspace(0.0, 1.0, 201) * phase.range for phase in (gait.rising, gait.falling)]
    motions = [phase.motion(beta) for phase, beta in zip((gait.rising, gait.falling), angles, strict=True)]
    return float(max(np.max(np.abs(biped.pelvis_roll(motion.q))) for motion in motions))


def _measures(biped: FrontalBiped, result: DesignResult) -> dict[str, float]:
    if result.gait is None or result.report is None:
        return {}
    step = result.gait.step(biped)
    clearance = min(check.value for check in result.report.checks if check.code == "C05")
    return {
        "cost": result.gait.orbit.cost,
        "multiplier": result.gait.orbit.multiplier,
        "energy_margin": float(energy_margin(step)),
        "reversal_shift": float(reversal_shift(step)),
        "clearance": float(clearance),
        "pelvis_roll": _largest_roll(biped, result.gait),
        "step_duration": result.gait.orbit.step_duration,
    }
