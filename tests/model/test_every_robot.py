"""The shared laws on every packaged robot."""

import pytest
from robot_laws import LAWS

from frontal_biped.model import load_robot, robot_names

THIRTEEN = {
    "alexander", "frontal_biped", "frontal_biped_low_torso", "g1", "g1_bent", "human", "icub", "icub_bent", "romeo",
    "romeo_bent", "simple_humanoid_bent", "simple_humanoid_classical", "talos_full",
}  # fmt: skip


def test_the_packaged_robots():
    assert set(robot_names()) >= THIRTEEN


@pytest.fixture(scope="module", params=sorted(THIRTEEN))
def packaged(request):
    return load_robot(request.param)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.__name__)
def test_law(packaged, law):
    law(packaged)
