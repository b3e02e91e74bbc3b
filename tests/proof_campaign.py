"""Random parameter sets: what is proved against the measured certificate and a dense scan in fifty digits.

    python tests/proof_campaign.py [--sets 200] [--seed 0] [--jobs 2]

Each set is a designed gait whose free parameters are all moved at random, by a size that is drawn too, between those
that hardly change it and those that leave it no reversal. Nobody chose them: there are none, one, two or three zeros,
near-double ones and ones near the ends of the region. A measured verdict or a sign of the scan that contradicts a proof
is a defect; the share that balls leave undecided is reported.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
from fifty_digits import fifty_digits, scan_fixed, sign_changes, surplus

from frontal_biped.design import optimise_gait
from frontal_biped.exceptions import ReversalError
from frontal_biped.gait import Gait, GaitSpecification, load_gait, load_specification
from frontal_biped.gait.gait import converged_nodes
from frontal_biped.gait.shipped import gait_path
from frontal_biped.model import load_robot
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.invariance import FreeParameters, free_parameters
from frontal_biped.zero_dynamics.proof.ball_gait import BallGait
from frontal_biped.zero_dynamics.proof.balls import working
from frontal_biped.zero_dynamics.proof.decimals import decimal_chain
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.imposed_zeros import imposed_zeros
from frontal_biped.zero_dynamics.proof.theorems import fixed_zeros
from frontal_biped.zero_dynamics.reversal.certificate import certify_reversal
from frontal_biped.zero_dynamics.reversal.problem import ReversalProblem
from frontal_biped.zero_dynamics.reversal.zeros import ZeroCount

SPECIFICATIONS = ("reference", "robust")
HUMANOIDS = ("talos_full", "g1", "romeo", "icub")

SMALLEST, LARGEST = 1e-5, 2e-2
"""Sizes of the random changes: standard deviations of angles [rad], and of lengths [m] a tenth of them."""

POINTS, POINTS_IMPOSED = 300, 50
"""Of a scan, at fixed parameters, and with invariance imposed."""

IMPOSED = 20
"""Of so many sets one is looked at with invariance imposed, too."""


class Outcome(NamedTuple):
    """Of one parameter set.

    Attributes:
        name: whose gait was changed, and by how much.
        proved: number of zeros; None: undecided.
        measured: number of zeros; None: undecided.
        scanned: sign changes.
        faults: contradictions.
    """

    name: str
    proved: int | None
    measured: int | None
    scanned: int
    faults: tuple[str, ...]


@cache
def gait_of(name: str) -> tuple[FrontalBiped, Gait]:
    """A robot and its gait."""
    if name in HUMANOIDS:
        return load_robot(name), load_gait(gait_path(name))
    biped = load_robot("frontal_biped")
    specification = GaitSpecification() if name == "reference" else load_specification(name)
    gait = optimise_gait(biped, specification).gait
    assert gait is not None
    return biped, gait


def changed(free: FreeParameters, generator: np.random.Generator, size: float) -> FreeParameters:
    """All parameters moved at random."""

    def moved(values: object, scale: float) -> np.ndarray:
        return np.asarray(values, dtype=float) + generator.normal(0.0, scale, np.shape(values))

    return replace(
        free,
        beta_reversal=float(moved(free.beta_reversal, 0.1 * size)),
        beta_impact=float(moved(free.beta_impact, 0.1 * size)),
        step_width=float(moved(free.step_width, 0.1 * size)),
        rising_columns=moved(free.rising_columns, size),
        falling_columns=moved(free.falling_columns, size),
        rising_fri=moved(free.rising_fri, 0.1 * size),
        falling_fri=moved(free.falling_fri, 0.1 * size),
    )


def outcomes(seed: int, imposed: bool = False) -> Iterator[Outcome]:
    """The parameter set of a seed; none where the draw has no step to speak of.

    Args:
        seed: of the draw.
        imposed: look at the zeros with invariance imposed as well? That takes five times as long.
    """
    generator = np.random.default_rng(seed)
    name = str(generator.choice([*SPECIFICATIONS, *HUMANOIDS]))
    size = float(np.exp(generator.uniform(np.log(SMALLEST), np.log(LARGEST))))
    biped, gait = gait_of(name)
    nodes = converged_nodes(biped, gait.rising, gait.falling, gait.step_width)
    free = changed(free_parameters(gait.rising, gait.falling, gait.step_width), generator, size)
    try:
        measured = certify_reversal(ReversalProblem(biped, free, nodes))
    except ReversalError:
        return
    if not measured.fixed.region:
        return
    (region,) = measured.fixed.region
    with working():
        balls = BallGait.of(decimal_chain(biped), free)
        found = fixed_zeros(balls, region).found
    with fifty_digits():
        long = BallGait.of(decimal_chain(biped), free)
        scan = sign_changes(scan_fixed(long, region, POINTS))
    yield compared(f"{name} +- {size:.1e}, b fixed", found.zeros, found.undecided, measured.fixed, scan)
    if imposed:
        with working():
            own = imposed_zeros(balls, measured.self_consistent.region)
        with fifty_digits():
            scan = [
                change
                for low, high in measured.self_consistent.region
                for change in sign_changes([(x, surplus(long, x)) for x in np.linspace(low, high, POINTS_IMPOSED)])
            ]
        counted = measured.self_consistent
        yield compared(f"{name} +- {size:.1e}, b imposed", own.places, own.undecided, counted, scan)


Interval = tuple[float, float]


def compared(
    name: str, zeros: Sequence[Interval], undecided: Sequence[Interval], measured: ZeroCount, scan: Sequence[Interval]
) -> Outcome:
    """A proved count against a measured one and a scan.

    Args:
        name: of the outcome.
        zeros: as proved.
        undecided: likewise.
        measured: the other count.
        scan: between which points the sign changes.
    """
    number, exact = len(zeros), not undecided
    places = [zero.place for zero in measured.zeros]
    possible = [*zeros, *undecided]
    faults = []
    if number > len(places) and not measured.undecided:
        faults.append(f"{number} zeros proved, {len(places)} measured")
    if exact and number < len(places):
        faults.append(f"{number} zeros proved, at least {len(places)} measured")
    if any(not _meets((place, place), possible) for place in places):
        faults.append("a measured zero where none is, as proved")
    if any(not _meets(change, possible) for change in scan):
        faults.append("the scan has a change of sign where no zero is, as proved")
    if exact and (len(scan) > number or (number - len(scan)) % 2):
        faults.append(f"{number} zeros proved, {len(scan)} changes of sign in the scan")
    return Outcome(
        name, number if exact else None, None if measured.undecided else len(places), len(scan), tuple(faults)
    )


def _meets(part: Interval, others: Sequence[Interval]) -> bool:
    slack = 1e-9
    return any(a - slack <= part[1] and part[0] <= b + slack for a, b in others)


def _of_seed(seed: int) -> list[Outcome]:
    try:
        return list(outcomes(seed, imposed=seed % IMPOSED == 0))
    except NotEnclosedError as error:
        return [Outcome(f"seed {seed}: {error}", None, None, 0, ())]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sets", type=int, default=200, help="parameter sets; default: 200")
    parser.add_argument("--seed", type=int, default=0, help="of the first; default: 0")
    parser.add_argument("--jobs", type=int, default=2, help="processes; default: 2")
    arguments = parser.parse_args()
    found: list[Outcome] = []
    sets = drawn = 0
    with ProcessPoolExecutor(arguments.jobs) as pool:
        while sets < arguments.sets:
            first = arguments.seed + drawn
            seeds = range(first, first + 4 * arguments.jobs)
            for new in pool.map(_of_seed, seeds):
                found += new
                sets += bool(new)
                drawn += 1
                told = "; ".join(f"{o.name}: {o.proved} proved" for o in new) or "no step"
                print(f"{sets} of {arguments.sets}, {drawn} drawn: {told}", file=sys.stderr, flush=True)
    faults = [f"{outcome.name}: {fault}" for outcome in found for fault in outcome.faults]
    undecided = [outcome for outcome in found if outcome.proved is None]
    print(f"{sets} parameter sets of {drawn} drawn, {len(found)} counts")
    print(f"zeros proved: {dict(sorted(Counter(o.proved for o in found if o.proved is not None).items()))}")
    print(f"undecided: {len(undecided)}, by measurement {sum(o.measured is None for o in found)}")
    print("\n".join(f"  undecided: {outcome.name}" for outcome in undecided))
    print(f"contradictions: {len(faults)}", *faults, sep="\n  ")
    return int(bool(faults))


if __name__ == "__main__":
    raise SystemExit(main())
