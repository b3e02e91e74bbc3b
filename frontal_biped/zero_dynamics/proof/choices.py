r"""A proved basin of a stabiliser that answers by a table: on every interval of the speed, one of many steps.

The table (`gait.look_ahead_table`) says at every speed after an impact by how much the rising phase is stretched, and
how the falling phase begins: anchored or rescaled (`stretched_paths`). It is taken as it is, a hypothesis, like the
numbers of the gait: nothing is said of why it says so.

*From every speed of the interval given, answered as the table has it, every later step exists, keeps the limits of the
contact and of the motors at every instant, and |x| shrinks by the factor given, at least,* x = speed^2/speed_*^2 - 1.
Where two intervals meet, and up to `SLACK` past their ends, either answer does. Proof, interval by interval, outwards:

- **as planned**, stretch 0 and anchored: these are re-anchored transitions, whose basin is proved (`basin`).
- **late**: with E for e^{-L} zeta at the end of the stretched phase, what its rising half takes of energy and what the
  falling one gives back known from one orbit each, the continuation retraced loses nothing:

  .. math:: x_{next} = \frac{e^{L_f} (energy_f + E)}{zeta_f^*} - 1, \qquad E = e^{-L_r} (1 + x)\, zeta_r^* - energy_r.

  That is affine in x, so x_next / x is greatest at an end of the interval.
- **early or rescaled**: on tiles that cover the reversals, x from the rising and x_next from the falling path.

The limits are those of all motions on the rising path that are not faster than the fastest, and of the falling ones.
The impact is as planned, but for its speed. x_next on the other side of the orbit lies in the basin `basin` proves.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from frontal_biped.zero_dynamics.proof.balls import Ball, arb
from frontal_biped.zero_dynamics.proof.basin import ProvedBasin
from frontal_biped.zero_dynamics.proof.choice_intervals import Choice, answered
from frontal_biped.zero_dynamics.proof.perturbed_steps import (
    PerturbedSteps,
)
from frontal_biped.zero_dynamics.proof.theorems import Proof, told


@dataclass(frozen=True)
class ProvedChoices:
    """Speeds after the impact that return, answered by a table.

    Attributes:
        low: the least of them, relative to the orbit's [-]; what was rounded is inside.
        high: the greatest [-].
        factor: by which x shrinks in a step, at least [-].
        tiles: of each interval, by its place in the table: reversals before the end of the rising phase, negative
            beyond it, at the ends of tiles [rad].
        low_limited_by: what kept lower speeds from being proved.
        high_limited_by: what kept higher ones.
    """

    low: float
    high: float
    factor: Ball
    tiles: Mapping[int, tuple[float, ...]]
    low_limited_by: str = ""
    high_limited_by: str = ""

    @property
    def proved(self) -> Proof:
        """Is there an interval?"""
        return told(self.high > self.low and bool(self.factor < 1), False)

    @property
    def rows(self) -> list[tuple[str, str]]:
        """(name, text) for a report."""
        if self.proved is not Proof.PROVED:
            return []
        low, high = (f"{100.0 * (x - 1.0):+.2f} %" for x in (self.low, self.high))
        return [
            (
                "basin on Z, looked up",
                f"proved: {low} (then not: {self.low_limited_by}) to {high} (then not: {self.high_limited_by}) of the"
                f" speed after the impact, answered by the gait's table on {len(self.tiles)} intervals past those of"
                f" re-anchored phases; the energy error shrinks to {float(self.factor.upper()):.4f} of it in a step,"
                " or less",
            )
        ]


def no_choices(why: str) -> ProvedChoices:
    """Nothing is known."""
    return ProvedChoices(1.0, 1.0, arb.nan(), {}, why, why)


class ChoiceTiles(NamedTuple):
    """What a basin by a table rests on.

    Attributes:
        tiles: as `ProvedChoices`.
        limited_by: what kept lower and higher speeds from being proved when they were sought.
    """

    tiles: Mapping[int, tuple[float, ...]]
    limited_by: tuple[str, str]


def prove_choices(
    steps: PerturbedSteps, basin: ProvedBasin, choices: Sequence[Choice], rests_on: ChoiceTiles | None = None
) -> ProvedChoices:
    """Prove a basin.

    Args:
        steps: of transitions that do not look ahead.
        basin: their basin.
        choices: the table, ascending.
        rests_on: tiles that do; None: they are sought.
    """
    if basin.proved is not Proof.PROVED or not choices:
        return no_choices(basin.low_limited_by if choices else "there is no table")
    factor, tiles, ends, why = basin.factor, {}, [], []
    for outwards in (-1, 1):
        end, stopped = 1.0, "the table ends"
        for i, choice in list(enumerate(choices))[::outwards]:
            inner, outer = (choice.low, choice.high)[::outwards]
            if outwards * (outer - 1.0) <= 0.0:
                continue
            if outwards * (inner - end) > 0.0:
                break
            given = None if rests_on is None else rests_on.tiles.get(i, ())
            reached = answered(steps, basin, choice, outwards, given)
            if reached.tiles:
                tiles[i], factor = reached.tiles, max(factor, reached.factor)
            end = max(end, reached.end) if outwards > 0 else min(end, reached.end)
            if end != outer:
                stopped = reached.why
                break
        ends.append(end)
        why.append(stopped)
    if rests_on is not None:
        why = list(rests_on.limited_by)
    return ProvedChoices(ends[0], ends[1], factor, tiles, why[0], why[1])
