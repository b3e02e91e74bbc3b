"""Along a path in MuJoCo: from a stand to a stand, where it was to end, and by which steps."""

from types import SimpleNamespace

import numpy as np
import pytest
from whole_robots import whole

from frontal_biped.control.path.language import PathError
from frontal_biped.control.path.pose import Pose
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.space.run import load_spatial_run, save_spatial_run
from frontal_biped.simulation.space.settings import SpatialSettings
from frontal_biped.simulation.space.steps import step_table
from frontal_biped.simulation.space.walk_path import missed, walk_path

pytest.importorskip("mujoco")

ENDS, LOOKS = 0.03, np.radians(1.5)
"""How far from its end a path may end: both feet within 2 cm and 1.5 degrees by odometry (`FollowerSettings`), and what
odometry itself is off on a way of a metre [m, rad]."""

ODOMETRY = 0.02
"""How far odometry is off there: soles slip by a millimetre a step [m]."""

NOISE = Disturbances(encoder_noise=1e-4, imu_noise=1e-3, gyro_noise=5e-3, delay=3e-3)
"""Standard deviations [rad, rad, rad/s], and the delay [s]."""

STILL = 0.02
"""Speed of a robot that stands [m/s]."""

STEP = 0.08
"""Of the first whole step after the one out of the stand, from the orbit's duration [-]."""

WAY = "stand 0.5; forward 0.3; left 0.1; turn 20; stop"


@pytest.fixture(scope="module")
def talos():
    return whole("talos_full")


@pytest.fixture(scope="module")
def walked(talos):
    return walk_path(talos.biped, talos.gait, WAY, disturbances=NOISE)


@pytest.mark.slow
def test_it_ends_where_it_was_to_end(walked):
    assert walked.outcome == "completed"
    assert walked.settings["path"]["arrived"]
    for what in ("ended", "odometry"):
        miss = missed(walked, what)
        assert miss.distance < ENDS and abs(miss.angle) < LOOKS
    told = walked.settings["path"]
    assert np.abs(np.subtract(told["ended"], told["odometry"])).max() < ODOMETRY
    assert walked.yaw[-1] == pytest.approx(np.radians(20.0), abs=LOOKS)


@pytest.mark.slow
def test_it_stands_at_both_ends(walked):
    """Both feet carry half of the weight, and nothing moves."""
    for at in (np.searchsorted(walked.t, 0.4), -1):
        assert walked.contact[at].all()
        assert walked.wrench[at, 0, 2] == pytest.approx(walked.wrench[at, 1, 2], rel=0.1)
        assert np.linalg.norm(walked.com_velocity[at]) < STILL
    feet = walked.sole_position[-1, :, :2]
    assert np.linalg.norm(feet[0] - feet[1]) == pytest.approx(
        np.linalg.norm(np.diff(walked.sole_position[0, :, :2], axis=0)), abs=ENDS
    )


@pytest.mark.slow
def test_it_is_in_the_orbit_after_the_first_step(walked, talos):
    duration = talos.gait.step(talos.biped).duration
    assert step_table(walked).duration[1] == pytest.approx(duration, rel=STEP)


@pytest.mark.slow
def test_limits_are_kept(walked):
    assert np.all(walked.solved == 1)
    measured = walked.settings["measured"]
    assert measured["torque_share"]["largest"] <= 1.0
    assert measured["self_collision"]["touching"] == 0


@pytest.mark.slow
def test_the_run_comes_back_from_its_file(walked, tmp_path):
    save_spatial_run(walked, tmp_path / "run.npz")
    assert missed(load_spatial_run(tmp_path / "run.npz")) == missed(walked)


@pytest.mark.slow
def test_standing_alone(talos):
    run = walk_path(talos.biped, talos.gait, "stand 0.5", disturbances=NOISE)
    assert (run.outcome, run.steps_completed) == ("completed", 0)
    assert 1.0 < run.t[-1] < 1.6  # at rest at the end for a second
    assert np.ptp(run.com[:, :2], axis=0).max() < 0.01


@pytest.mark.slow
def test_a_path_that_takes_too_many_steps_has_not_arrived(talos):
    run = walk_path(talos.biped, talos.gait, "forward 5", settings=SpatialSettings(steps=2))
    assert not run.fell and not run.settings["path"]["arrived"]


def test_words_that_make_no_path_are_refused_at_once(talos):
    with pytest.raises(PathError, match="known: stand"):
        walk_path(talos.biped, talos.gait, "hop 3")


def test_what_is_missed_is_told_in_the_axes_of_the_end():
    ended = list(Pose(1.0, 2.0, 0.5).moved(0.03, -0.04, 0.1))
    told = SimpleNamespace(settings={"path": {"asked": [1.0, 2.0, 0.5], "ended": ended}})
    assert missed(told) == pytest.approx((0.05, 0.1))
