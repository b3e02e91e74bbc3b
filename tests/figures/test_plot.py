"""Figures that show themselves in a notebook, and `run.plot`."""

import pickle
from dataclasses import replace

import pytest

from frontal_biped.exceptions import RobotError, UnknownNameError
from frontal_biped.figures.inline import InlineFigure
from frontal_biped.figures.write import FIGURES
from frontal_biped.gait.file import gait_to_dict
from frontal_biped.simulation.orbit import orbit_trajectory

pytest.importorskip("matplotlib")


@pytest.fixture(scope="module")
def run(biped, gait):
    return orbit_trajectory(biped, gait, 2)


def test_a_run_plots_its_first_figure_and_others_by_name(run, biped):
    first, torques = run.plot(), run.plot("torques", biped)
    assert (first.get_label(), torques.get_label()) == ("joint_angles", "torques")
    assert len(first.axes) == 4 and len(torques.axes) == 1


def test_a_figure_is_a_picture_for_a_notebook_and_travels(run):
    figure = pickle.loads(pickle.dumps(run.plot("phase_portrait")))
    assert isinstance(figure, InlineFigure)
    picture = figure._repr_png_()
    width = int.from_bytes(picture[16:20], "big")
    assert picture.startswith(b"\x89PNG") and width == round(144 * figure.get_figwidth())


def test_a_figure_that_the_run_has_not_is_told_with_those_it_has(run, biped, gait):
    with pytest.raises(UnknownNameError, match="no figure 'torqes' of this run; did you mean 'torques'"):
        run.plot("torqes")
    with pytest.raises(UnknownNameError, match="no figure 'energy' of this run"):
        run.plot("energy")  # a figure of the gait, which an orbit does not tell
    assert "energy" in FIGURES


def test_figures_of_a_changed_robot_want_that_robot(run, biped, gait):
    """Its weight and its energy are not those of the files."""
    changed = replace(run, gait=gait_to_dict(replace(gait, robot=replace(gait.robot, fingerprint="of another"))))
    with pytest.raises(RobotError, match="with another URDF or description"):
        changed.plot()
    assert changed._repr_html_() is None
    assert changed.plot("energy", biped).get_label() == "energy"
