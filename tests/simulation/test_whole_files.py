"""Archives and logs of the whole robot: what their docstrings say is what is in them."""

import re

import numpy as np
import pytest
from whole_robots import whole

import frontal_biped.simulation.csv_table
import frontal_biped.simulation.mcap_log
import frontal_biped.simulation.whole_arrays
from frontal_biped.cli import main
from frontal_biped.gait.file import save_gait
from frontal_biped.simulation.csv_table import run_table
from frontal_biped.simulation.mcap_log import write_mcap
from frontal_biped.simulation.orbit import orbit_trajectory
from frontal_biped.simulation.whole_arrays import planar_arrays
from frontal_biped.simulation.whole_robot import whole_motion


@pytest.fixture(scope="module")
def step(orbit):
    return orbit.first_steps(1)


def test_every_array_of_an_archive_is_named_and_every_column_too(biped, step):
    text = frontal_biped.simulation.whole_arrays.__doc__
    arrays = planar_arrays(biped, step, 50.0)
    assert [name for name in arrays if f"``{name}``" not in text] == []
    for name in ("pinocchio_q", "pinocchio_v", "pinocchio_tau", "mujoco_qpos", "mujoco_qvel", "mujoco_tau"):
        names = arrays[f"{name}_names"]
        assert arrays[name].shape == (len(arrays["t"]), len(names)) and len(set(names)) == len(names)
        assert all(column.endswith("]") for column in names)
    assert all(f"``{name}``" in text for name in ("com", "com_velocity", "sole_position", "sole_yaw"))
    for frame, names in (("pinocchio_q", arrays["pinocchio_q_names"]), ("mujoco_qpos", arrays["mujoco_qpos_names"])):
        scalar = arrays[frame][:, list(names).index("root quaternion w [-]")]
        assert np.abs(scalar).min() > 0.9  # upright, but for a few degrees


def test_a_gait_becomes_an_archive_that_numpy_alone_reads(gait, tmp_path):
    save_gait(gait, tmp_path / "gait.json")
    target = tmp_path / "whole.npz"
    assert main(["export", str(tmp_path / "gait.json"), "-o", str(target), "--rate", "100"]) == 0
    with np.load(target, allow_pickle=False) as content:
        np.testing.assert_allclose(np.diff(content["t"]), 0.01)
        assert set(content["pinocchio_joints"]) == set(content["mujoco_joints"])
        assert not (content["contact"][:, 0] == content["contact"][:, 1]).any()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["gait.json", "whole.npz"]


def test_more_samples_than_anyone_wants_are_refused(gait, tmp_path, capsys):
    save_gait(gait, tmp_path / "gait.json")
    assert main(["export", str(tmp_path / "gait.json"), "-o", str(tmp_path / "a.npz"), "--rate", "1e12"]) == 2
    assert "--rate 1e+12" in capsys.readouterr().err.splitlines()[-1]
    assert not (tmp_path / "a.npz").exists()


def test_a_log_holds_the_motion_under_the_topics_it_names(biped, step, tmp_path):
    reader = pytest.importorskip("mcap.reader")
    decoder = pytest.importorskip("mcap_ros2.decoder")
    motion = whole_motion(biped, step, 50.0)
    write_mcap(motion, tmp_path / "run.mcap")
    found = {}
    with (tmp_path / "run.mcap").open("rb") as stream:
        opened = reader.make_reader(stream, decoder_factories=[decoder.DecoderFactory()])
        for schema, channel, message, content in opened.iter_decoded_messages():
            found.setdefault((channel.topic, schema.name), []).append((message.log_time, content))
    text = frontal_biped.simulation.mcap_log.__doc__
    assert {topic for topic, _ in found} == set(re.findall(r"``(/\w+(?:/\w+)?)``", text))
    assert all(kind in text for _, kind in found)
    joints = found["/joint_states", "sensor_msgs/msg/JointState"]
    assert len(joints) == len(motion.t) and tuple(joints[0][1].name) == motion.joint_names
    for kind, values in (("position", motion.angles), ("velocity", motion.v[:, 6:]), ("effort", motion.tau)):
        np.testing.assert_array_equal([getattr(content, kind) for _, content in joints], values)
    np.testing.assert_allclose([time for time, _ in joints], 1e9 * (motion.t - motion.t[0]), atol=1.0)
    twist = [content.twist.twist.angular.x for _, content in found["/odom", "nav_msgs/msg/Odometry"]]
    np.testing.assert_array_equal(twist, motion.v[:, 3])
    force = [content.wrench.force.z for _, content in found["/left_foot/wrench", "geometry_msgs/msg/WrenchStamped"]]
    np.testing.assert_allclose(force, motion.wrench[:, 0, 2], atol=1e-9)  # the foot is flat


def test_without_the_library_the_extra_is_named(biped, step, tmp_path, monkeypatch):
    import sys

    from frontal_biped.exceptions import MissingExtraError

    monkeypatch.setitem(sys.modules, "mcap_ros2.writer", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'frontal-biped\[mcap\]'"):
        write_mcap(whole_motion(biped, step, 20.0), tmp_path / "run.mcap")
    assert list(tmp_path.iterdir()) == []


def test_a_table_has_every_joint_and_with_virtual_legs_the_real_ones():
    """The roll joints of virtual legs are not the planar robot's, so there is no place that the gait wants them at."""
    text = frontal_biped.simulation.csv_table.__doc__
    assert all(words in text for words in ("position, held", "torque, held", "in contact", "desired position"))
    for name, wanted in (("g1_bent", False), ("romeo_bent", True)):
        robot = whole(name)
        run = orbit_trajectory(robot.biped, robot.gait, 1, samples=4)
        header, rows = run_table(robot.biped, run)
        table = dict(zip(header, zip(*rows, strict=True), strict=True))
        motion = whole_motion(robot.biped, run)
        for joint in motion.joint_names:
            kind = "position, held [rad]" if joint in motion.held else "position [rad]"
            np.testing.assert_array_equal(np.array(table[f"{joint} {kind}"], dtype=float), motion.positions[joint])
            kind = "torque, held [N m]" if joint in motion.held else "torque [N m]"
            np.testing.assert_array_equal(np.array(table[f"{joint} {kind}"], dtype=float), motion.torques[joint])
        assert any("desired position" in column for column in header) == wanted
        assert set(table["left sole contact [0/1]"]) == {"1"} and set(table["right sole contact [0/1]"]) == {"0"}
