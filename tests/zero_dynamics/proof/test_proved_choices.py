"""Basins that are proved of a gait's table of answers, against the measured map of the stabiliser that looks up."""

from dataclasses import replace

import numpy as np
import pytest
from gaits_in_balls import agree, orbit_in_balls

from frontal_biped.analysis.proof_inputs import choices, perturbed_steps
from frontal_biped.analysis.return_map import RestrictedMap
from frontal_biped.control.stabilisers.look_ahead import LookAheadTransitions
from frontal_biped.control.stabilisers.tabulation import tabulated
from frontal_biped.gait.look_ahead_table import Descent, Way
from frontal_biped.zero_dynamics.proof.balls import arb, working
from frontal_biped.zero_dynamics.proof.basin import BasinTiles, no_basin, prove_basin
from frontal_biped.zero_dynamics.proof.choices import ChoiceTiles, prove_choices
from frontal_biped.zero_dynamics.proof.families import Family
from frontal_biped.zero_dynamics.proof.half_path import HalfPath
from frontal_biped.zero_dynamics.proof.reversals import Tapers
from frontal_biped.zero_dynamics.proof.stretched_paths import LowerPart, RescaledPath
from frontal_biped.zero_dynamics.proof.stretched_step import stretched
from frontal_biped.zero_dynamics.proof.theorems import Proof

MAP = 1e-6
"""Of a speed that the measured map finds, relative."""

LATE = 0.42
"""Of the reference gait, a late reversal as a share of the rising range: up to where its table begins to stretch."""


class Answers:
    """A gait with its table, its steps in balls, and the basin of re-anchored phases."""

    def __init__(self, biped, gait, fastest=3.0, slowest=0.3, rests_on=None):
        self.biped, self.gait = biped, tabulated(biped, gait, slowest=slowest, fastest=fastest)
        with working():
            self.orbit = orbit_in_balls(biped, gait)
            self.steps = perturbed_steps(biped, gait, self.orbit)
            self.basin = prove_basin(self.steps, rests_on)
        self.choices = choices(biped, self.gait)

    def proved(self, rests_on=None, **changes):
        with working():
            given = [choice._replace(**changes) if not choice.as_planned else choice for choice in self.choices]
            return prove_choices(self.steps, self.basin, given, rests_on)


@pytest.fixture(scope="module")
def answers(biped, reference_gait):
    rests_on = BasinTiles(LATE * reference_gait.rising.range, (0.0, 1e-5))
    return Answers(biped, reference_gait, fastest=1.045, slowest=0.997, rests_on=rests_on)


@pytest.fixture(scope="module")
def proved(answers):
    return answers.proved()


def holds_and_agrees(answers, proved, ratios):
    """Every speed tried keeps the limits and comes nearer to the orbit's as proved, looked up in the table."""
    closed_form = RestrictedMap(answers.biped, answers.gait, LookAheadTransitions(answers.biped, answers.gait))
    factor = float(proved.factor)
    assert factor < 1.0
    for ratio in ratios:
        step = closed_form.step(closed_form.start(ratio))
        assert step.tightest.value >= 0.0
        before, after = ratio**2 - 1.0, closed_form.speed_ratio(step.landed) ** 2 - 1.0
        assert abs(after) <= factor * abs(before) + MAP


def proved_again(answers, proved):
    """From the tiles alone."""
    again = answers.proved(ChoiceTiles(proved.tiles, (proved.low_limited_by, proved.high_limited_by)))
    assert (again.low, again.high, again.tiles) == (proved.low, proved.high, proved.tiles)
    assert again.factor.overlaps(proved.factor)
    assert again.rows == proved.rows


def test_a_fast_robot_whose_phase_is_stretched(answers, proved):
    assert proved.proved is Proof.PROVED
    assert proved.high == answers.choices[-1].high > 1.04
    assert proved.high > answers.basin.high
    assert proved.low == answers.basin.low < 1.0
    assert len(proved.tiles) >= 3
    holds_and_agrees(answers, proved, np.linspace(proved.low, proved.high, 12))
    proved_again(answers, proved)
    assert "looked up" in proved.rows[0][0]


def test_more_than_the_tiles_show_is_not_proved(answers, proved):
    """Without those of an interval, or with a reversal that does not reach as far, it ends there."""
    first, *others = proved.tiles
    kept = {place: proved.tiles[place] for place in others}
    cut = answers.proved(ChoiceTiles(kept, ("", "")))
    assert cut.high == answers.choices[first].low
    nearer = {first: (0.9 * proved.tiles[first][0],)} | kept
    cut = answers.proved(ChoiceTiles(nearer, ("", "")))
    assert answers.choices[first].low < cut.high < answers.choices[first].high


@pytest.mark.parametrize("changes", [{"stretch": 0.0}, {"reversals": (0.0, 1e-4)}, {"rescaled": True}])
def test_a_table_that_is_not_true_to_the_robot_proves_less(answers, proved, changes):
    """Not stretched, reversing elsewhere than it says, or rescaled on an interval that is not short."""
    assert answers.proved(**changes).high < proved.high


def test_without_a_table_or_a_basin_nothing_is_known(answers, reference_gait):
    assert choices(answers.biped, reference_gait) == []
    stale = replace(answers.gait, look_ahead=replace(answers.gait.look_ahead, made_for="another"))
    assert choices(answers.biped, stale) == []
    with working():
        for found in (
            prove_choices(answers.steps, answers.basin, []),
            prove_choices(answers.steps, no_basin("it is not known"), answers.choices),
        ):
            assert found.proved is Proof.UNDECIDED
            assert found.rows == []


@pytest.mark.slow
@pytest.mark.parametrize("which", ["level", "robust"])
def test_nearly_all_that_is_measured_is_proved(which, biped, request):
    """Fast and slow, stretched and rescaled."""
    answers = Answers(biped, request.getfixturevalue(f"{which}_gait"))
    proved = answers.proved()
    closed_form = RestrictedMap(biped, answers.gait, LookAheadTransitions(biped, answers.gait))
    measured = closed_form.basin()
    assert proved.high - proved.low >= 0.9 * (measured.high - measured.low)
    holds_and_agrees(answers, proved, np.linspace(proved.low, proved.high, 15))
    proved_again(answers, proved)


# ---------------------------------------------------------------------- paths
@pytest.mark.parametrize("stretch", [0.0, 0.25, 1.0])
@pytest.mark.parametrize("y", [0.0, 0.37, 1.0])
def test_paths_are_those_that_looking_ahead_answers(answers, stretch, y):
    gait, orbit = answers.gait, answers.orbit
    law = LookAheadTransitions(answers.biped, gait, look_up=False)
    rising = law.planned(stretch)
    anchored = law.plain.falling(rising, rising.beta_end + 1e-3)
    tapers = Tapers(rising.taper, rising.curvature_taper, rising.fri_taper)
    with working():
        step = stretched(orbit.step, orbit.gait.begin, orbit.gait.end, orbit.rising.path.span * arb(stretch))
        up, down = (HalfPath.of(half, answers.biped.sole) for half in (step.rising, step.falling))
        planned = orbit.falling.path

        def at(phase, path, reversal):
            return path.shape(arb(y)), phase.motion(np.array([reversal - y * float(path.span)]))

        agree(*at(rising, up, rising.beta_end))
        agree(*at(anchored, down, rising.beta_end))
        agree(*at(rising, LowerPart.of(up, 4e-3), rising.beta_end - 4e-3))
        for past_end in (-4e-3, 3e-3):
            reversal = rising.beta_end + past_end
            rescaled = law._descended(Descent(Way.RESCALED), rising, reversal)
            if past_end < 0.0:
                path = RescaledPath.early(up, planned, orbit.gait.end, down.span, arb(-past_end))
            else:
                path = RescaledPath.late(up, tapers, planned, orbit.gait.end, down.span, arb(past_end))
            agree(*at(rescaled, path, reversal))


def test_a_family_encloses_its_paths_more_narrowly(answers):
    """At single reversals of it, what is bounded lies in its balls; they are narrower than those of plain balls."""
    orbit, d = answers.orbit, arb(4e-3, 2e-6)

    def path_of(d):
        return RescaledPath.early(orbit.rising.path, orbit.falling.path, orbit.gait.end, orbit.falling.path.span, d)

    with working():
        family, plain = Family.of(path_of, d), path_of(d)
        for y in (arb(0), arb(0.4), arb(1)):
            together, roughly = family.at(y), plain.at(y)
            for single in (arb(4e-3 - 2e-6), arb(4e-3 + 1e-6)):
                alone = path_of(single).at(y)
                for field in ("A", "B", "G"):
                    pairs = zip(getattr(alone, field), getattr(together, field), strict=True)
                    assert all(wide.overlaps(one) for one, wide in pairs)
                assert together.I_P.contains(alone.I_P)
            assert together.I_P.rad() < 0.7 * roughly.I_P.rad()
        shape, own = family.shape(arb(0.4)), plain.shape(arb(0.4))
        assert all(a.overlaps(b) for a, b in zip(shape.q, own.q, strict=True))
