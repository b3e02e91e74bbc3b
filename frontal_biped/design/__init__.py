"""Gait design: problem, optimiser, explanation, continuation, transitions, studies.

A design minimises J over 31 variables (hybrid invariance is eliminated; degrees 5 and 3) with exact derivatives:
forward mode through the closed form, Pinocchio's RNEA derivatives underneath. The optimiser is a trust-region SQP with
elastic, exactly solved subproblems: Gauss-Newton on the sum of squares, then BFGS. What it finds is closed to rounding,
checked on a grid forty times denser, and simulated for a step in the full model: that is `optimise_gait`. `design_gait`
has the result walk 20 steps under its walker, in our simulator and in MuJoCo, before it is called a gait, and tightens
the specification where it falls. Equal input gives equal bytes, whatever the number of threads. The design is not
convex: what is found is a local optimum.

Where three starts lead to no gait, it says why not: it names the constraints that contradict each other at the nearest
point, by how much each is missed, and a change of one entry that was tried and leaves a gait:

    frontal-biped: no gait: frontal_biped: no gait was found; where the search ended these contradict each other: ...;
    relax step_width[1] from 0.35 to 0.51 first: tried, a gait exists then

Start where you like: ``frontal-biped design --start G.json``, ``--attempts 10``; `follow_branch` continues a gait to
another specification and says where its branch ends; `pareto_front` and `degree_study` design series.
"""

from frontal_biped.design.continuation import Branch, follow_branch
from frontal_biped.design.explanation import Conflict, Remedy
from frontal_biped.design.optimise import DesignResult, optimise_gait
from frontal_biped.design.sideways import SidewaysResult, design_sideways_gait
from frontal_biped.design.sideways_studies import TravelPoint, cost_of_travel, fastest_travel
from frontal_biped.design.studies import StudyPoint, cost_over, degree_study, pareto_front
from frontal_biped.design.tightening import Tightening
from frontal_biped.design.transition import Transition, design_transition
from frontal_biped.design.verification import Verification, verify
from frontal_biped.design.walk_trial import WalkTrial, try_walk
from frontal_biped.design.walking_gait import design_gait

__all__ = [
    "Branch",
    "Conflict",
    "DesignResult",
    "Remedy",
    "SidewaysResult",
    "StudyPoint",
    "Transition",
    "TravelPoint",
    "Verification",
    "cost_of_travel",
    "cost_over",
    "degree_study",
    "Tightening",
    "WalkTrial",
    "design_gait",
    "design_sideways_gait",
    "design_transition",
    "fastest_travel",
    "follow_branch",
    "optimise_gait",
    "pareto_front",
    "try_walk",
    "verify",
]
