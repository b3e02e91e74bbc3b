"""What proofs of a gait's limits and of its basins ask, as data: bounds with their tolerances, transitions, the law."""

from frontal_biped.control.stabilisers.ankle_law import ROOM_LOOKS, SOLE_MARGIN
from frontal_biped.control.stabilisers.look_ahead import NEAR
from frontal_biped.control.stabilisers.transitions import ENOUGH_INERTIA, LOOKS, REJOINS, ReanchoringTransitions
from frontal_biped.gait.check import FLAT_TOLERANCE, ROUNDING
from frontal_biped.gait.constraints import SoleHeights, sole_heights, step_constraints
from frontal_biped.gait.gait import MIN_NODES, Gait
from frontal_biped.gait.holding_wrench import step_holding
from frontal_biped.gait.margins import ContactMargins
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.zero_dynamics.half_steps import STRETCH, STRETCHES
from frontal_biped.zero_dynamics.proof.ankle_steps import AnkleRule
from frontal_biped.zero_dynamics.proof.limits import BallOrbit, Bound
from frontal_biped.zero_dynamics.proof.perturbed_steps import PerturbedSteps, Rejoining
from frontal_biped.zero_dynamics.proof.reversals import Tapers


def asked_bounds(biped: FrontalBiped, gait: Gait) -> list[Bound]:
    """The bounds that `gait.check` asks for, with the tolerances it allows.

    Args:
        biped: the robot.
        gait: the gait.

    Raises:
        RobotError: the holding wrench is bounded, and the length of the soles is not known.
    """
    return _bounds(biped, gait, gait.specification)


INSIDE = 1e-9
"""Share that is left out of `NEAR`, for the speed it is compared with is a rounded one."""

CONTACT = ("C04", "C05", "C06", "C07", "C08")
"""Codes of the bounds that the restricted map keeps."""


def perturbed_steps(biped: FrontalBiped, gait: Gait, orbit: BallOrbit) -> PerturbedSteps:
    """Steps of a gait under the stabiliser "re-anchored", which its basin is proved of.

    Args:
        biped: the robot.
        gait: the gait.
        orbit: its periodic orbit.
    """
    planned = ReanchoringTransitions(biped, gait, anticipate=False).planned_rising
    tapers = Tapers(planned.taper, planned.curvature_taper, planned.fri_taper)
    # the last one joins at the impact, whatever it is
    rejoining = Rejoining(REJOINS[:-1], ENOUGH_INERTIA, LOOKS)
    return PerturbedSteps(orbit, tapers, rejoining, contact_bounds(biped, gait), NEAR * (1.0 - INSIDE))


ANKLE_RULE = AnkleRule(SOLE_MARGIN, ROOM_LOOKS, STRETCH, STRETCHES)
"""How the stabiliser "ankle" chooses, which a basin of its own is proved of."""


def contact_bounds(biped: FrontalBiped, gait: Gait) -> list[Bound]:
    """The bounds that the restricted map keeps (`gait.margins.ContactMargins`): without the reserves of a plan."""
    limits = ContactMargins(biped, gait).limits
    return [bound for bound in _bounds(biped, gait, limits) if bound.code in CONTACT]


def _bounds(biped: FrontalBiped, gait: Gait, specification: GaitSpecification) -> list[Bound]:
    # the bounds are those of the specification and the robot, whatever the points are
    step = gait.step(biped, MIN_NODES)
    soles = SoleHeights(*(sole_heights(biped, orbit.motion.q) for orbit in step[:2]))
    holding = step_holding(biped, step) if specification.bounds_holding_wrench else None
    found = [
        Bound(c.code, c.name, c.unit, c.lower, c.upper, c.strict, 0.0 if c.strict else ROUNDING * c.scale)
        for c in step_constraints(biped, specification, step, soles, holding=holding)
    ]
    flat = Bound("C04", "both sole ends on the ground at impact", "m", None, FLAT_TOLERANCE, False, 0.0)
    found.insert(next(i for i, bound in enumerate(found) if bound.code == "C04"), flat)
    return found
