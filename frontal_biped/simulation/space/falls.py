"""What to change against a fall in space: in the gait, in the command, or in what disturbs the walk.

Looked for in this order, so that what must be wrong comes before what may be:

    what the ground cannot hold    the gait's holding wrench leaves the sole or its friction (`gait.check_holding`)
    speed                          the robot was told to walk forwards or backwards
    pushes                         there were some
    the outcome                    as in the plane (`simulation.falls`)
"""

from frontal_biped.exceptions import RobotError
from frontal_biped.gait.check import check_holding
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.falls import fall_remedy
from frontal_biped.simulation.space.run import SpatialRun


def spatial_fall_remedy(biped: FrontalBiped, gait: Gait, run: SpatialRun) -> str | None:
    """What to change against the fall that ended a walk, in words; None where it did not fall or nothing is known.

    Args:
        biped: the robot from the front.
        gait: what it walked.
        run: the walk.
    """
    if not run.fell:
        return None
    told = _not_held(biped, gait)
    if told is not None:
        return told
    fastest = max((float(speed) for speed in run.speed_target), key=abs, default=0.0)
    if fastest:
        return f"walk slower than {fastest:g} m/s"
    if run.settings.get("pushes"):
        return "push less; without pushes the gait itself is tried"
    return fall_remedy(run.outcome, gait.specification)


def _not_held(biped: FrontalBiped, gait: Gait) -> str | None:
    """The bound on the holding wrench that the gait misses most."""
    try:
        checks = check_holding(biped, gait.specification, gait.rising, gait.falling, gait.step(biped)).checks
    except RobotError:  # the length of the soles is not known
        return None
    missed = [check for check in checks if not check.satisfied]
    if not missed:
        return None
    worst = min(missed, key=lambda check: check.tightness)
    bound = (gait.specification.cop_margin_x or 0.0) if worst.code == "cop_margin_x" else abs(worst.bound)
    return (
        f"the gait needs a {worst.name} of {worst.value:.3g}, and {worst.bound:.3g} is there: ask for"
        f" {worst.code} = {bound:g}, and design again"
    )
