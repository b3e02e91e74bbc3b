"""Recordings grow by their numbers alone, and are handed over as they came."""

import tracemalloc

import numpy as np
import pytest

from frontal_biped.gait.file import load_gait
from frontal_biped.model.catalogue import load_robot, models_dir
from frontal_biped.simulation.rows import BLOCK, Rows
from frontal_biped.simulation.trajectory import SAMPLED
from frontal_biped.simulation.walking import walk

OVERHEAD = 1.3
"""Of what a recording may cost over its numbers: room in the last block, and what the rest of a step leaves behind."""


@pytest.mark.parametrize("count", [0, 1, BLOCK - 1, BLOCK, BLOCK + 1, 3 * BLOCK])
def test_rows_come_back_in_order(count):
    rows = Rows(("t", "q"))
    for k in range(count):
        rows.add({"t": k, "q": np.array([k, -k])})
    taken = rows.take()
    np.testing.assert_array_equal(taken["t"], np.arange(count))
    if count:
        np.testing.assert_array_equal(taken["q"], np.stack([np.arange(count), -np.arange(count)], axis=1))
    assert all(values.dtype == float for values in taken.values())


@pytest.mark.parametrize("before", [0, 3, BLOCK, BLOCK + 3])
def test_many_rows_at_once_stand_where_they_came(before):
    rows = Rows(("t", "q"))
    kept = np.arange(before + 10 + 2.0)
    for k in kept[:before]:
        rows.add({"t": k, "q": np.array([k, -k])})
    many = kept[before : before + 10]
    rows.add_many({"t": many, "q": np.stack([many, -many], axis=1)})
    for k in kept[before + 10 :]:
        rows.add({"t": k, "q": np.array([k, -k])})
    taken = rows.take()
    np.testing.assert_array_equal(taken["t"], kept)
    np.testing.assert_array_equal(taken["q"], np.stack([kept, -kept], axis=1))


def test_a_row_is_copied():
    """What moves the robot may use its arrays again."""
    rows, q = Rows(("q",)), np.zeros(2)
    rows.add({"q": q})
    q += 1.0
    np.testing.assert_array_equal(rows.take()["q"], [[0.0, 0.0]])


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["ours", "mujoco"])
def test_a_long_walk_costs_its_recording_and_no_more(engine):
    """From the hundredth step to the three hundredth, memory grows by what the samples themselves take."""
    if engine == "mujoco":
        pytest.importorskip("mujoco")
    steps, held = 300, {}
    robot, gait = load_robot("g1"), load_gait(models_dir() / "g1.gait.json")

    def on_step(done):
        if done in (100, steps - 1):
            held[done] = tracemalloc.get_traced_memory()[0]

    tracemalloc.start()
    try:
        run = walk(robot, gait, engine=engine, steps=steps, on_step=on_step)
    finally:
        tracemalloc.stop()
    assert run.steps_completed == steps
    recorded = sum(getattr(run, name)[(run.step >= 100) & (run.step < steps - 1)].nbytes for name in SAMPLED)
    block = BLOCK * recorded / np.count_nonzero((run.step >= 100) & (run.step < steps - 1))
    assert held[steps - 1] - held[100] < OVERHEAD * recorded + block
