"""The robot in space as nodes that turn: where they put a body is where Pinocchio has it."""

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped.model.catalogue import load_robot
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.studio.space_drawing import space_drawing_of

PLACED = 1e-9
"""Rotations composed one by one against Pinocchio's [m, -]."""


@pytest.mark.parametrize("name", ["g1_bent", pytest.param("romeo_bent", marks=pytest.mark.slow)])
def test_nodes_stand_where_the_bodies_are(name):
    biped = load_robot(name)
    free, drawing = FreeRobot(biped.robot), space_drawing_of(biped)
    model, data = free.model, free.model.createData()
    rng = np.random.default_rng(1)
    q = pin.integrate(model, free.posture, 0.3 * rng.normal(size=model.nv))
    pin.forwardKinematics(model, data, q)
    moved = {drawing.root: pin.XYZQUATToSE3(q[:7]).homogeneous}
    for turn in drawing.turns:
        value = float(q[turn.place])
        motion = (
            pin.Motion(value * turn.axis, np.zeros(3)) if turn.slides else pin.Motion(np.zeros(3), value * turn.axis)
        )
        moved[turn.node] = pin.exp6(motion).homogeneous

    def placed(node):
        parts, place = node.split("/"), np.eye(4)
        for count in range(1, len(parts) + 1):
            name = "/".join(parts[:count])
            place = place @ moved.get(name, drawing.placements.get(name, np.eye(4)))
        return place

    for joint, turn in zip(range(2, model.njoints), drawing.turns, strict=True):
        assert np.abs(placed(turn.node) - data.oMi[joint].homogeneous).max() < PLACED
    carried = {shape.node.rpartition("/")[0] for shape in drawing.shapes}
    assert drawing.root in {node[: len(drawing.root)] for node in carried}
    assert all(np.isfinite(shape.vertices).all() and len(shape.faces) for shape in drawing.shapes)


@pytest.mark.slow
def test_soles_are_about_the_feet():
    left, right = space_drawing_of(load_robot("g1_bent")).soles
    for corners in (left, right):
        assert corners.shape == (4, 2)
        assert corners.min(axis=0).max() < 0.0 < corners.max(axis=0).min()
