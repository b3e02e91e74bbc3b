"""Figures of walks in space: there, labelled with units, fit for a column, of the numbers of the run."""

import re
from dataclasses import replace

import numpy as np
import pytest
from figure_laws import assert_fit_for_a_column
from swept_walk import swept_walk

from frontal_biped.figures.space import SPACE_FIGURES, all_space_figures, footsteps_figure, write_space_figures
from frontal_biped.gait.file import load_gait
from frontal_biped.model import load_robot, models_dir
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.simulation.orbit import orbit_trajectory

UNIT = re.compile(r"\[[^\]]+\]")


@pytest.fixture(scope="module")
def talos():
    biped = load_robot("talos_full")
    gait = load_gait(models_dir() / "talos_full.gait.json")
    return FreeRobot(biped.robot), swept_walk(biped, gait, steps=4), gait, orbit_trajectory(biped, gait, 1)


@pytest.fixture(scope="module")
def drawn(talos):
    return dict(all_space_figures(*talos))


def test_all_are_there(drawn):
    assert list(drawn) == list(SPACE_FIGURES)


@pytest.mark.parametrize("name", SPACE_FIGURES)
def test_labelled_with_units_and_fit_for_a_column(drawn, name):
    axes = drawn[name].get_axes()
    for ax in axes:
        assert ax.has_data()
        assert UNIT.search(ax.get_xlabel())
    assert UNIT.search(axes[0].get_ylabel())
    assert_fit_for_a_column(drawn[name])


@pytest.mark.parametrize("name", SPACE_FIGURES)
def test_curves_differ_in_more_than_colour(drawn, name):
    for ax in drawn[name].get_axes():
        labelled = [line for line in ax.get_lines() if not line.get_label().startswith("_")]
        looks = {(str(line.get_linestyle()), line.get_linewidth(), line.get_marker()) for line in labelled}
        assert len(looks) == len(labelled)


def test_joints_are_shown_at_their_largest_share(talos, drawn):
    robot, run, *_ = talos
    torque = next(line for line in drawn["joint_limits"].get_axes()[0].get_lines() if line.get_label() == "torque")
    expected = 100.0 * np.abs(run.tau).max(axis=0) / robot.limits.effort
    np.testing.assert_allclose(torque.get_xdata(), expected)
    names = [text.get_text() for text in drawn["joint_limits"].get_axes()[0].get_yticklabels()]
    assert tuple(names) == robot.joint_names


def test_steps_of_the_swept_orbit_are_on_the_closed_form(drawn):
    """The mid-fall speed of the samples, 5 ms apart, against that of the orbit's own points."""
    lower = drawn["frontal_state"].get_axes()[1]
    steps = next(line for line in lower.get_lines() if line.get_label() == "steps").get_ydata()
    closed = next(line for line in lower.get_lines() if line.get_label() == "closed form").get_ydata()
    np.testing.assert_allclose(steps, closed[0], rtol=1e-3)


def test_a_long_walk_shows_its_start_and_its_end(talos):
    robot, run, *_ = talos
    count = 40
    parts = {name: np.concatenate([getattr(run, name)] * count) for name in ("stance", "phase", "sole_yaw", "com")}
    shift = np.repeat(np.arange(count), len(run.t))
    long = replace(
        run,
        **parts,
        t=np.concatenate([run.t] * count) + shift * run.t[-1],
        step=np.concatenate([run.step] * count) + 4.0 * shift,
        sole_position=np.concatenate([run.sole_position] * count) + 0.8 * shift[:, None, None] * np.eye(3)[0],
        steps_completed=4 * count,
    )
    figure = footsteps_figure(robot, long)
    first, last = figure.get_axes()
    assert first.get_xlim()[1] < 0.1 * last.get_xlim()[0]
    assert "of 160" in last.get_title(loc="right")
    assert_fit_for_a_column(figure)


@pytest.mark.slow
def test_a_fall_without_a_gait_is_drawn_and_written(talos, tmp_path):
    robot, run, *_ = talos
    q = run.q.copy()
    q[-100:] = np.nan
    fallen = replace(run, q=q, steps_completed=0, outcome="fell", gait={})
    written = write_space_figures(tmp_path, robot, fallen, formats=("svg", "png"))
    assert {path.stem for path in written} == set(SPACE_FIGURES)
    for path in written:
        assert path.read_bytes().startswith(b"<svg" if path.suffix == ".svg" else b"\x89PNG")


def test_the_asked_path_is_drawn_where_there_is_one(talos):
    robot, run, *_ = talos
    path = {"path": {"corners": [[0.5, 0.0, 0.0], [0.5, 0.2, 0.0]]}}
    figure = footsteps_figure(robot, replace(run, settings={**run.settings, **path}))
    (asked,) = [line for line in figure.get_axes()[0].get_lines() if line.get_label() == "asked for"]
    np.testing.assert_array_equal(asked.get_xydata(), [[0.0, 0.0], [0.5, 0.0], [0.5, 0.2]])
    plain = footsteps_figure(robot, run)
    assert "asked for" not in {line.get_label() for line in plain.get_axes()[0].get_lines()}
