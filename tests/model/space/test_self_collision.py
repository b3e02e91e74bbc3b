"""Distances between the links of a free robot."""

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped import load_robot
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.space.self_collision import SelfDistances
from frontal_biped.model.urdf.shapes import build_shapes

ROUNDING = 1e-6
"""Of a distance between hulls [m]: GJK's default tolerance."""


@pytest.fixture(scope="module")
def talos():
    free = FreeRobot(load_robot("talos_full").robot)
    return free, SelfDistances(free)


def bent(free, **joints):
    q = free.posture.copy()
    for name, angle in joints.items():
        q[7 + free.joint_names.index(name)] += angle
    return q


def test_nothing_touches_at_the_posture(talos):
    free, distances = talos
    assert distances.touching(free.posture) == ()
    assert distances.shapes == "collision shapes and soles"


def test_legs_that_cross_touch(talos):
    free, distances = talos
    crossed = bent(free, leg_left_2_joint=-0.4, leg_right_2_joint=0.4)
    assert ("leg_left_4_link", "leg_right_4_link") in distances.touching(crossed)
    closest = distances.between_legs(crossed)
    assert closest.distance < 0.0
    assert closest.links[0].startswith("leg_left")
    assert closest.links[1].startswith("leg_right")


def test_an_arm_in_the_hip_touches(talos):
    free, distances = talos
    found = distances.touching(bent(free, arm_left_2_joint=-0.6))
    assert any("arm_left" in a + b and "arm_right" not in a + b for a, b in found)


def test_two_boxes_have_the_distance_of_their_edges():
    """Without shapes only the soles are left: turned about X where they stand, their inner lower edges come nearer."""
    free = FreeRobot(load_robot("frontal_biped").robot)
    distances = SelfDistances(free)
    data = free.model.createData()
    for angle in (0.0, 0.2):
        q = bent(free, left_ankle=angle, right_ankle=-angle)
        pin.framesForwardKinematics(free.model, data, q)
        corners = [
            np.array([data.oMf[frame].act(corner) for corner in sole.corners])
            for frame, sole in zip(free.sole_frames, free.soles, strict=True)
        ]
        top = [
            np.array([data.oMf[frame].act(corner + np.array([0.0, 0.0, 0.02])) for corner in sole.corners])
            for frame, sole in zip(free.sole_frames, free.soles, strict=True)
        ]
        left = min(corners[0][:, 1].min(), top[0][:, 1].min())
        right = max(corners[1][:, 1].max(), top[1][:, 1].max())
        assert distances.between_legs(q).distance <= left - right + ROUNDING
    assert distances.between_legs(free.posture).distance == pytest.approx(0.1, abs=ROUNDING)


def test_hulls_are_never_farther_than_the_meshes(talos):
    """Against the meshes themselves, in random postures of the legs."""
    free, distances = talos
    model = free.model
    meshes = build_shapes(model, free.robot.description.urdf, free.robot.urdf_text, pin.GeometryType.COLLISION)
    sides = [
        [i for i, shape in enumerate(meshes.geometryObjects) if shape.name.startswith(f"leg_{side}")]
        for side in ("left", "right")
    ]
    for i in sides[0]:
        for j in sides[1]:
            meshes.addCollisionPair(pin.CollisionPair(i, j))
    work, data, generator = meshes.createData(), model.createData(), np.random.default_rng(0)
    for _ in range(20):
        spread = generator.uniform(0.0, 0.4, 2)
        q = bent(free, leg_left_2_joint=spread[0], leg_right_2_joint=-spread[1], leg_left_3_joint=spread[1])
        pin.computeDistances(model, data, meshes, work, q)
        exact = min(result.min_distance for result in work.distanceResults)
        assert distances.between_legs(q).distance <= exact + ROUNDING
        assert distances.between_legs(q).distance > exact - 0.02  # and the hulls are not much larger
