"""Specifications that cannot be met: what is said, and that what is advised is true."""

import numpy as np
import pytest

from frontal_biped.design import optimise_gait
from frontal_biped.design.explanation import Conflict, remedy
from frontal_biped.gait import GaitSpecification

ROUNDING = 1e-9


@pytest.fixture(scope="module")
def impossible(biped):
    """The pelvis level to a twentieth of a degree, and the foot to be lifted by five centimetres."""
    return GaitSpecification(max_pelvis_roll=0.001, swing_clearance=0.05)


@pytest.fixture(scope="module")
def refused(biped, impossible):
    return optimise_gait(biped, impossible)


class TestRefusal:
    def test_no_gait_and_one_line(self, refused):
        assert not refused.success
        assert refused.gait is None
        assert "\n" not in refused.message
        assert "contradict" in refused.message

    def test_the_contradiction_names_the_bounds_that_were_made_to_clash(self, refused):
        keys = {conflict.key for conflict in refused.conflicts}
        assert "max_pelvis_roll" in keys
        assert keys & {"swing_clearance", "step_width[1]", "step_width[0]"}

    def test_weights_are_shares(self, refused):
        weights = [conflict.weight for conflict in refused.conflicts]
        assert weights == sorted(weights, reverse=True)
        assert all(0.0 < weight <= 1.0 + ROUNDING for weight in weights)
        assert all(conflict.relief > 0.0 for conflict in refused.conflicts)

    def test_every_conflict_says_what_is_missed(self, refused):
        for conflict in refused.conflicts:
            text = str(conflict)
            assert conflict.code in text and conflict.name in text
        assert any(conflict.shortfall > 0.0 for conflict in refused.conflicts)

    def test_the_remedy_is_a_cure(self, biped, refused, impossible):
        """The advised change, and nothing else, is designed for from scratch: a gait."""
        cure = refused.remedy
        assert cure is not None
        assert cure.key in refused.message and f"{cure.new:.4g}" in refused.message
        before, after = impossible.as_dict(), cure.specification.as_dict()
        name = cure.key.partition("[")[0]
        assert {key for key in after if after[key] != before.get(key)} == {name}
        assert optimise_gait(biped, cure.specification).success


@pytest.mark.parametrize(
    ("key", "looser"),
    [
        ("friction", +1), ("max_pelvis_roll", +1), ("swing_clearance", -1), ("step_duration[0]", -1),
        ("step_duration[1]", +1), ("max_torque[2]", +1), ("min_normal_force", -1), ("step_width[1]", +1),
    ],
)  # fmt: skip
def test_bounds_are_relaxed_in_the_right_direction(biped, key, looser):
    specification = GaitSpecification(max_pelvis_roll=0.1)
    cause = Conflict("C06", "anything", key, "", 0.0, 0.001, 1.0, 0.001)
    tried = []

    def feasible(changed):
        tried.append(changed)
        return True

    cure = remedy(biped, specification, (cause,), feasible)
    assert cure is not None
    assert np.sign(cure.new - cure.old) == looser
    assert tried == [cure.specification]


def test_bounds_of_the_robot_have_no_remedy(biped):
    cause = Conflict("C07", "impulse in the sole", "", "m", 0.05, 0.01, 1.0, 0.01)
    assert remedy(biped, GaitSpecification(), (cause,), lambda changed: True) is None
