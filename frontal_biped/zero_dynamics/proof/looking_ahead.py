r"""Where transitions that look ahead answer as those that do not, so that what is proved of these holds of them.

`control.stabilisers.look_ahead` takes the phases of re-anchored transitions as they come where the speed errs by less
than `Reserve.near`; and past that wherever they keep a reserve of every limit and do not miss the next speed of rho.

*At every speed of the interval given, the answers are those of re-anchored transitions; as errors shrink, so they are
at every later step.* Proof: late reversals miss nothing, for E_next = m E is rho itself (`basin`). That the limits are
kept with their reserve is proved as they are without, for all motions at once that are not faster than the latest one.
Early reversals miss rho, and are answered alike only where the speed is near.

The program asks for the reserve at the points of its panels, here it is kept between them too. It is a matter of the
answers that are computed; what a gait's table of them says (`gait.look_ahead_table`) is another (`choices`).
"""

from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.perturbed_steps import PerturbedSteps
from frontal_biped.zero_dynamics.proof.theorems import Proof

HALVINGS = 5
"""Bisections of the latest reversal that keeps the reserve."""


def latest_alike(steps: PerturbedSteps, latest: float) -> float:
    """The latest reversal that is found to keep the reserve, past the planned one [rad]; 0: none.

    Args:
        steps: of transitions that do not look ahead.
        latest: reversal that is proved to return [rad].
    """
    if keeps_reserve(steps, latest):
        return latest
    found, bad = 0.0, latest
    for _ in range(HALVINGS):
        middle = 0.5 * (found + bad)
        found, bad = (middle, bad) if keeps_reserve(steps, middle) else (found, middle)
    return found


def keeps_reserve(steps: PerturbedSteps, beyond: float) -> bool:
    """Do all motions that reverse no later than so far past the planned reversal [rad], and not before it?"""
    try:
        _, paths = steps.late(beyond)
    except NotEnclosedError:
        return False
    return all(limit.proved is Proof.PROVED for limit in steps.limits(paths, steps.reserve.bounds))
