"""Figures: there, labelled with units, and safe to put on one page."""

import builtins
import re
import sys
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from matplotlib.figure import Figure

from frontal_biped.exceptions import MissingExtraError
from frontal_biped.visualisation import figures
from frontal_biped.visualisation.time_figures import clearance_profile

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
def test_text_is_readable(drawn, name):
    from matplotlib.text import Text

    texts = [text for text in drawn[name].findobj(Text) if text.get_text() and text.get_visible()]
    assert min(text.get_fontsize() for text in texts) >= 8.0


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
    assert figures.figure_svg(figures.torques(biped, orbit)) == texts["torques"]


def test_files_are_written_whole(biped, gait, walk, tmp_path):
    written = figures.write_figures(tmp_path / "new", biped, gait, walk)
    assert {path.stem for path in written} == set(figures.FIGURES)
    assert {path.name for path in (tmp_path / "new").iterdir()} == {path.name for path in written}
    for path in written:
        assert path.read_bytes().startswith(b"<svg" if path.suffix == ".svg" else b"\x89PNG")


def test_a_gait_alone_is_enough_and_so_is_a_run(biped, gait, orbit):
    assert [name for name, _ in figures.all_figures(biped, gait)] == list(figures.FIGURES)
    assert "energy" not in dict(figures.all_figures(biped, None, orbit))
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
    from frontal_biped.return_map import Basin
    from frontal_biped.robustness import RobustnessCard
    from frontal_biped.sensitivity import LossOfInvariance
    from frontal_biped.visualisation.robustness_figures import return_map, sensitivity

    runs = [
        LossOfInvariance(name, shift, shift, 10.0 * shift**2 if name == "fixed" else 1e-9, "completed")
        for name in ("fixed", "adaptive")
        for shift in (-1e-3, -1e-5, 1e-5, 1e-3)
    ]
    drawn = sensitivity(runs)
    assert all(UNIT.search(ax.get_xlabel()) and ax.has_data() for ax in drawn.get_axes())
    speeds = np.linspace(0.5, 1.5, 11)
    card = RobustnessCard(
        gait_multiplier=0.8,
        slopes={"adaptive": (0.8, 0.8)},
        basins={"adaptive": Basin(0.6, 1.4, "", "")},
        sensitivity_norm={"adaptive": 1.7},
        barrier_margin=1.0,
        sampled_maps={"adaptive": tuple((x, 1.0 + 0.8 * (x - 1.0)) for x in speeds)},
        push_stabiliser="ankle",
        pushes=(),
    )
    ax = return_map(card).get_axes()[0]
    assert ax.has_data()
    assert UNIT.search(ax.get_xlabel())
    assert UNIT.search(ax.get_ylabel())
