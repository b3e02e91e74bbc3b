"""What travelling sideways costs, and how fast it can be: series of designs, each started from the one before.

Speed is travel over the time of two steps, and has two ways to grow: farther, or sooner. So the fastest gait is looked
for over both: for each of some step durations the travel grows as far as the bounds allow.

On the Table I robot under the default specification, certified on the dense grid; int u'u dt for each metre in N^2 m s:

    travel in two steps        0.02 m           0.06 m           0.12 m            0.2 m
    steps up to 0.8 s    8190 at 0.013 m/s  4839 at 0.038   5805 at 0.075    8118 at 0.129
    steps up to 0.6 s   11699 at 0.017 m/s  7287 at 0.050   8073 at 0.100   10347 at 0.167
    steps up to 0.5 s   14091 at 0.020 m/s  9238 at 0.060  10096 at 0.120   15885 at 0.200

Slow travel is dear for each metre, since stepping costs torque without it; fast travel is, since J grows faster than
the speed. The fastest found travel 0.2 m, all the room that step_width leaves, in two steps of 0.475 s, 0.2105 m/s at
J = 16548 N^2 m s; with 0.45 s no more than 0.1875 m are reached. Near the end of the room gaits land on a steep swing
foot and fall under the walker, torques held for 1 ms. The fastest of those tried that walks 50 steps in both engines
travels 0.15 m in two steps of 0.5 s, 0.15 m/s; with max_foot_rotation = 0.05 it is 0.2 m in two of 0.6 s, 0.167 m/s.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frontal_biped.design.optimise import OPTIMISER_NODES, SAFETY, optimise_gait
from frontal_biped.design.sideways import Candidate, TwoStepSearch, gait_at
from frontal_biped.design.two_step_problem import TwoStepProblem
from frontal_biped.gait.sideways import SidewaysGait
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped


@dataclass(frozen=True)
class TravelPoint:
    """One design of a series.

    Attributes:
        travel: asked for [m per two steps].
        longest_step: asked for [s].
        gait: the cheapest, C01 to C09 kept on the dense grid; None where there is none.
        message: one line: the tightest constraints, or what stands in the way.
    """

    travel: float
    longest_step: float
    gait: SidewaysGait | None
    message: str


Tell = Callable[[TravelPoint], None]
"""Called after every design."""


# a nearest point without an orbit is told by its values, not by warnings
@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def cost_of_travel(
    biped: FrontalBiped, specification: GaitSpecification, travels: Sequence[float], on_point: Tell | None = None
) -> tuple[TravelPoint, ...]:
    """The cheapest gaits over the travel.

    Args:
        biped: the robot.
        specification: what stays; its travel does not.
        travels: [m per two steps], in the order in which one gait starts the next.
        on_point: called after every design.
    """
    search, points = TwoStepSearch(biped), []
    problem = TwoStepProblem(biped, replace(specification, travel=0.0), OPTIMISER_NODES, SAFETY)
    one = optimise_gait(biped, replace(specification, travel=None), advise=False).gait
    start = problem.step.start() if one is None else problem.step.variables(one)
    x, reached = problem.joined(start, start), 0.0
    for travel in travels:
        for candidate in search.along(replace(specification, travel=travel), x, reached):
            if candidate.good and candidate.closed is not None:
                x, reached = candidate.closed.x, candidate.problem.travel
        points.append(_point(candidate, travel))
        if on_point is not None:
            on_point(points[-1])
    return tuple(points)


def fastest_travel(
    biped: FrontalBiped, specification: GaitSpecification, longest_steps: Sequence[float], on_point: Tell | None = None
) -> tuple[TravelPoint, ...]:
    """The farthest travel for each of some step durations: the fastest of their gaits is the fastest found.

    Args:
        biped: the robot.
        specification: what stays; the widths leave room for the farthest travel of all.
        longest_steps: upper bounds of the step duration [s].
        on_point: called after every duration.

    Returns:
        For each duration the gait of the farthest travel that was reached, to 2.5 mm; the message says what ended it.
    """
    narrowest, widest = specification.step_width
    points = []
    for longest in longest_steps:
        shortest = min(specification.step_duration[0], longest)
        asked = replace(specification, step_duration=(shortest, longest), travel=widest - narrowest)
        last: list[TravelPoint] = []

        def keep(point: TravelPoint, last: list[TravelPoint] = last) -> None:
            last.append(point)

        farthest(biped, asked, keep)
        best = max(
            (point for point in last if point.gait is not None), key=lambda point: point.travel, default=last[-1]
        )
        points.append(replace(best, message=last[-1].message))
        if on_point is not None:
            on_point(points[-1])
    return tuple(points)


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def farthest(biped: FrontalBiped, specification: GaitSpecification, on_point: Tell) -> None:
    """Follow the cheapest gaits towards the travel of a specification, as far as they go.

    Args:
        biped: the robot.
        specification: where the way leads.
        on_point: called with every gait on the way, and with the first travel that has none.
    """
    search = TwoStepSearch(biped)
    problem = TwoStepProblem(biped, replace(specification, travel=0.0), OPTIMISER_NODES, SAFETY)
    one = optimise_gait(biped, replace(specification, travel=None), advise=False).gait
    start = problem.step.start() if one is None else problem.step.variables(one)
    for candidate in search.along(specification, problem.joined(start, start)):
        on_point(_point(candidate, candidate.problem.travel))


def _point(candidate: Candidate, travel: float) -> TravelPoint:
    longest = candidate.problem.specification.step_duration[1]
    if candidate.good and candidate.closed is not None and candidate.report is not None:
        gait = gait_at(candidate.problem, candidate.closed) if candidate.problem.travel == travel else None
        return TravelPoint(travel, longest, gait, candidate.report.tightest)
    report = candidate.report
    violated = report is not None and bool(report.violated)
    why = report.tightest if violated and report is not None else candidate.result.message
    return TravelPoint(travel, longest, None, candidate.obstacle or why)
