"""Run files: exact round trip, and refusals that name the file."""

import dataclasses

import numpy as np
import pytest

from frontal_biped.exceptions import TrajectoryFileError, UnknownNameError
from frontal_biped.gait.file import load_gait
from frontal_biped.model.catalogue import load_robot
from frontal_biped.model.urdf.description import ROLL_JOINTS
from frontal_biped.simulation import SimulationSettings, load_trajectory, save_trajectory
from frontal_biped.simulation.orbit import orbit_trajectory
from frontal_biped.simulation.trajectory import SAMPLED
from frontal_biped.simulation.walking import simulate
from frontal_biped.simulation.whole_robot import whole_motion


@pytest.fixture(scope="module")
def run(biped, level_gait):
    return simulate(
        biped,
        level_gait,
        steps=2,
        period=2e-3,
        stabiliser="adaptive",
        simulation_settings=SimulationSettings(record_rate=100.0),
    )


def test_round_trip_is_exact(run, tmp_path):
    path = tmp_path / "run.npz"
    save_trajectory(run, path)
    back = load_trajectory(path)
    for field in dataclasses.fields(run):
        a, b = getattr(run, field.name), getattr(back, field.name)
        assert np.array_equal(a, b) if isinstance(a, np.ndarray) else a == b, field.name
    assert [p.name for p in tmp_path.iterdir()] == ["run.npz"]


def test_samples_are_ordered_in_time_and_aligned(run):
    assert np.all(np.diff(run.t) >= 0.0)
    assert {len(getattr(run, name)) for name in SAMPLED} == {len(run.t)}
    assert run.event_kind == ("IMPACT", "REVERSAL", "IMPACT", "REVERSAL", "IMPACT")


def test_first_steps(run):
    part = run.first_steps(1)
    assert set(part.step) == {0.0}
    assert part.event_kind == ("IMPACT", "REVERSAL", "IMPACT")
    assert part.steps_completed == 1
    assert len(part.post_impact_states()) == 2


@pytest.mark.parametrize("content", [b"", b"not a zip", b"PK\x03\x04 cut off"])
def test_unreadable_files_are_refused_in_one_line(tmp_path, content):
    path = tmp_path / "run.npz"
    path.write_bytes(content)
    with pytest.raises(TrajectoryFileError, match=r"run\.npz.*simulate") as error:
        load_trajectory(path)
    assert "\n" not in str(error.value)


def test_missing_truncated_and_foreign_archives_are_refused(run, tmp_path):
    with pytest.raises(TrajectoryFileError, match="no such run file"):
        load_trajectory(tmp_path / "absent.npz")
    path = tmp_path / "run.npz"
    save_trajectory(run, path)
    path.write_bytes(path.read_bytes()[:-500])
    with pytest.raises(TrajectoryFileError):
        load_trajectory(path)
    np.savez(path, x=np.zeros(3))
    with pytest.raises(TrajectoryFileError):
        load_trajectory(path)
    np.savez(path, header=np.array('{"format": "something else"}'))
    with pytest.raises(TrajectoryFileError, match="not a run file"):
        load_trajectory(path)


def test_by_name_a_leg_is_a_leg_whichever_foot_stands(biped, run):
    """This robot's URDF axes point along +X and its joints are at 0 upright, so both namings are the same numbers."""
    motion = whole_motion(biped, run)
    for ours, whole in (
        (run.positions, motion.positions),
        (run.velocities, motion.velocities),
        (run.torques, motion.torques),
    ):
        assert tuple(ours) == ROLL_JOINTS
        for key, name in biped.description.joints.items():
            np.testing.assert_allclose(ours[key], whole[name], atol=1e-12)
    assert set(run.stance) == {1.0, -1.0}
    np.testing.assert_array_equal(run.positions["left_hip"].shape, run.t.shape)
    with pytest.raises(UnknownNameError, match="no joint 'left_hip_roll'; did you mean 'left_hip'"):
        run.torques["left_hip_roll"]


def test_the_urdfs_own_names_are_about_the_urdfs_axes():
    """As the whole robot has them; human's ankle and right hip roll joints turn about -X."""
    human = load_robot("human")
    assert set(human.stance_map.axis_sign) == {-1.0, 1.0}
    run = orbit_trajectory(human, load_gait("human"), 2)
    whole = whole_motion(human, run)
    for part, name in human.description.joints.items():
        assert name not in ROLL_JOINTS
        for kind in ("positions", "velocities", "torques"):
            np.testing.assert_allclose(getattr(run, kind)[name], getattr(whole, kind)[name], atol=1e-12)
        sign = human.stance_map.axis_sign[ROLL_JOINTS.index(part)]
        np.testing.assert_allclose(run.torques[name], sign * run.torques[part], atol=1e-12)
    assert list(run.torques) == list(ROLL_JOINTS)
    with pytest.raises(UnknownNameError, match="did you mean 'left_hip_X'"):
        run.torques["left_hip_x"]
