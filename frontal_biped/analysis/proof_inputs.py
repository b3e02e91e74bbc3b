"""What proofs of a gait's limits and of its basins ask, as data: bounds with their tolerances, transitions, the law."""

from collections.abc import Mapping

from frontal_biped.control.stabilisers.ankle_law import ROOM_LOOKS, SOLE_MARGIN
from frontal_biped.control.stabilisers.look_ahead import NEAR, LookAheadTransitions, made_for
from frontal_biped.control.stabilisers.transitions import ENOUGH_INERTIA, LOOKS, REJOINS, ReanchoringTransitions
from frontal_biped.gait.check import FLAT_TOLERANCE, ROUNDING
from frontal_biped.gait.constraints import HEIGHT, IMPULSE, SPEED, SoleHeights, sole_heights, step_constraints
from frontal_biped.gait.gait import MIN_NODES, Gait
from frontal_biped.gait.holding_wrench import step_holding
from frontal_biped.gait.look_ahead_table import Way
from frontal_biped.gait.margins import ContactMargins
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.zero_dynamics.half_steps import STRETCH, STRETCHES
from frontal_biped.zero_dynamics.proof.ankle_steps import AnkleRule
from frontal_biped.zero_dynamics.proof.choice_intervals import Choice
from frontal_biped.zero_dynamics.proof.limits import BallOrbit, Bound
from frontal_biped.zero_dynamics.proof.perturbed_steps import PerturbedSteps, Rejoining, Reserve
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
"""Share that is left out of `NEAR`, and added to the reserve, for what they are compared with is rounded."""

MARGINS = {
    "F_v / m g": "normal force",
    "F_h / F_v": "friction",
    "FRI in the sole": "FRI in the sole",
    "sole height / (1 - t2)": "swing foot clearance",
    "touchdown speed of both sole ends": "touchdown speed",
    "normal impulse / m": "normal impulse",
    "L_h / L_v": "impulse in the friction cone",
    "impulse in the sole": "impulse in the sole",
    "lift-off speed of the old stance sole": "lift-off of the old stance foot",
}
"""Names that `gait.margins` gives to what `gait.constraints` bounds; torques have one for all."""

SCALES = {"swing foot clearance": HEIGHT, "normal impulse": IMPULSE, "touchdown speed": SPEED} | {
    "lift-off of the old stance foot": SPEED
}
"""Units of those margins that are no share of what the limit leaves."""

FLAT = "both sole ends on the ground at impact"
"""What C04 asks of the final pose, whatever the motion."""

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
    return PerturbedSteps(orbit, tapers, rejoining, contact_bounds(biped, gait), reserve(biped, gait))


def reserve(biped: FrontalBiped, gait: Gait) -> Reserve:
    """When the stabiliser "adaptive" answers as "re-anchored": the numbers of `control.stabilisers.look_ahead`."""
    required = LookAheadTransitions(biped, gait, look_up=False).required
    bounds = [_kept_within(bound, required, biped) for bound in contact_bounds(biped, gait) if bound.name != FLAT]
    return Reserve(NEAR * (1.0 - INSIDE), bounds)


def _kept_within(bound: Bound, required: Mapping[str, float], biped: FrontalBiped) -> Bound:
    """A limit with the margin that is required of it."""
    name, comma, phase = bound.name.partition(", ")
    margin = "torque" if name.endswith(" torque") else MARGINS[name]
    if margin == "torque":
        unit = bound.upper or 0.0
    elif margin in ("FRI in the sole", "impulse in the sole"):
        unit = biped.sole[1] - biped.sole[0]
    else:
        unit = SCALES.get(margin, 1.0)
    distance = (required[margin + comma + phase] + INSIDE) * unit
    lower = None if bound.lower is None else bound.lower + distance
    upper = None if bound.upper is None else bound.upper - distance
    return bound._replace(lower=lower, upper=upper, strict=False, tolerance=0.0)


def choices(biped: FrontalBiped, gait: Gait) -> list[Choice]:
    """The answers of the gait's table, if it has one that was made for it, by the method there is."""
    table = gait.look_ahead
    if table is None or table.made_for != made_for(biped, gait):
        return []
    law, found = LookAheadTransitions(biped, gait), []
    for low, high, choice, reversals in zip(table.low, table.high, table.choices, table.reversals, strict=True):
        stretch, descent = choice
        rising = law.planned(stretch)
        tapers = Tapers(rising.taper, rising.curvature_taper, rising.fri_taper)
        c = None if descent.rejoin is None else REJOINS[descent.rejoin]
        past_end = (float(reversals[0]) - rising.beta_end, float(reversals[1]) - rising.beta_end)
        found.append(Choice(float(low), float(high), stretch, tapers, descent.way is Way.RESCALED, c, past_end))
    return found


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
    flat = Bound("C04", FLAT, "m", None, FLAT_TOLERANCE, False, 0.0)
    found.insert(next(i for i, bound in enumerate(found) if bound.code == "C04"), flat)
    return found
