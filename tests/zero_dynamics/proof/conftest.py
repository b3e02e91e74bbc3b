"""Gaits of two robots, measured: what balls are compared with."""

import pytest

from frontal_biped.gait.file import load_gait
from frontal_biped.gait.shipped import gait_path
from frontal_biped.model.catalogue import biped_of
from frontal_biped.zero_dynamics.reversal.problem import ReversalProblem

NODES = 64
"""Quadrature nodes a phase."""


@pytest.fixture(scope="module", params=["frontal_biped", "g1"])
def problem(request, reference_gait):
    name = request.param
    gait = reference_gait if name == "frontal_biped" else load_gait(gait_path(name))
    return ReversalProblem.of_phases(biped_of(name), gait.rising, gait.falling, gait.step_width, NODES)
