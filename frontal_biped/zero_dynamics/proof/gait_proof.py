"""All that is proved of a gait, statement by statement: `theorems` says what they are."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from frontal_biped.virtual_constraints.invariance import FreeParameters
from frontal_biped.zero_dynamics.proof.ankle_basin import (
    AnkleTiles,
    ProvedAnkleBasin,
    no_ankle_basin,
    prove_ankle_basin,
)
from frontal_biped.zero_dynamics.proof.ankle_steps import AnkleRule, AnkleSteps
from frontal_biped.zero_dynamics.proof.attraction import Attraction, Tiles, attraction
from frontal_biped.zero_dynamics.proof.ball_gait import BallGait
from frontal_biped.zero_dynamics.proof.basin import BasinTiles, ProvedBasin, no_basin, prove_basin
from frontal_biped.zero_dynamics.proof.chain import BallChain
from frontal_biped.zero_dynamics.proof.choice_intervals import Choice
from frontal_biped.zero_dynamics.proof.choices import ChoiceTiles, ProvedChoices, no_choices, prove_choices
from frontal_biped.zero_dynamics.proof.imposed_zeros import ImposedZeros, Interval, Partition, imposed_zeros
from frontal_biped.zero_dynamics.proof.limits import BallOrbit, Bound, Cuts, ProvedLimits, prove_limits, without_panels
from frontal_biped.zero_dynamics.proof.perturbed_steps import PerturbedSteps
from frontal_biped.zero_dynamics.proof.signs import Piece
from frontal_biped.zero_dynamics.proof.theorems import (
    NEARBY,
    Convergence,
    FixedZeros,
    NearestZero,
    Proof,
    convergence,
    fixed_zeros,
    nearest_zero,
)


class Regions(NamedTuple):
    """Where zeros are counted.

    Attributes:
        fixed: at fixed parameters [rad].
        imposed: with invariance imposed.
    """

    fixed: Interval
    imposed: tuple[Interval, ...]


class Asked(NamedTuple):
    """What is asked of the orbit.

    Attributes:
        bounds: C01 to C09.
        sole: ends of the stance sole on the h axis, (outer < 0, inner > 0) [m].
        perturbed: the steps about the orbit, whose basin is asked for.
        choices: the table of a gait that has one, likewise.
        ankle: how the ankle law shifts them.
    """

    bounds: Sequence[Bound]
    sole: tuple[float, float]
    perturbed: Callable[[BallOrbit], PerturbedSteps]
    choices: Sequence[Choice]
    ankle: AnkleRule


class Evidence(NamedTuple):
    """What is known to do, so that nothing has to be sought.

    Attributes:
        pieces: of the region at fixed parameters.
        partition: of those with invariance imposed.
        radius: for successive approximation [rad]; 0: none.
        tiles: likewise; None: none.
        cuts: of the panels of the orbit; None: none.
        basin: tiles; None: none.
        choices: likewise.
        ankle_basin: likewise.
    """

    pieces: tuple[Piece, ...]
    partition: Partition
    radius: float
    tiles: Tiles | None
    cuts: Cuts | None
    basin: BasinTiles | None
    choices: ChoiceTiles | None
    ankle_basin: AnkleTiles | None


@dataclass(frozen=True)
class GaitProof:
    """All that is proved of a gait.

    Attributes:
        fixed: zeros of Z at fixed parameters.
        zero: the zero of S near the planned reversal.
        convergence: of successive approximation.
        imposed: all zeros of S.
        attraction: of successive approximation, from far.
        limits: C01 to C09 on the whole orbit.
        basin: speeds after the impact that return to it.
        choices: those that do, answered by the gait's table.
        ankle_basin: those that do under the ankle law.
    """

    fixed: FixedZeros
    zero: NearestZero
    convergence: Convergence
    imposed: ImposedZeros
    attraction: Attraction
    limits: ProvedLimits
    basin: ProvedBasin
    choices: ProvedChoices
    ankle_basin: ProvedAnkleBasin

    @property
    def rows(self) -> list[tuple[str, str]]:
        """(name, text) for a report."""
        fixed, zero, near = self.fixed, self.zero, self.convergence
        places = ", ".join(f"[{a:.7f}, {b:.7f}]" for a, b in fixed.found.zeros) or "none"
        low, high = fixed.region
        left = "" if fixed.found.exact else f"; undecided on {len(fixed.found.undecided)} intervals"
        return [
            (
                "zeros of Z, b fixed",
                f"number {fixed.counted.value}: {len(fixed.found.zeros)} on [{low:.5f}, {high:.5f}], in {places} rad"
                f"{left}",
            ),
            self.imposed.row,
            ("reversal", f"{zero.proved.value}: exactly one within {NEARBY:g} rad of the plan, at {zero.reversal} rad"),
            ("0 < multiplier < 1", f"{zero.stable.value}: {zero.multiplier}"),
            (
                "successive approximation",
                f"{near.proved.value}: from every start within {near.radius:g} rad, factor {near.factor}",
            ),
            self.attraction.row,
            *self.limits.rows,
            *self.basin.rows,
            *self.choices.rows,
            *self.ankle_basin.rows,
        ]


def prove_parameters(
    chain: BallChain, free: FreeParameters, regions: Regions, asked: Asked, evidence: Evidence | None = None
) -> GaitProof:
    """Prove what there is to prove of a gait's parameters.

    Args:
        chain: the robot.
        free: what invariance leaves free.
        regions: on which zeros are counted.
        asked: bounds of the orbit.
        evidence: what is known to do; None: it is sought.

    Raises:
        NotEnclosedError: the final pose is not known to exist, or its impact.
    """
    gait = BallGait.of(chain, free)
    zero = nearest_zero(gait)
    bounds, sole = asked.bounds, asked.sole
    if evidence is None:
        fixed, near = fixed_zeros(gait, regions.fixed), convergence(gait, zero)
        imposed = imposed_zeros(gait, regions.imposed)
        far = attraction(gait, zero, near, imposed)
        limits = prove_limits(gait, zero, bounds, sole)
        basin, choices, ankle_basin = _basins(gait, zero, asked, limits.cuts)
        return GaitProof(fixed, zero, near, imposed, far, limits, basin, choices, ankle_basin)
    radii = (evidence.radius,) if evidence.radius > 0.0 else ()
    fixed, near = fixed_zeros(gait, regions.fixed, evidence.pieces), convergence(gait, zero, radii)
    imposed = imposed_zeros(gait, regions.imposed, evidence.partition)
    far, limits = Attraction(None, Proof.UNDECIDED), without_panels(bounds)
    if evidence.tiles is not None:
        far = attraction(gait, zero, near, imposed, evidence.tiles)
    if evidence.cuts is not None:
        limits = prove_limits(gait, zero, bounds, sole, evidence.cuts)
    basin, choices, ankle_basin = _basins(gait, zero, asked, evidence.cuts, evidence)
    return GaitProof(fixed, zero, near, imposed, far, limits, basin, choices, ankle_basin)


def _basins(
    gait: BallGait, zero: NearestZero, asked: Asked, cuts: Cuts | None, evidence: Evidence | None = None
) -> tuple[ProvedBasin, ProvedChoices, ProvedAnkleBasin]:
    """All of them; of evidence, those that it has."""
    on_basin, on_choices, on_ankle = (None, None, None) if evidence is None else evidence[-3:]
    sought, why = evidence is None, "" if cuts is not None or evidence is not None else "the orbit is not enclosed"
    basin, choices, ankle_basin = no_basin(why), no_choices(why), no_ankle_basin(why)
    if cuts is None or not (sought or on_basin or on_ankle):
        return basin, choices, ankle_basin
    steps = asked.perturbed(BallOrbit.of(gait, zero.reversal, asked.sole, cuts))
    if sought or on_basin:
        basin = prove_basin(steps, on_basin)
    if sought or on_choices:
        choices = prove_choices(steps, basin, asked.choices, on_choices)
    if sought or on_ankle:
        ankle_basin = prove_ankle_basin(AnkleSteps(steps, asked.ankle), on_ankle)
    return basin, choices, ankle_basin
