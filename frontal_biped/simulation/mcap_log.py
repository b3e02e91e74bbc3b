"""A motion of the whole robot as an MCAP file of ROS 2 messages: ``frontal-biped export RUN.npz -o run.mcap``.

``ros2 bag play run.mcap`` plays it, Foxglove shows it; needs the extra ``mcap``. Time is the run's own, from its first
sample at 0 on. Topics, one message a sample unless said otherwise:

* ``/joint_states``, sensor_msgs/msg/JointState: position, velocity and effort of every joint under its URDF name
* ``/odom``, nav_msgs/msg/Odometry: pose of the root link in ``world``, and its velocity in its own axes
* ``/tf``, tf2_msgs/msg/TFMessage: from ``world`` to the root link, and to the frames ``frontal_biped/left_sole`` and
  ``frontal_biped/right_sole``, on the soles below the ankles, X forward, Y left, Z up when the robot stands upright
* ``/left_foot/wrench``, ``/right_foot/wrench``, geometry_msgs/msg/WrenchStamped: of the ground, in these frames
* ``/left_foot/contact``, ``/right_foot/contact``, std_msgs/msg/Bool: does the foot stand?
* ``/robot_description``, std_msgs/msg/String: the URDF, once
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.files.atomic import atomic_path
from frontal_biped.files.extras import missing_extra
from frontal_biped.model.space.whole_motion import FOOT_NAMES, WholeMotion
from frontal_biped.model.stance_map import Stance

WORLD = "world"

_PARTS = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec",
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w",
    "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation",
    "geometry_msgs/PoseWithCovariance": "geometry_msgs/Pose pose\nfloat64[36] covariance",
    "geometry_msgs/Twist": "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular",
    "geometry_msgs/TwistWithCovariance": "geometry_msgs/Twist twist\nfloat64[36] covariance",
    "geometry_msgs/Wrench": "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque",
    "geometry_msgs/Transform": "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation",
    "geometry_msgs/TransformStamped": (
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform"
    ),
}
"""Definitions of the messages that messages are made of."""

_MESSAGES = {
    "sensor_msgs/msg/JointState": (
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort"
    ),
    "nav_msgs/msg/Odometry": (
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
        "geometry_msgs/TwistWithCovariance twist"
    ),
    "tf2_msgs/msg/TFMessage": "geometry_msgs/TransformStamped[] transforms",
    "geometry_msgs/msg/WrenchStamped": "std_msgs/Header header\ngeometry_msgs/Wrench wrench",
    "std_msgs/msg/Bool": "bool data",
    "std_msgs/msg/String": "string data",
}


def write_mcap(motion: WholeMotion, path: Path) -> None:
    """Write a motion as an MCAP file; it appears whole or not at all.

    Raises:
        MissingExtraError: the extra ``mcap`` is not installed.
    """
    try:
        from mcap_ros2.writer import Writer
    except ImportError:
        raise missing_extra("MCAP files need mcap-ros2-support", "mcap") from None

    with atomic_path(path) as temporary, temporary.open("wb") as stream:
        writer = Writer(stream)
        schemas = {name: writer.register_msgdef(name, _definition(text)) for name, text in _MESSAGES.items()}
        for nanoseconds, topic, kind, message in _messages(motion):
            writer.write_message(topic, schemas[kind], message, log_time=nanoseconds)
        writer.finish()


def _definition(text: str) -> str:
    """Definition of a message, followed by those of all its parts."""
    needed: dict[str, str] = {}
    to_see = [text]
    while to_see:
        for line in to_see.pop().splitlines():
            part = line.split()[0].removesuffix("[]")
            if part in _PARTS and part not in needed:
                needed[part] = _PARTS[part]
                to_see.append(_PARTS[part])
    return "\n".join([text, *(f"{'=' * 80}\nMSG: {name}\n{part}" for name, part in needed.items())])


def _messages(motion: WholeMotion) -> Iterator[tuple[int, str, str, dict[str, Any]]]:
    """Time [ns], topic, type and content of every message."""
    robot, names = motion.robot, list(motion.joint_names)
    model, data = robot.model, robot.model.createData()
    soles = [
        (f"frontal_biped/{side.value}_sole", model.getJointId(robot.description.joints[f"{side.value}_ankle"]),
         robot.sole_placement(side))
        for side in Stance
    ]  # fmt: skip
    yield 0, "/robot_description", "std_msgs/msg/String", {"data": robot.urdf_text}
    uncertain = [0.0] * 36
    for k, nanoseconds in enumerate(np.round(1e9 * (motion.t - motion.t[0])).astype(np.int64).tolist()):
        stamp = {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9}
        in_world = {"stamp": stamp, "frame_id": WORLD}
        yield nanoseconds, "/joint_states", "sensor_msgs/msg/JointState", {
            "header": {"stamp": stamp, "frame_id": ""},
            "name": names,
            "position": motion.angles[k].tolist(),
            "velocity": motion.rates[k].tolist(),
            "effort": motion.efforts[k].tolist(),
        }  # fmt: skip
        place, turn = _vector(motion.q[k, :3]), _quaternion(motion.q[k, 3:7])
        twist = {"linear": _vector(motion.v[k, :3]), "angular": _vector(motion.v[k, 3:6])}
        yield nanoseconds, "/odom", "nav_msgs/msg/Odometry", {
            "header": in_world,
            "child_frame_id": motion.root_link,
            "pose": {"pose": {"position": place, "orientation": turn}, "covariance": uncertain},
            "twist": {"twist": twist, "covariance": uncertain},
        }  # fmt: skip
        pin.forwardKinematics(model, data, motion.q[k])
        frames = [(motion.root_link, place, turn)]
        for foot, (name, (frame, joint, placement)) in enumerate(zip(FOOT_NAMES, soles, strict=True)):
            sole = data.oMi[joint] * placement
            frames.append((frame, _vector(sole.translation), _quaternion(pin.Quaternion(sole.rotation).coeffs())))
            force, moment = motion.wrench[k, foot].reshape(2, 3) @ sole.rotation
            yield nanoseconds, f"/{name}_foot/wrench", "geometry_msgs/msg/WrenchStamped", {
                "header": {"stamp": stamp, "frame_id": frame},
                "wrench": {"force": _vector(force), "torque": _vector(moment)},
            }  # fmt: skip
            stands = {"data": bool(motion.contact[k, foot])}
            yield nanoseconds, f"/{name}_foot/contact", "std_msgs/msg/Bool", stands
        yield nanoseconds, "/tf", "tf2_msgs/msg/TFMessage", {
            "transforms": [
                {"header": in_world, "child_frame_id": frame, "transform": {"translation": place, "rotation": turn}}
                for frame, place, turn in frames
            ]
        }  # fmt: skip


def _vector(values: FloatArray | Sequence[float]) -> dict[str, float]:
    return dict(zip("xyz", map(float, values), strict=True))


def _quaternion(values: FloatArray | Sequence[float]) -> dict[str, float]:
    return dict(zip("xyzw", map(float, values), strict=True))
