"""The robustness card: its numbers against runs of the full model."""

import numpy as np
import pytest

from frontal_biped.analysis.push_recovery import RECOVERED, held_walk, largest_pushes
from frontal_biped.analysis.return_map import Basin, RestrictedMap
from frontal_biped.analysis.robustness import MapSummary, RobustnessCard, robustness_card
from frontal_biped.control import make_stabiliser
from frontal_biped.library import worker_processes
from frontal_biped.simulation import Push


@pytest.fixture(scope="module")
def card(biped, robust_gait):
    return robustness_card(biped, robust_gait, stabilisers=("ankle",), instants=())


def test_card_of_the_robust_gait(card: RobustnessCard, robust_gait):
    assert card.gait_multiplier == robust_gait.orbit.multiplier
    basin = card.basins["ankle"]
    assert basin.low <= 0.6  # bound of the design: -40 % .. +60 %
    assert basin.high >= 1.6
    # dead-beat: one step, so the norm is that of the disturbance itself
    assert max(map(abs, card.slopes["ankle"])) < 0.01
    assert card.sensitivity_norm["ankle"] == pytest.approx(1.0, abs=1e-3)
    assert card.barrier_margin > 0.0
    assert all(text for _, text in card.rows())
    assert "speeds that return, ankle" in str(card)


def test_norm_is_that_of_the_errors_of_a_return(biped, level_gait):
    """Against the map itself, step after step until nothing is left.

    Late reversals obey rho, whose curvature in the relative speed is m (1 - m) with m the multiplier: over a return it
    changes every error by at most half the first one. The slope is a one-sided difference, good to 1e-4, which the norm
    magnifies by m / (1 - m^2).
    """
    restricted = RestrictedMap(biped, level_gait, make_stabiliser("re-anchored", biped, level_gait))
    summary = MapSummary(restricted.slope(), Basin(1.0, 1.0, "", ""), ())
    first, m = 1e-3, level_gait.orbit.multiplier
    landed, errors = restricted.start(1.0 + first), [first]
    while errors[-1] > 1e-3 * first:
        landed = restricted.step(landed).landed
        errors.append(restricted.speed_ratio(landed) - 1.0)
    measured = np.sqrt(np.sum(np.square(errors))) / first
    assert summary.sensitivity_norm == pytest.approx(measured, rel=0.5 * first + 1e-4 * m / (1.0 - m**2))


@pytest.mark.parametrize("slope", [(0.3, 1.0), (-1.2, 0.3)])
def test_norm_of_what_does_not_return_is_infinite(slope):
    assert MapSummary(slope, Basin(1.0, 1.0, "", ""), ()).sensitivity_norm == np.inf


def test_edges_of_a_basin_are_edges(biped, level_gait):
    restricted = RestrictedMap(biped, level_gait, make_stabiliser("ankle", biped, level_gait))
    basin = restricted.basin(low=0.5, high=2.0)
    assert restricted.follow(basin.low).returned
    assert restricted.follow(basin.high).returned
    assert basin.low < 0.9 < 1.2 < basin.high


@pytest.mark.slow
def test_card_of_worker_processes_is_the_same(biped, robust_gait, card: RobustnessCard):
    with worker_processes(2) as executor:
        shared = robustness_card(biped, robust_gait, stabilisers=("ankle",), instants=(), executor=executor)
    assert str(shared) == str(card)
    assert shared.as_dict() == card.as_dict()


@pytest.mark.slow
def test_largest_push_is_survived_and_a_larger_one_is_not(biped, robust_gait):
    found = largest_pushes(biped, robust_gait, "ankle", "at the reversal", 1.0)[0]
    assert found.impulse > 10.0
    assert found.limited_by
    start = robust_gait.step(biped).rising.duration
    for factor, falls in ((1.0, False), (1.3, True)):
        push = Push(start, 0.05, factor * found.impulse)
        run = held_walk(biped, robust_gait, "ankle", push, steps=6)
        last = run.post_impact_speeds[-1] / robust_gait.orbit.beta_dot_after_impact
        assert (run.fell or abs(last - 1.0) > RECOVERED) == falls
