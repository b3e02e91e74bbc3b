"""Figures: there, labelled with units, and safe to put on one page."""

import builtins
import re
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from figure_laws import assert_fit_for_a_column
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.text import Annotation

from frontal_biped.analysis.free_landing import free_landing
from frontal_biped.exceptions import MissingExtraError, RobotError
from frontal_biped.figures import write as figures
from frontal_biped.figures.robustness import smooth
from frontal_biped.figures.time import clearance_profile
from frontal_biped.gait import load_any_gait, load_gait
from frontal_biped.model import Robot, load_robot, models_dir
from frontal_biped.simulation.walking import simulate

UNIT = re.compile(r"\[[^\]]+\]")


@pytest.fixture(scope="module")
def drawn(biped, gait, orbit):
    return dict(figures.all_figures(biped, gait, orbit))


def test_all_are_there(drawn):
    assert list(drawn) == list(figures.FIGURES)


@pytest.mark.parametrize("name", figures.FIGURES)
def test_axes_are_labelled_with_units(drawn, name):
    figure = drawn[name]
    assert isinstance(figure, Figure)
    axes = figure.get_axes()
    assert axes
    assert UNIT.search(axes[-1].get_xlabel())
    for ax in axes:
        assert UNIT.search(ax.get_ylabel())
        assert ax.has_data()


@pytest.mark.parametrize("name", figures.FIGURES)
def test_fits_a_column(drawn, name):
    assert_fit_for_a_column(drawn[name])


def test_the_check_of_columns_can_fail():
    crowded = Figure(figsize=(3.5, 2.0))
    ax = crowded.add_subplot()
    ax.text(0.5, 0.5, "one text here", fontsize=8.0)
    ax.text(0.52, 0.5, "another text over it", fontsize=8.0)
    with pytest.raises(AssertionError):
        assert_fit_for_a_column(crowded)
    small = Figure(figsize=(3.5, 2.0))
    small.add_subplot().set_title("small", fontsize=6.0)
    with pytest.raises(AssertionError):
        assert_fit_for_a_column(small)


@pytest.mark.parametrize("name", figures.FIGURES)
def test_curves_differ_in_more_than_colour(drawn, name):
    for ax in drawn[name].get_axes():
        labelled = [line for line in ax.get_lines() if not line.get_label().startswith("_")]
        looks = {(str(line.get_linestyle()), line.get_linewidth(), line.get_marker()) for line in labelled}
        assert len(looks) == len(labelled)


def test_pyplot_is_never_loaded(drawn):
    assert "matplotlib.pyplot" not in sys.modules


def test_svgs_share_no_ids_and_are_reproducible(biped, orbit, drawn):
    texts = {name: figures.figure_svg(figure) for name, figure in drawn.items()}
    seen = [set(re.findall(r'\bid="([^"]+)"', text)) for text in texts.values()]
    assert len(set.union(*seen)) == sum(len(ids) for ids in seen)
    for text in texts.values():
        assert text.startswith("<svg")
        ids = set(re.findall(r'\bid="([^"]+)"', text))
        assert set(re.findall(r'(?:href="#|url\(#)([^")]+)', text)) <= ids
        ElementTree.fromstring(text)
        assert not re.findall(r'(?:href|src)="https?:', text)
    once, again = (figures.figure_svg(figures.torques(biped, orbit)) for _ in range(2))
    assert once == again


def test_files_are_written_whole(biped, gait, walk, tmp_path):
    written = figures.write_figures(tmp_path / "new", biped, gait, walk)
    assert {path.stem for path in written} == set(figures.FIGURES)
    assert {path.name for path in (tmp_path / "new").iterdir()} == {path.name for path in written}
    for path in written:
        assert path.read_bytes().startswith(b"<svg" if path.suffix == ".svg" else b"\x89PNG")


def test_a_gait_alone_is_enough_and_so_is_a_run(biped, gait, orbit):
    assert [name for name, _ in figures.all_figures(biped, gait)] == list(figures.FIGURES)
    assert not {"energy", "barrier"} & set(dict(figures.all_figures(biped, None, orbit)))
    with pytest.raises(ValueError, match="gait or a run"):
        figures.all_figures(biped, None)


def test_draws_into_given_axes(biped, orbit):
    own = Figure()
    axes = own.subplots(1, 3)
    assert figures.torques(biped, orbit, ax=axes[0]) is own
    assert figures.phase_portrait(orbit, ax=axes[1]) is own
    assert figures.swing_foot_height(biped, orbit, ax=axes[2]) is own
    assert all(ax.has_data() for ax in axes)


def test_joint_figure_shows_the_data(orbit, drawn):
    line = next(line for line in drawn["joint_angles"].get_axes()[1].get_lines() if line.get_label() == "desired")
    values = line.get_ydata()
    two_steps = orbit.first_steps(2)
    np.testing.assert_allclose(values[np.isfinite(values)], two_steps.q_b_desired[:, 0])


def jumps_drawn(figure):
    """The places that arrows lead from and to."""
    return [(note.xyann, note.xy) for note in figure.get_axes()[0].texts if isinstance(note, Annotation)]


def test_a_phase_portrait_draws_a_jump_once_where_the_robot_repeats_it(biped, gait):
    """A line bridges no event: it has a gap wherever the phase changes."""
    steps = 3
    periodic = simulate(biped, gait, steps=steps, period=None)
    portrait = figures.phase_portrait(periodic)
    assert len(jumps_drawn(portrait)) == 1
    disturbed = simulate(biped, gait, steps=steps, speed_error=0.01, period=None, stabiliser="adaptive")
    changed = jumps_drawn(figures.phase_portrait(disturbed))
    assert len(changed) == steps - 1
    for before, after in changed:
        assert before[1] < 0.0 < after[1]  # dbeta
    for line in portrait.get_axes()[0].get_lines()[:2]:
        assert np.isnan(line.get_ydata()).sum() == steps
        assert np.nanmax(np.abs(np.diff(line.get_ydata()))) < 0.2 * np.nanmax(np.abs(line.get_ydata()))


def test_stick_figures_stand_where_the_joints_are(biped, drawn, orbit):
    parts = [part for part in drawn["snapshots"].get_axes()[0].collections if isinstance(part, LineCollection)]
    pelvis = next(part for part in parts if part.get_linewidth()[0] == 3.0).get_segments()[0]
    hips = biped.joint_positions(orbit.q[0])[1:3]
    assert sorted(pelvis[:, 1]) == pytest.approx(sorted(hips[:, 1]), abs=1e-6)
    assert abs(np.ptp(pelvis[:, 0])) == pytest.approx(np.ptp(hips[:, 0]), abs=1e-6)
    soles = np.concatenate([part.get_segments() for part in parts if part.get_linewidth()[0] == 3.2])
    assert soles[..., 1].min() == pytest.approx(0.0, abs=1e-9)  # one foot stands throughout
    stands = np.abs(soles[..., 1]).max(axis=1) < 1e-9
    assert len(parts[0].get_segments()) <= stands.sum() < len(soles)


def test_clearance_profile_follows_the_specification(gait, orbit):
    profile = clearance_profile(orbit)
    rising = (orbit.step == 0) & (orbit.phase > 0)
    t2 = (gait.rising.beta_end - orbit.q[rising, 0]) / (gait.rising.beta_end - gait.rising.beta_start)
    np.testing.assert_allclose(profile[rising], 1.0 - t2, atol=1e-12)


def test_missing_matplotlib_names_the_extra(biped, orbit, monkeypatch):
    real = builtins.__import__

    def without_matplotlib(name, *rest):
        if name.split(".")[0] == "matplotlib":
            raise ModuleNotFoundError(name)
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without_matplotlib)
    with pytest.raises(MissingExtraError, match=r"pip install 'frontal-biped\[plot\]'"):
        figures.torques(biped, orbit)


def test_robustness_figures_are_labelled():
    from frontal_biped.analysis.return_map import Basin
    from frontal_biped.analysis.robustness import RobustnessCard
    from frontal_biped.analysis.sensitivity import LossOfInvariance
    from frontal_biped.figures.robustness import return_map, sensitivity

    runs = [
        LossOfInvariance(name, shift, shift, 10.0 * shift**2 if name == "fixed" else 1e-9, "completed")
        for name in ("fixed", "re-anchored")
        for shift in (-1e-3, -1e-5, 1e-5, 1e-3)
    ]
    drawn = sensitivity(runs)
    assert all(UNIT.search(ax.get_xlabel()) and ax.has_data() for ax in drawn.get_axes())
    assert_fit_for_a_column(drawn)
    speeds = np.linspace(0.5, 1.5, 11)
    card = RobustnessCard(
        gait_multiplier=0.8,
        slopes={"adaptive": (0.8, 0.8)},
        basins={"adaptive": Basin(0.6, 1.4, "", "")},
        sensitivity_norm={"adaptive": 1.7},
        barrier_margin=1.0,
        sampled_maps={"adaptive": tuple((float(s), 1.0 + 0.8 * (float(s) - 1.0)) for s in speeds)},
        push_stabiliser="ankle",
        pushes=(),
    )
    drawn = return_map(card, "robust gait")
    assert_fit_for_a_column(drawn)
    ax = drawn.get_axes()[0]
    assert "robust gait" in ax.get_legend_handles_labels()[1]
    assert ax.has_data()
    assert UNIT.search(ax.get_xlabel())
    assert UNIT.search(ax.get_ylabel())


def test_barrier_figure_agrees_with_the_simulated_walk(biped, gait, walk):
    """Every step of the walk leaves the impact with the energy that the hill has at its reversal: two routes."""
    from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions
    from frontal_biped.figures.barrier import energy_barrier, run_levels
    from frontal_biped.zero_dynamics.half_steps import rising_energy

    energy = rising_energy(biped, ReanchoringTransitions(biped, gait).planned_rising)
    places, levels = run_levels(biped, walk)
    assert len(places) == walk.steps_completed
    # the walk's post-impact states are within 1e-7 of the gait's; the hill is some 1e4 steep
    np.testing.assert_allclose(levels, [energy.at(min(place, energy.end))[1] for place in places], rtol=1e-4)
    figure = energy_barrier(biped, gait, walk)
    upper, lower = figure.get_axes()
    hill = next(line for line in upper.get_lines() if "hill" in line.get_label())
    assert hill.get_ydata().max() == pytest.approx(energy.highest, rel=1e-9)
    said = re.search(r"tips over from ([+-]\d+) % speed", upper.get_xlabel())
    own = 0.5 * (energy.start_inertia * gait.orbit.beta_dot_after_impact) ** 2
    assert int(said[1]) == round(100.0 * (np.sqrt(energy.highest / own) - 1.0))
    # orbits of the lower panel end at rest (a dot at zeta = 0) or go over the top
    assert any("tips over" in text.get_text() for text in upper.texts)
    assert min(np.min(line.get_ydata()) for line in lower.get_lines()) >= 0.0


def test_cost_figure_shows_failures_too():
    from frontal_biped.design import StudyPoint
    from frontal_biped.figures.design import cost_figure

    rolls = [StudyPoint(np.radians(k), None, {"cost": 1000.0 / k} if k > 2 else {}) for k in (20, 10, 5, 2)]
    times = [StudyPoint(k, None, {"cost": 200.0 / k}) for k in (0.4, 0.6, 0.8)]
    figure = cost_figure({"one": rolls, "other": rolls}, {"one": times})
    assert_fit_for_a_column(figure)
    upper, lower = figure.get_axes()
    assert UNIT.search(upper.get_xlabel()) and UNIT.search(lower.get_xlabel())
    np.testing.assert_allclose(upper.get_lines()[0].get_xdata(), [5.0, 10.0, 20.0])
    np.testing.assert_allclose(upper.get_lines()[1].get_xdata(), [2.0])  # the cross


def test_travel_figure_leaves_out_what_does_not_travel():
    from frontal_biped.design import TravelPoint
    from frontal_biped.figures.design import travel_figure

    gait = load_any_gait(Path(__file__).parents[1] / "data" / "sideways.gait.json")
    on_the_spot = replace(gait, a=replace(gait.a, step_width=gait.b.step_width))
    points = [TravelPoint(0.1, 0.8, one, "") for one in (on_the_spot, gait, None)]
    figure = travel_figure({"one": points, "other": points})
    assert_fit_for_a_column(figure)
    upper, lower = figure.get_axes()
    assert all(UNIT.search(text) for text in (upper.get_ylabel(), lower.get_ylabel(), lower.get_xlabel()))
    for ax, cost in ((upper, gait.cost_of_travel), (lower, gait.cost)):
        np.testing.assert_allclose(ax.get_lines()[0].get_xydata(), [[gait.speed, cost]])


@pytest.mark.parametrize("kind", figures.FORMATS)
def test_each_format_is_written(kind, biped, orbit, tmp_path):
    (path,) = figures.write_figure(tmp_path, "torques", figures.torques(biped, orbit), (kind,))
    start = {"svg": b"<svg", "pdf": b"%PDF", "png": b"\x89PNG"}[kind]
    assert path.read_bytes().startswith(start)
    again = figures.write_figure(tmp_path / "again", "torques", figures.torques(biped, orbit), (kind,))[0]
    assert again.read_bytes() == path.read_bytes()


# ---------------------------------------------------------------------- robots with joints besides the four roll joints
@pytest.fixture(scope="module")
def humanoid():
    return load_robot("talos_full"), load_gait(models_dir() / "talos_full.gait.json")


@pytest.fixture(scope="module")
def landing(humanoid):
    return free_landing(*humanoid)


def test_figures_in_space_come_behind_the_others(humanoid):
    names = [name for name, _ in figures.all_figures(*humanoid)]
    assert names == [*figures.FIGURES, *figures.FIGURES_IN_SPACE]


def test_landing_fits_a_column(landing):
    for rotors in (0.0, 0.1):
        figure = figures.free_landing_figure(landing, rotors)
        assert_fit_for_a_column(figure)
        axes = figure.get_axes()
        assert UNIT.search(axes[-1].get_xlabel()) and all(UNIT.search(ax.get_ylabel()) for ax in axes)


def test_landing_shows_the_numbers(landing):
    """Curve, line and mark of the first panel; where rotors do nothing the mark is at the left end."""
    curve, line, mark = figures.free_landing_figure(landing, 0.1).get_axes()[0].get_lines()
    np.testing.assert_array_equal(curve.get_ydata(), [one.vertical_impulse for one in landing.swept])
    assert set(line.get_ydata()) == {landing.planar.vertical_impulse}
    assert (mark.get_xdata()[0], mark.get_ydata()[0]) == (0.1, landing.described.vertical_impulse)
    *_, mark = figures.free_landing_figure(landing, 0.0).get_axes()[0].get_lines()
    assert mark.get_xdata()[0] == curve.get_xdata()[0] == landing.swept[0].rotors


def test_feet_of_unknown_length_leave_the_landing_out(humanoid, monkeypatch):
    def unknown(self):
        raise RobotError("the length of the sole cannot be measured")

    monkeypatch.setattr(Robot, "soles", property(unknown))
    assert [name for name, _ in figures.all_figures(*humanoid)] == list(figures.FIGURES)


def test_a_smooth_curve_passes_through_its_points_without_corners_and_without_humps():
    x = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 2.5])
    y = np.array([0.0, 0.6, 1.0, 1.0, np.nan, 2.0])
    fine, curve = smooth(x, y)
    known = np.isfinite(curve)
    for a, b in zip(x[:4], y[:4], strict=True):
        assert curve[known][np.argmin(np.abs(fine[known] - a))] == pytest.approx(b, abs=1e-12)
    assert np.all(np.diff(curve[known]) >= -1e-12)
    slope = np.diff(curve[known]) / np.diff(fine[known])
    assert np.abs(np.diff(slope)).max() < 0.2  # the broken line turns by 0.8 at its last corner
    assert fine[known].max() == 1.5  # the point beyond the gap stands alone
