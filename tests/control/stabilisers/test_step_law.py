"""Step law: the poses it may land in, and the width it chooses."""

import numpy as np
import pytest

from frontal_biped.control.stabilisers.step_law import StepLaw
from frontal_biped.exceptions import UnreachablePoseError
from frontal_biped.model.stance_map import relabel


@pytest.fixture(scope="module")
def law(biped, robust_gait):
    return StepLaw(biped, robust_gait)


def test_final_poses_stand_flat_and_begin_the_next_step_alike(biped, robust_gait, law):
    planned = robust_gait.rising.beta_start
    for width in np.linspace(law.narrowest, law.widest, 7):
        pose = law.final_pose(float(width))
        h, v = biped.joint_positions(pose)[-1]
        assert h == pytest.approx(width, abs=1e-12)
        assert v == pytest.approx(biped.joint_positions(pose)[0, 1], abs=1e-12)
        assert biped.swing_foot_rotation(pose) == pytest.approx(0.0, abs=1e-12)
        assert relabel(pose)[0] == pytest.approx(planned, abs=1e-12)


def test_the_gaits_own_width_is_its_own_pose(robust_gait, law):
    falling = robust_gait.falling
    own = np.append(falling.beta_end, falling.joint_bezier[:, -1])
    np.testing.assert_allclose(law.final_pose(robust_gait.step_width), own, atol=1e-12)


def test_feet_cannot_stand_farther_apart_than_the_legs_reach(biped, law):
    with pytest.raises(UnreachablePoseError):
        law.final_pose(4.0 * biped.leg_length)
