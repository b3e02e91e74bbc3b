"""The shared laws on every packaged robot."""

import pytest
from robot_laws import LAWS

from frontal_biped.model import load_robot, robot_names

NINE = {
    "alexander", "frontal_biped", "frontal_biped_low_torso", "g1", "human", "icub", "romeo",
    "simple_humanoid_classical", "talos_full",
}  # fmt: skip


def test_the_packaged_robots():
    assert set(robot_names()) >= NINE


@pytest.fixture(scope="module", params=sorted(NINE))
def packaged(request):
    return load_robot(request.param)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.__name__)
def test_law(packaged, law):
    law(packaged)
