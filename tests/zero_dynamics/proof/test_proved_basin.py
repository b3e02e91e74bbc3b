"""Proved basins against the measured map of re-anchored transitions: contained in it, and at least half as wide."""

from dataclasses import replace

import numpy as np
import pytest
from gaits_in_balls import agree, orbit_in_balls

from frontal_biped.analysis.proof_inputs import perturbed_steps
from frontal_biped.analysis.return_map import RestrictedMap
from frontal_biped.control.stabilisers.by_name import make_stabiliser
from frontal_biped.control.stabilisers.look_ahead import NEAR, LookAheadTransitions
from frontal_biped.control.stabilisers.transitions import REJOINS
from frontal_biped.gait.constraints import HEIGHT, IMPULSE, SPEED
from frontal_biped.gait.look_ahead_table import Way
from frontal_biped.virtual_constraints.anchoring import anchored_falling
from frontal_biped.zero_dynamics.half_steps import falling_energy, rising_energy
from frontal_biped.zero_dynamics.proof.balls import arb, working
from frontal_biped.zero_dynamics.proof.basin import BasinTiles, no_basin, prove_basin
from frontal_biped.zero_dynamics.proof.limits import Bound
from frontal_biped.zero_dynamics.proof.reversals import EarlyPath, LatePath, Mismatch
from frontal_biped.zero_dynamics.proof.theorems import Proof

MAP = 1e-6
"""Of a speed that the measured map finds, relative."""

LATE, LAST, ALIKE, TILE = 0.4, 0.42, 0.38, 1 / 1024
"""Of the reference gait, as shares of the rising range: a late reversal, one of the last that return, one at which
looking ahead changes nothing, and the width of tiles of early ones.
"""


class Steps:
    """A gait's steps, measured and in balls."""

    def __init__(self, biped, gait):
        self.biped, self.gait = biped, gait
        self.stabiliser = make_stabiliser("re-anchored", biped, gait)
        self.measured = RestrictedMap(biped, gait, self.stabiliser)
        with working():
            orbit = orbit_in_balls(biped, gait)
            self.steps = perturbed_steps(biped, gait, orbit)

    def proved(self, *given, **changes):
        with working():
            return prove_basin(replace(self.steps, **changes), *given)


@pytest.fixture(scope="module")
def steps(biped, reference_gait):
    return Steps(biped, reference_gait)


@pytest.fixture(scope="module")
def proved(steps):
    """With a late reversal and tiles that are given: nothing is sought."""
    range_ = steps.gait.rising.range
    return steps.proved(BasinTiles(LATE * range_, tuple(k * TILE * range_ for k in range(4)), alike=ALIKE * range_))


def holds_and_agrees(steps, proved):
    """Every speed tried returns, the energy error shrinks as proved; at least half of what is measured is proved."""
    assert proved.proved is Proof.PROVED
    assert proved.low < 1.0 < proved.high
    basin, factor = steps.measured.basin(), float(proved.factor)
    assert factor < 1.0
    assert proved.width >= 0.5 * (basin.high - basin.low)
    for ratio in np.linspace(proved.low, proved.high, 9):
        step = steps.measured.step(steps.measured.start(ratio))
        assert step.tightest.value >= 0.0
        before, after = ratio**2 - 1.0, steps.measured.speed_ratio(step.landed) ** 2 - 1.0
        assert abs(after) <= factor * abs(before) + MAP
        assert after * before >= -MAP
    assert steps.measured.follow(proved.high).returned
    assert "proved" in proved.rows[0][1]


def test_the_reference_gait(steps, proved):
    holds_and_agrees(steps, proved)


@pytest.mark.slow
@pytest.mark.parametrize("which", ["reference", "level", "robust"])
def test_the_widest_that_is_found(which, biped, request):
    """It is proved again from what was found, without a search."""
    steps = Steps(biped, request.getfixturevalue(f"{which}_gait"))
    proved = steps.proved()
    holds_and_agrees(steps, proved)
    shrinks_as_measured(steps, (1.0 - share * (1.0 - proved.low) for share in (0.1, 0.6, 1.0)))
    answers_alike(steps, proved)
    again = steps.proved(BasinTiles(proved.beyond, proved.tiles, alike=proved.alike))
    assert (again.low, again.high, again.tiles) == (proved.low, proved.high, proved.tiles)
    assert again.looking_ahead == proved.looking_ahead
    assert again.factor.overlaps(proved.factor)
    assert again.proved is Proof.PROVED


def shrinks_as_measured(steps, ratios):
    """m q at single reversals is what becomes of the energy error in a measured step."""
    for ratio in ratios:
        step = steps.measured.step(steps.measured.start(ratio))
        d = steps.gait.beta_reversal - step.reversal
        with working():
            q = steps.steps.early(d, d).q
            shrinks = q * steps.steps.orbit.multiplier
        before = ratio**2 - 1.0
        measured = (steps.measured.speed_ratio(step.landed) ** 2 - 1.0) / before
        assert shrinks.overlaps(arb(measured, MAP / abs(before)))
        assert shrinks.rad() < 1e-3


def test_the_energy_error_of_early_reversals(steps):
    shrinks_as_measured(steps, (0.9999, 0.9996, 0.9982))


@pytest.mark.parametrize("d", [1e-5, 1e-4, 5e-4])
def test_paths_are_rejoined_as_the_transitions_choose(steps, d):
    rising = steps.stabiliser.planned_rising
    with working():
        path = steps.steps.chosen(arb(d))
    assert path.c == steps.stabiliser.rejoin_of(rising, steps.gait.beta_reversal - d)


@pytest.mark.slow
def test_where_the_speed_goes_away(biped, level_gait):
    """Below the measured basin of the level gait."""
    steps = Steps(biped, level_gait)
    step = steps.measured.step(steps.measured.start(0.98 * steps.measured.basin().low))
    d = steps.gait.beta_reversal - step.reversal
    with working():
        q = steps.steps.early(d, d).q
        assert q * steps.steps.orbit.multiplier > 1


def absolute_angles_agree(shape):
    """Those of the links are sums of the joints'."""
    for links, joints, quarter in (
        (shape.alphas, shape.q, arb.pi() / 2),
        (shape.rates, shape.slopes, arb(0)),
        (shape.turns, shape.bends, arb(0)),
    ):
        total = arb(0)
        for link, joint in zip(links, joints, strict=True):
            total = total + joint + quarter
            assert link.overlaps(total)


@pytest.mark.parametrize("y", [0.0, 0.37, 1.0])
def test_a_late_path_is_the_continuation(steps, y):
    beyond, planned = 3e-3, steps.stabiliser.planned_rising
    with working():
        path = LatePath.of(steps.steps.orbit.rising.path, steps.steps.tapers, beyond)
        shape = path.shape(arb(y))
        # the end itself belongs to the phase that goes on
        at = planned.beta_end + max(beyond * (1.0 - y), 1e-15)
        agree(shape, planned.motion(np.array([at])))
        absolute_angles_agree(shape)


@pytest.mark.parametrize("y", [0.0, 0.37, 1.0])
def test_an_early_path_rejoins_the_planned_one(steps, y):
    d, gait, orbit = 1.1e-3, steps.gait, steps.steps.orbit
    reversal = gait.beta_reversal - d
    falling = anchored_falling(gait.falling, gait.rising, reversal, REJOINS[0])
    motion = falling.motion(np.array([reversal - REJOINS[0] * d * y]))
    with working():
        mismatch = Mismatch.of(orbit.step, steps.biped.sole)
        for ball in (arb(d), arb(d, 1e-5), arb(d, d)):
            shape = EarlyPath.of(mismatch, ball, REJOINS[0]).shape(arb(y))
            agree(shape, motion)
            absolute_angles_agree(shape)


def test_wider_than_measured_is_not_proved(steps, proved):
    """Beyond the last speed that keeps the torques, and before the first from which the speed returns."""
    basin = steps.measured.basin()
    for ratio in (1.05 * basin.high, 1.01 * basin.high):
        beyond = steps.measured.step(steps.measured.start(ratio)).reversal - steps.gait.beta_reversal
        assert beyond > proved.beyond
        assert steps.proved(BasinTiles(beyond, (0.0,))).proved is Proof.UNDECIDED
    early = steps.gait.beta_reversal - steps.measured.step(steps.measured.start(0.98 * basin.low)).reversal
    assert steps.proved(BasinTiles(proved.beyond, (*proved.tiles, early))).proved is Proof.UNDECIDED
    assert steps.proved(BasinTiles(proved.beyond, (0.0, early))).proved is Proof.UNDECIDED


def test_a_limit_that_the_orbit_does_not_keep_leaves_nothing(steps):
    def tightened(bound):
        return bound._replace(lower=-10.0, upper=10.0) if bound.name == "stance hip torque, rising" else bound

    found = steps.proved(bounds=[tightened(bound) for bound in steps.steps.bounds])
    assert found.proved is Proof.UNDECIDED
    assert found.width == 0.0
    assert "stance hip torque" in found.rows[0][1]


@pytest.mark.parametrize("name", ["colour of the pelvis, rising", "colour of the pelvis", "step duration"])
def test_a_limit_without_an_enclosure_leaves_nothing(steps, name):
    """Nor does one that depends on the speed otherwise than in proportion."""
    unknown = Bound("C06", name, "-", -1.0, 10.0, False, 0.0)
    assert steps.proved(bounds=[*steps.steps.bounds, unknown]).proved is Proof.UNDECIDED


def answers_alike(steps, proved):
    """The stabiliser that looks ahead makes the very steps of the one that does not, also where it does look."""
    low, high = proved.looking_ahead
    assert proved.low <= low < 1.0 < 1.0 + 5.0 * NEAR < high <= proved.high
    ahead = LookAheadTransitions(steps.biped, steps.gait, look_up=False)
    closed_form = RestrictedMap(steps.biped, steps.gait, ahead)
    for ratio in [*np.linspace(low, high, 7), 1.0 + 1.01 * NEAR]:
        plain, looked = (one.step(one.start(ratio)) for one in (steps.measured, closed_form))
        assert looked.reversal == pytest.approx(plain.reversal, abs=1e-12)
        assert looked.landed.dbeta == pytest.approx(plain.landed.dbeta, rel=1e-12)
        foreseen = ahead.foreseen(float(ratio))
        assert (foreseen.choice.stretch, foreseen.choice.descent.way) == (0.0, Way.ANCHORED)


def test_looking_ahead_answers_alike_where_that_is_said(steps, proved):
    answers_alike(steps, proved)
    assert no_basin("").looking_ahead == (1.0, 1.0)


def test_without_the_reserve_looking_ahead_is_alike_only_near(steps):
    """One of the last reversals that return is too late for it; where none is given nothing more is known."""
    last = LAST * steps.gait.rising.range
    for alike in (last, 0.0):
        found = steps.proved(BasinTiles(last, (0.0,), alike=alike))
        assert found.proved is Proof.PROVED
        assert found.looking_ahead[1] == pytest.approx(1.0 + NEAR, abs=1e-8)


def test_the_reserve_is_what_looking_ahead_asks_for(steps):
    """At the orbit, the margins of balls are the measured ones less what is required."""
    gait, ahead = steps.gait, LookAheadTransitions(steps.biped, steps.gait, look_up=False)
    energy = rising_energy(steps.biped, steps.stabiliser.planned_rising)
    falling = falling_energy(steps.biped, gait.falling, gait.beta_reversal)
    measured = {
        margin.name: margin.value
        for margin in (
            *ahead.limits.rising(energy, gait.orbit.beta_dot_after_impact, gait.beta_reversal),
            *ahead.limits.falling(falling, gait.beta_reversal),
        )
    }
    sole = steps.biped.sole[1] - steps.biped.sole[0]
    for name, margin, unit in (
        ("F_h / F_v, rising", "friction, rising", 1.0),
        ("F_v / m g, falling", "normal force, falling", 1.0),
        ("FRI in the sole, rising", "FRI in the sole, rising", sole),
        ("sole height / (1 - t2), falling", "swing foot clearance, falling", HEIGHT),
        ("touchdown speed of both sole ends", "touchdown speed", SPEED),
        ("normal impulse / m", "normal impulse", IMPULSE),
        ("L_h / L_v", "impulse in the friction cone", 1.0),
        ("impulse in the sole", "impulse in the sole", sole),
        ("lift-off speed of the old stance sole", "lift-off of the old stance foot", SPEED),
    ):
        with working():
            [bound] = [bound for bound in steps.steps.reserve.bounds if bound.name == name]
            left = steps.steps.orbit.enclosed(bound)
        assert float(left.low) == pytest.approx((measured[margin] - ahead.required[margin]) * unit, rel=0.02, abs=1e-6)
    torques = [bound for bound in steps.steps.reserve.bounds if "torque" in bound.name]
    assert len(torques) == 8
    most = steps.gait.specification.torque_limits(steps.biped)
    for bound in torques:
        assert bound.upper == pytest.approx((1.0 - ahead.required["torque, rising"]) * most[0], rel=1e-6)
