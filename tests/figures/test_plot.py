"""Figures that show themselves in a notebook, and `run.plot`."""

import pickle

import pytest

from frontal_biped.exceptions import UnknownNameError
from frontal_biped.figures.inline import InlineFigure
from frontal_biped.figures.write import FIGURES
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
