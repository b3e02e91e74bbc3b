"""Proved basins of the ankle law against its measured map: the orbit is reached, in as few steps as is proved."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from gaits_in_balls import ROUNDING, agree, orbit_in_balls

from frontal_biped.analysis.proof_inputs import ANKLE_RULE, perturbed_steps
from frontal_biped.analysis.return_map import RestrictedMap
from frontal_biped.control.stabilisers.by_name import make_stabiliser
from frontal_biped.gait.file import load_gait
from frontal_biped.gait.shipped import gait_path
from frontal_biped.model.catalogue import biped_of
from frontal_biped.zero_dynamics.half_steps import stretch_to_reversal
from frontal_biped.zero_dynamics.proof.ankle_basin import AnkleTiles, prove_ankle_basin
from frontal_biped.zero_dynamics.proof.ankle_steps import AnkleSteps
from frontal_biped.zero_dynamics.proof.balls import arb, working
from frontal_biped.zero_dynamics.proof.half_path import HalfPath
from frontal_biped.zero_dynamics.proof.shifted_way import Moved
from frontal_biped.zero_dynamics.proof.stretched_step import over_ranges_of, stretched
from frontal_biped.zero_dynamics.proof.theorems import Proof

SPEED = 1e-8
"""Of a speed that the measured map finds, relative: the shift is found to 1e-9 m."""

SHIFT = 1e-7
"""Of a shift that the law finds [m]."""

SHARES = (0.0, 0.5, 1.0)
"""Ends of tiles of shifts."""


class Steps:
    """The ankle law's steps of a gait, measured and in balls."""

    def __init__(self, biped, gait):
        self.biped, self.gait = biped, gait
        self.law = make_stabiliser("ankle", biped, gait)
        self.measured = RestrictedMap(biped, gait, self.law)
        with working():
            self.orbit = orbit_in_balls(biped, gait)
            self.steps = AnkleSteps(perturbed_steps(biped, gait, self.orbit), ANKLE_RULE)

    def stretch(self, share):
        """A share of the planned rising range [rad]."""
        return share * self.gait.rising.range

    def proved(self, *given):
        with working():
            return prove_ankle_basin(self.steps, *given)

    def taken(self, ratio):
        """The measured step from a speed, and the shifts of its two phases."""
        step = self.measured.step(self.measured.start(ratio))
        planned = self.gait.rising.fri_bezier[-1]
        return step, step.rising.shift, float(step.falling.motion(np.array([step.reversal])).p_fri[0]) - planned


@pytest.fixture(scope="module")
def steps(biped, reference_gait):
    return Steps(biped, reference_gait)


@pytest.fixture(scope="module")
def proved(steps):
    """With tiles that are given: nothing is sought."""
    return steps.proved(AnkleTiles(SHARES, SHARES, tuple(steps.stretch(k / 256) for k in range(4))))


def holds_and_agrees(steps, proved):
    """Every speed tried keeps the limits and is back at the orbit within the steps proved; measured, more is."""
    assert proved.proved is Proof.PROVED
    assert proved.low < 1.0 < proved.at_once <= proved.high
    basin = steps.measured.basin()
    assert basin.low <= proved.low
    assert proved.high <= basin.high
    for ratio in np.linspace(proved.low, proved.high, 12):
        landed = steps.measured.start(ratio)
        for number in range(1 if ratio <= proved.at_once else proved.steps):
            step = steps.measured.step(landed)
            assert step.tightest.value >= 0.0, number
            landed = step.landed
        assert steps.measured.speed_ratio(landed) == pytest.approx(1.0, abs=SPEED)


def test_the_reference_gait(steps, proved):
    holds_and_agrees(steps, proved)
    assert proved.steps == 1
    ((name, text),) = proved.rows
    assert name == "basin on Z, ankle law"
    assert "proved" in text
    assert proved.width > 0.23  # all of the room, in either sense


def test_shifts_and_the_speeds_they_are_for(steps):
    """The shift that the law takes from the speed of a ball is the one whose ball it is."""
    low, high = steps.law.room(steps.law.inner.planned_rising, steps.gait.rising.beta_start, steps.gait.beta_reversal)
    with working():
        assert steps.steps.room.low.overlaps(arb(low, ROUNDING))
        assert steps.steps.room.high.overlaps(arb(high, ROUNDING))
    for end in (low, high):
        for share in (0.2, 0.5, 0.9):
            with working():
                shift = arb(share * end)
                ratio = float(steps.steps.start(steps.steps.rising(shift)).sqrt().mid())
            step, taken, falling = steps.taken(ratio)
            assert taken == pytest.approx(share * end, abs=SHIFT)
            assert falling == pytest.approx(0.0, abs=SHIFT)
            assert step.reversal == pytest.approx(steps.gait.beta_reversal, abs=1e-9)


def test_more_is_left_of_the_energy_the_farther_inwards(steps):
    """At one speed, and so the speed that reverses as planned is the less, in balls as by the formula."""
    with working():
        shares = [arb(k) / 8 for k in range(-8, 9)]
        rising = [
            steps.steps.rising(abs(t) * (steps.steps.room.low if t < 0 else steps.steps.room.high)) for t in shares
        ]
        starts = [steps.steps.start(way) for way in rising]
        assert all(b < a for a, b in pairwise(starts))
        surplus = [way.surplus(rising[8].dbeta_squared) for way in rising]
        assert all(left < 0 for left in surplus[:8])
        assert all(left > 0 for left in surplus[9:])
        steps.steps.order(starts[0])


@pytest.mark.parametrize("share", [0.05, 0.6])
@pytest.mark.parametrize("y", [0.0, 0.37, 1.0])
@pytest.mark.parametrize("over_planned_ranges", [False, True])
def test_a_stretched_step_is_the_one_the_law_takes(steps, share, y, over_planned_ranges):
    """Poses, slopes by the path's own variable, and FRI, of both phases."""
    e, law, gait = steps.stretch(share), steps.law, steps.gait
    rising = law.inner.planned_rising.stretched(gait.beta_reversal + e)
    falling = law.inner.falling(rising, rising.beta_end)
    with working():
        balls = steps.orbit.gait
        for ball in (arb(e), arb(e).union(arb(0.9 * e))):
            step = stretched(steps.orbit.step, balls.begin, balls.end, ball)
            step = over_ranges_of(steps.orbit.step, step) if over_planned_ranges else step
            for half, phase, far in (
                (step.rising, rising, rising.beta_start),
                (step.falling, falling, falling.beta_end),
            ):
                path = Moved.of(HalfPath.of(half, steps.biped.sole), arb(0))
                shape = path.shape(arb(y))
                motion = phase.motion(np.array([rising.beta_end + y * (far - rising.beta_end)]))
                faster = abs(rising.beta_end - far) / float(path.span.mid())
                agree(shape, motion, faster)


@pytest.mark.parametrize("share", [0.004, 0.3])
def test_what_is_taken_of_a_speed_too_fast_for_the_sole(steps, share):
    """Stretch, shift of the falling phase and next speed of a measured step lie in the balls of its tile."""
    e = steps.stretch(share)
    with working():
        ratio = float(steps.steps.stretched_start(e, e).sqrt().mid())
        tile = steps.steps.stretched(0.999 * e, 1.001 * e)
    step, rising, falling = steps.taken(ratio)
    assert step.reversal - steps.gait.beta_reversal == pytest.approx(e, rel=1e-4)
    with working():
        assert steps.steps.room.low.overlaps(arb(rising, SHIFT))
        assert tile.fallen.shift.overlaps(arb(falling, SHIFT))
        assert tile.starts.overlaps(arb(ratio**2, ROUNDING))
        assert tile.fallen.low == tile.fallen.high == 1
    assert steps.measured.speed_ratio(step.landed) == pytest.approx(1.0, abs=SPEED)
    assert all(limit.proved is Proof.PROVED for limit in tile.limits)
    moved = steps.law.inner.planned_rising.shifted(rising)
    again = stretch_to_reversal(steps.biped, moved, steps.measured.start(ratio).dbeta)
    assert again.beta_end == pytest.approx(step.reversal, abs=1e-9)


def test_a_narrower_sole_gives_less(steps, proved):
    """A margin from the ends of the sole is a narrower one."""
    narrow = replace(steps.steps, rule=ANKLE_RULE._replace(margin=0.02))
    with working():
        found = prove_ankle_basin(narrow, AnkleTiles(SHARES, SHARES, (0.0,)))
        whole = prove_ankle_basin(steps.steps, AnkleTiles(SHARES, SHARES, (0.0,)))
    assert found.proved is Proof.PROVED
    assert proved.low == whole.low < found.low < 1.0 < found.high < whole.high <= proved.high


def test_without_the_whole_room_nothing_is_stretched(steps):
    found = steps.proved(AnkleTiles((0.0, 0.5), (0.0, 0.5), (0.0, steps.stretch(1 / 256))))
    assert found.proved is Proof.PROVED
    assert found.tiles.stretched == (0.0,)


@pytest.mark.parametrize(
    "tiles",
    [
        AnkleTiles((0.0, 1.5), SHARES, (0.0,)),
        AnkleTiles(SHARES, (0.0, 0.5, 0.25), (0.0,)),
        AnkleTiles(SHARES, SHARES, (0.0, float("nan"))),
        AnkleTiles(SHARES, SHARES, (0.0, 0.02)),
    ],
)
def test_tiles_that_do_not_do_are_refused(steps, tiles):
    found = steps.proved(tiles)
    assert found.proved is Proof.UNDECIDED
    assert found.width == 0.0
    assert "undecided" in found.rows[0][1]


def test_a_limit_that_the_orbit_does_not_keep_leaves_nothing(steps):
    def tightened(bound):
        return bound._replace(lower=-10.0, upper=10.0) if bound.name == "stance hip torque, rising" else bound

    kept = replace(steps.steps.steps, bounds=[tightened(bound) for bound in steps.steps.steps.bounds])
    with working():
        found = prove_ankle_basin(replace(steps.steps, steps=kept))
    assert found.proved is Proof.UNDECIDED
    assert "stance hip torque" in found.rows[0][1]


@pytest.mark.slow
@pytest.mark.parametrize("which", ["reference", "level", "robust"])
def test_the_widest_that_is_found(which, biped, request):
    """It is proved again from what was found, without a search."""
    steps = Steps(biped, request.getfixturevalue(f"{which}_gait"))
    proved = steps.proved()
    holds_and_agrees(steps, proved)
    assert proved.width > 0.27
    again = steps.proved(proved.tiles)
    assert (again.low, again.high, again.at_once, again.tiles) == (
        proved.low,
        proved.high,
        proved.at_once,
        proved.tiles,
    )
    assert again.proved is Proof.PROVED


@pytest.mark.slow
@pytest.mark.parametrize("name", ["talos_full", "g1"])
def test_humanoids(name):
    steps = Steps(biped_of(name), load_gait(gait_path(name)))
    with working():
        room = prove_ankle_basin(steps.steps, AnkleTiles((), (), (0.0,)))
    holds_and_agrees(steps, room)


@pytest.mark.slow
def test_speeds_that_take_more_than_one_step(biped, level_gait):
    """Where the sole is too short when falling, too: the speed falls as its ball says, and not below the orbit's."""
    steps = Steps(biped, level_gait)
    e = steps.stretch(1.2)
    with working():
        ratio = float(steps.steps.stretched_start(e, e).sqrt().mid())
        tile = steps.steps.stretched(0.9995 * e, 1.0005 * e)
        assert 1 < tile.fallen.high < tile.starts
    step = steps.measured.step(steps.measured.start(ratio))
    following = steps.measured.speed_ratio(step.landed) ** 2
    assert 1.0 < following <= float(tile.fallen.high)
    assert step.tightest.value >= 0.0
