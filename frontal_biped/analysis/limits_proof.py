"""C01 to C09 of a gait's specification as bounds to be proved of its whole orbit (`zero_dynamics.proof.limits`)."""

from frontal_biped.gait.check import FLAT_TOLERANCE, ROUNDING
from frontal_biped.gait.constraints import SoleHeights, sole_heights, step_constraints
from frontal_biped.gait.gait import MIN_NODES, Gait
from frontal_biped.gait.holding_wrench import step_holding
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.zero_dynamics.proof.limits import Bound


def asked_bounds(biped: FrontalBiped, gait: Gait) -> list[Bound]:
    """The bounds that `gait.check` asks for, with the tolerances it allows.

    Args:
        biped: the robot.
        gait: the gait.

    Raises:
        RobotError: the holding wrench is bounded, and the length of the soles is not known.
    """
    # the bounds are those of the specification and the robot, whatever the points are
    specification, step = gait.specification, gait.step(biped, MIN_NODES)
    soles = SoleHeights(*(sole_heights(biped, orbit.motion.q) for orbit in step[:2]))
    holding = step_holding(biped, step) if specification.bounds_holding_wrench else None
    found = [
        Bound(c.code, c.name, c.unit, c.lower, c.upper, c.strict, 0.0 if c.strict else ROUNDING * c.scale)
        for c in step_constraints(biped, specification, step, soles, holding=holding)
    ]
    flat = Bound("C04", "both sole ends on the ground at impact", "m", None, FLAT_TOLERANCE, False, 0.0)
    found.insert(next(i for i, bound in enumerate(found) if bound.code == "C04"), flat)
    return found
