"""Gaits between the gaits of a library: invariant and periodic wherever they lie."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frontal_biped.exceptions import LibraryError, SpecificationError
from frontal_biped.library import GaitLibrary

RESIDUAL = 1e-9
"""What a gait may be off from being one, blended or not."""


@pytest.fixture(scope="module")
def library(built):
    return GaitLibrary(built[0])


@given(
    width=st.floats(0.28, 0.32),
    roll=st.floats(0.12, 0.16),
)
@settings(max_examples=8)
def test_blends_are_gaits(biped, library, width, roll):
    blended = library.blend(biped, {"step_width": (width, width), "max_pelvis_roll": roll})
    assert max(blended.gait.residuals(biped).values()) < RESIDUAL
    assert 0.0 < blended.gait.orbit.multiplier < 1.0
    assert sum(blended.weights) == pytest.approx(1.0)
    assert blended.gait.step_width == pytest.approx(width, abs=1e-6)


def test_blends_nearly_keep_the_blended_bounds(biped, library):
    """Half-way between neighbours the constraints are missed, if at all, by the square of the distance."""
    blended = library.blend(biped, {"step_width": (0.30, 0.30), "max_pelvis_roll": 0.13})
    worst = min(check.margin / check.scale for check in blended.report.checks)
    assert worst > -0.05, str(blended.report)


def test_on_the_grid_the_blend_is_the_gait(biped, library):
    blended = library.blend(biped, {"step_width": (0.28, 0.28), "max_pelvis_roll": 0.14})
    assert blended.neighbours == (1,) and blended.weights == (1.0,)
    assert blended.gait.orbit.cost == pytest.approx(library.gait(1).orbit.cost, rel=1e-9)
    assert blended.report.satisfied


@pytest.mark.parametrize(
    ("at", "word"),
    [
        ({"step_width": (0.3, 0.3)}, "no value for axis 'max_pelvis_roll'"),
        ({"step_width": (0.3, 0.3), "max_pelvis_roll": 0.13, "friction": 0.5}, "no axis 'friction'"),
        ({"step_width": (0.3, 0.3), "max_pelvis_roll": 0.2}, "not between"),
        ({"step_width": (0.28, 0.32), "max_pelvis_roll": 0.13}, "not between"),
        ({"step_width": 0.3, "max_pelvis_roll": 0.13}, "does not look like the axis"),
    ],
)
def test_refused(biped, library, at, word):
    with pytest.raises(SpecificationError) as caught:
        library.blend(biped, at)
    assert word in str(caught.value)


def test_another_robot_is_refused(low_torso, library):
    with pytest.raises(SpecificationError, match="not in the library"):
        library.blend(low_torso, {"step_width": (0.3, 0.3), "max_pelvis_roll": 0.13})


def test_no_library(tmp_path):
    with pytest.raises(LibraryError, match="not a gait library"):
        GaitLibrary(tmp_path)
