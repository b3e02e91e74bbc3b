"""The table's answers are the computed ones: same stretch, same falling phase, on every interval and at its ends."""

from dataclasses import replace

import numpy as np
import pytest

from frontal_biped.analysis.return_map import RestrictedMap
from frontal_biped.control.stabilisers.look_ahead import LookAheadTransitions
from frontal_biped.control.stabilisers.tabulation import CELL, ENDS, tabulated
from frontal_biped.control.stabilisers.transitions import REJOINS
from frontal_biped.gait.look_ahead_table import LENGTHS, LookAheadTable
from frontal_biped.zero_dynamics.half_steps import ConstrainedState, rising_energy

SAME = 1e-9  # [rad] of a falling phase: its reversal is located to rounding, twice


@pytest.fixture(scope="module")
def narrow(biped, level_gait):
    """The level gait with a table of the speeds near its own."""
    return tabulated(biped, level_gait, slowest=0.98, fastest=1.01)


def differences(biped, gait, ratios):
    """Speeds at which table and computation differ."""
    looked_up, full = LookAheadTransitions(biped, gait), LookAheadTransitions(biped, gait, look_up=False)
    start = RestrictedMap(biped, gait, full).start
    found = []
    for ratio in ratios:
        landed = start(ratio)
        assert looked_up._table.stretch(ratio) is not None
        ours, theirs = looked_up.rising(landed), full.rising(landed)
        reversal = rising_energy(biped, theirs).reversal(landed.dbeta)
        down, also = looked_up.falling(ours, reversal), full.falling(theirs, reversal)
        beta = np.linspace(reversal, gait.falling.beta_end, 9)
        off = np.max(np.abs(down.motion(beta).q - also.motion(beta).q))
        if ours.beta_end != theirs.beta_end or off > SAME:
            found.append(ratio)
    return found


def test_answers_are_the_computed_ones(biped, narrow):
    rng = np.random.default_rng(18)
    table = narrow.look_ahead
    assert table.low[0] <= 0.98
    assert table.high[-1] >= 1.01 - CELL
    assert differences(biped, narrow, rng.uniform(0.98, 1.01 - CELL, 12)) == []


def test_ends_of_the_intervals_are_where_the_answer_changes(biped, narrow):
    table: LookAheadTable = narrow.look_ahead
    full = LookAheadTransitions(biped, narrow, look_up=False)
    assert len(table.low) > 3
    assert np.array_equal(table.low[1:], table.high[:-1])
    for end, before, after in zip(table.high[:-1], table.choices[:-1], table.choices[1:], strict=True):
        assert full.foreseen(end - ENDS).choice == before
        assert full.foreseen(end + ENDS).choice == after


def test_file_knows_as_many_lengths_as_there_are():
    assert len(REJOINS) == LENGTHS


def test_table_of_another_gait_is_left_aside(biped, narrow, reference_gait):
    other = replace(reference_gait, look_ahead=narrow.look_ahead)
    assert LookAheadTransitions(biped, narrow)._table is narrow.look_ahead
    assert LookAheadTransitions(biped, other)._table is None
    heavier = biped.with_mass(1.01 * biped.mass)
    assert LookAheadTransitions(heavier, narrow)._table is None


def test_phases_are_anchored_to_where_the_robot_is(biped, narrow):
    """Off the planned pose too: only what is chosen is looked up."""
    looked_up = LookAheadTransitions(biped, narrow)
    planned = RestrictedMap(biped, narrow, looked_up).start(0.985)
    landed = ConstrainedState(planned.q + 1e-3 * np.array([1.0, -2.0, 1.0, 0.5]), 1.05 * planned.slope, planned.dbeta)
    rising = looked_up.rising(landed)
    at = rising.motion(landed.q[:1])
    assert at.q[0] == pytest.approx(landed.q, abs=1e-12)
    assert at.dq[0, 1:] == pytest.approx(landed.slope, rel=1e-9)
    reversal = rising_energy(biped, rising).reversal(landed.dbeta)
    down, up = looked_up.falling(rising, reversal).motion(np.array([reversal])), rising.motion(np.array([reversal]))
    assert down.q == pytest.approx(up.q, abs=1e-9)
    assert down.dq == pytest.approx(up.dq, rel=1e-7, abs=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["level"])
def test_a_thousand_speeds_over_the_basin(biped, request, name):
    """Every answer is the computed one, and the basin is the same."""
    gait = tabulated(biped, request.getfixturevalue(f"{name}_gait"))
    basin = RestrictedMap(biped, gait, LookAheadTransitions(biped, gait, look_up=False)).basin()
    assert RestrictedMap(biped, gait, LookAheadTransitions(biped, gait)).basin() == basin
    assert differences(biped, gait, np.random.default_rng(18).uniform(basin.low, basin.high, 1000)) == []
