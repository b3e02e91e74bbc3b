"""The page of a robot without a run: the whole robot at its posture, and a slider for every joint.

The browser's scene does the forward kinematics (`space_robot`), so the page is the same live and from a file.
"""

from typing import Any

import numpy as np

from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.viewer.page import recording, scene_page
from frontal_biped.viewer.scene import FIRST, ROBOT, draw_room
from frontal_biped.viewer.space_robot import body_drivers, draw_free_robot, node_paths
from frontal_biped.viewer.space_scene import space_camera

WIDEST = np.pi
"""Range of a slider whose joint has no limit [rad or m]."""


def joints_page(robot: FreeRobot) -> str:
    """The text of the page, which needs no network and opens from a file.

    Args:
        robot: the robot.
    """
    recorder, visualizer = recording()
    draw_room(visualizer)
    visualizer["/Grid"].set_property("visible", True)
    node = visualizer[FIRST][ROBOT]
    draw_free_robot(node, robot)
    root = robot.model.joints[1]
    placed = root.createData()
    root.calc(placed, robot.posture)
    node[node_paths(robot.model)[1]].set_transform(np.asarray(placed.M.homogeneous, dtype=float))
    scripts, styles = ("motion", "room", "joints"), ("viewer", "joints")
    return scene_page(
        "joints", robot.name, recorder.packed(), joints_data(robot), scripts, styles, schemes="light dark"
    )


def joints_data(robot: FreeRobot) -> dict[str, Any]:
    """What the page reads.

    ``text`` is what it says of the robot, ``camera`` where the camera stands, ``joints`` one table a slider: ``name``
    of the joint, ``part`` it plays in the plane or "", ``node`` that ``how`` moves along or about ``axis``, ``lower``,
    ``upper`` and ``value`` at the posture in ``unit``.
    """
    parts = {name: key.replace("_", " ") for key, name in robot.robot.description.joints.items()}
    limits = robot.limits
    joints = []
    for i, driver in enumerate(body_drivers(robot)[1:]):
        name, value = robot.joint_names[i], float(robot.posture[BASE + 1 + i])
        lower, upper = (
            float(bound) if np.isfinite(bound) else sign * WIDEST
            for sign, bound in ((-1.0, limits.lower[i]), (1.0, limits.upper[i]))
        )
        joints.append(
            {
                "name": name,
                "part": parts.get(name, ""),
                "node": ["meshcat", FIRST, ROBOT, *driver["node"]],
                "how": driver["how"],
                "axis": driver["axis"],
                "lower": min(lower, value),
                "upper": max(upper, value),
                "value": value,
                "unit": "rad" if driver["how"] == "turn" else "m",
            }
        )
    text = f"{robot.mass:.1f} kg, {len(joints)} joints; those that roll in the plane are named with their part"
    return {"text": text, "camera": space_camera(robot), "joints": joints}
