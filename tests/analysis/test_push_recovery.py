"""What counts as surviving a push: the ground holds the gait's friction and a FRI within the sole, and no more."""

from dataclasses import replace

import numpy as np
import pytest

from frontal_biped.analysis.push_recovery import (
    PERIOD,
    PUSH_DURATION,
    PUSH_RESOLUTION,
    PushedWalks,
    held_walk,
    largest_pushes,
    last_true,
    push_cells,
    push_sizes,
    time_in_step,
)
from frontal_biped.simulation import Disturbances, Push, SimulationSettings
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.rigid import BEYOND_SOLE
from frontal_biped.simulation.walking import simulate

EVERY_TICK = SimulationSettings(record_rate=1.0 / PERIOD)

PUSHED = ("just after the impact", 0.02)


def shove(biped, gait, impulse, place=PUSHED[1]):
    return Push(time_in_step(gait.step(biped), place), PUSH_DURATION, impulse)


def of_sole(biped, run):
    outer, inner = biped.sole
    return np.maximum(run.p_fri / outer, run.p_fri / inner)


def test_a_walk_whose_fri_leaves_the_sole_is_a_fall(biped, robust_gait):
    """A foot that sticks walks on, with the FRI 5 % beyond the end of the sole."""
    push, asked = shove(biped, robust_gait, 16.0), {"steps": 2, "simulation_settings": EVERY_TICK}
    sticking = simulate(
        biped, robust_gait, period=PERIOD, stabiliser="ankle", disturbances=Disturbances(pushes=(push,)), **asked
    )
    assert not sticking.fell
    assert of_sole(biped, sticking).max() > 1.04
    held = held_walk(biped, robust_gait, "ankle", push, **asked)
    assert held.outcome == EventKind.ROLLED.value
    assert held.event_kind[-1] == "ROLLED"
    assert held.t[-1] == pytest.approx(sticking.t[np.argmax(of_sole(biped, sticking) > 1.0 + BEYOND_SOLE)], abs=PERIOD)
    assert (of_sole(biped, held)[:-1] <= 1.0 + BEYOND_SOLE).all()


def test_the_gait_itself_and_a_small_push_are_held(biped, robust_gait):
    for pushes in ((), (shove(biped, robust_gait, 4.0),)):
        run = held_walk(biped, robust_gait, "ankle", *pushes, steps=3, simulation_settings=EVERY_TICK)
        assert not run.fell
        assert of_sole(biped, run).max() <= 1.0 + BEYOND_SOLE


def test_the_friction_is_the_gaits_own(biped, robust_gait):
    """The same gait, had it been designed for ice."""
    on_ice = replace(robust_gait, specification=replace(robust_gait.specification, friction=0.05))
    assert held_walk(biped, on_ice, "ankle", steps=1).outcome == EventKind.SLIPPED.value


@pytest.mark.slow
def test_the_largest_push_keeps_the_fri_in_the_sole(biped, robust_gait):
    found = largest_pushes(biped, robust_gait, "ankle", *PUSHED)[0]
    assert found.limited_by == EventKind.ROLLED.value
    assert found.impulse < 16.0
    run = held_walk(
        biped, robust_gait, "ankle", shove(biped, robust_gait, found.impulse), steps=6, simulation_settings=EVERY_TICK
    )
    assert not run.fell
    assert of_sole(biped, run).max() <= 1.0 + BEYOND_SOLE
    assert np.max(np.abs(run.force[:, 0]) / run.force[:, 1]) <= 1.01 * robust_gait.specification.friction


def test_a_walk_that_is_enough_ends_there_and_is_the_start_of_the_longer_one(biped, robust_gait):
    push, seen = shove(biped, robust_gait, 4.0), []

    def enough(speeds):
        seen.append(len(speeds))
        return len(speeds) == 2

    short = held_walk(biped, robust_gait, "ankle", push, steps=2, enough=enough)
    whole = held_walk(biped, robust_gait, "ankle", push, steps=2)
    assert seen == [2]
    assert not short.fell
    assert (short.steps_completed, whole.steps_completed) == (1, 2)
    np.testing.assert_array_equal(short.q, whole.q[: len(short.q)])
    np.testing.assert_array_equal(short.post_impact_speeds, whole.post_impact_speeds[:2])


@pytest.mark.parametrize("ends", [(0.0, 8.0), (8.0, 16.0), (16.0, 32.0), (32.0, 64.0)])
def test_cells_of_pushes_are_where_a_bisection_ends(ends):
    cells = push_cells(*ends, PUSH_RESOLUTION)
    assert (cells[0], cells[-1]) == ends
    for edge in np.linspace(*ends, 100, endpoint=False):
        good, bad = ends
        while bad - good > max(PUSH_RESOLUTION, 0.1 * good):
            middle = 0.5 * (good + bad)
            good, bad = (middle, bad) if middle <= edge else (good, middle)
        assert bad == cells[cells.index(good) + 1]


def test_sizes_of_pushes_are_the_cells_end_to_end():
    sizes = push_sizes(PUSH_RESOLUTION)
    assert sizes == sorted(set(sizes))
    assert (sizes[0], sizes[-1]) == (0.0, 64.0)
    assert {8.0, 16.0, 32.0} < set(sizes)


@pytest.mark.parametrize("count", [2, 3, 7, 8, 37])
def test_the_last_true_is_found_and_the_ends_are_not_asked(count):
    for last in range(count - 1):
        asked = []

        def holds(place, last=last, asked=asked):
            asked.append(place)
            return place <= last

        assert last_true(holds, 0, count - 1) == last
        assert len(asked) == len(set(asked)) <= int(np.ceil(np.log2(count)))
        assert 0 not in asked
        assert count - 1 not in asked


def test_a_promise_is_no_more_than_a_beginning_of_the_walk(biped, robust_gait):
    """A walk that has been looked at goes on as one that has not."""
    walks = {
        looked: PushedWalks(biped, robust_gait, "ankle", time_in_step(robust_gait.step(biped), 0.5))
        for looked in (True, False)
    }
    assert walks[True].promises(4.0)
    assert not walks[True].promises(64.0)
    for impulse in (4.0, 64.0):
        assert walks[True].fate(impulse) == walks[False].fate(impulse)


@pytest.mark.slow
def test_the_largest_push_is_what_all_walks_say(biped, robust_gait):
    """Every push walked to its end, without looking where to look."""
    instant, place = "half-way down", 1.5
    walks = PushedWalks(biped, robust_gait, "ankle", time_in_step(robust_gait.step(biped), place))
    for found, sign in zip(largest_pushes(biped, robust_gait, "ankle", instant, place), (1.0, -1.0), strict=True):
        fates = [walks.fate(sign * size) for size in push_sizes(PUSH_RESOLUTION)]
        first = next(k for k, (why, _) in enumerate(fates) if why)
        assert found.impulse == push_sizes(PUSH_RESOLUTION)[first - 1]
        assert (found.steps_to_recover, found.limited_by) == (fates[first - 1][1], fates[first][0])
