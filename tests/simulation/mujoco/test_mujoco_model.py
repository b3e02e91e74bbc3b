"""MuJoCo's model against Pinocchio's: two readings of one URDF by two engines."""

import builtins

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped import load_robot
from frontal_biped.exceptions import MissingExtraError
from frontal_biped.model.biped import BASE
from frontal_biped.model.perturbation import LINKS
from frontal_biped.simulation.mujoco.model import BASE_JOINTS, link_bodies, mujoco_model
from frontal_biped.simulation.mujoco.spec import import_mujoco

mujoco = pytest.importorskip("mujoco")

ROBOTS = ("frontal_biped", "talos_full", "romeo", "g1")
DYNAMICS = 1e-12
"""Relative difference of M and bias: two engines, a dozen operations on numbers of order one."""


def planar_dynamics(biped, roll, angles, v):
    """M (7, 7) and bias (7,) from the spatial Pinocchio model moved in the plane: y, z, roll, then the roll joints."""
    model, names = biped.spatial_model, biped.stance_map.joint_names
    data = model.createData()
    q = biped.spatial_reference.copy()
    rotation = pin.rpy.rpyToMatrix(roll, 0.0, 0.0) @ pin.Quaternion(q[3:7]).matrix()
    q[3:7] = pin.Quaternion(rotation).coeffs()
    S = np.zeros((model.nv, 7))  # generalized velocity of the free-flyer model = S v, the root's in its own frame
    S[:3, 0], S[:3, 1], S[3:6, 2] = rotation.T[:, 1], rotation.T[:, 2], rotation.T[:, 0]
    armature = np.zeros(7)
    for i, name in enumerate(names):
        joint = model.joints[model.getJointId(name)]
        q[joint.idx_q], S[joint.idx_v, 3 + i] = angles[i], 1.0
        armature[3 + i] = biped.chain.armature[i]
    model = model.copy()
    model.armature = np.zeros(model.nv)
    model.gravity.linear = np.array([0.0, 0.0, -9.81])
    spatial = S @ v
    turning = np.zeros(model.nv)  # no acceleration of the planar coordinates
    turning[:3] = -np.cross(spatial[3:6], spatial[:3])
    bias = S.T @ pin.rnea(model, data, q, spatial, turning)
    return S.T @ pin.crba(model, data, q) @ S + np.diag(armature), bias


@pytest.mark.parametrize("name", ROBOTS)
def test_mass_matrix_and_bias_are_those_of_pinocchio(name):
    biped = load_robot(name)
    model = mujoco_model(biped)
    data = mujoco.MjData(model)
    order = [model.joint(joint).dofadr[0] for joint in (*BASE_JOINTS, *biped.stance_map.joint_names)]
    generator = np.random.default_rng(3)
    for _ in range(20):
        x, v = generator.uniform(-0.3, 0.3, 7), generator.uniform(-2.0, 2.0, 7)
        angles = x[3:] + biped.stance_map.reference
        data.qpos[order], data.qvel[order] = [*x[:3], *angles], v
        mujoco.mj_forward(model, data)
        M = np.zeros((7, 7))
        mujoco.mj_fullM(model, data, M)
        M_pin, bias_pin = planar_dynamics(biped, x[2], angles, v)
        np.testing.assert_allclose(M[np.ix_(order, order)], M_pin, atol=DYNAMICS * np.max(np.abs(M_pin)))
        np.testing.assert_allclose(data.qfrc_bias[order], bias_pin, atol=DYNAMICS * np.max(np.abs(bias_pin)))


@pytest.mark.parametrize("name", ROBOTS)
def test_planar_model_with_equal_legs_differs_by_the_asymmetry(name):
    """The model that gaits are designed with, seen from its left stance foot, against MuJoCo's unequal legs."""
    biped = load_robot(name)
    model = mujoco_model(biped)
    data = mujoco.MjData(model)
    order = [model.joint(joint).dofadr[0] for joint in (*BASE_JOINTS, *biped.stance_map.joint_names)]
    generator = np.random.default_rng(4)
    q = -0.5 * np.pi + generator.uniform(-0.2, 0.2, 4)
    sign = biped.stance_map.velocities_to_urdf(np.ones(4), _left())
    # the stance foot at rest: the root follows from the stance leg; finite differences of positions, so 1e-7
    data.qpos[order] = [0.0, 0.0, 0.0, *biped.stance_map.positions_to_urdf(q, _left())]
    data.qpos[order[2]] = -biped.pelvis_roll(q)
    mujoco.mj_forward(model, data)
    M = np.zeros((7, 7))
    mujoco.mj_fullM(model, data, M)
    M = M[np.ix_(order, order)]
    J = np.zeros((6, 7))
    foot = link_bodies(biped, model)[LINKS[0]]
    mujoco.mj_jac(model, data, J[:3], J[3:], data.xpos[foot], foot)
    J = J[[1, 2, 3]][:, order]  # y, z and roll of the stance foot
    T = np.zeros((7, 4))
    T[3:] = np.diag(sign)
    T[:3] = -np.linalg.solve(J[:, :3], J[:, 3:] @ T[3:])
    D = T.T @ M @ T
    expected = biped.D(q)
    tolerance = max(biped.asymmetry.mass_matrix, DYNAMICS) * np.max(np.abs(expected))
    assert np.max(np.abs(D - expected)) <= 2.0 * tolerance  # the asymmetry is measured at the upright posture


def _left():
    from frontal_biped.model.stance_map import Stance

    return Stance.LEFT


@pytest.mark.parametrize("name", ROBOTS)
def test_soles_stand_on_the_floor_at_the_reference_posture(name):
    biped = load_robot(name)
    model = mujoco_model(biped)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for sole, side in (("left_sole", 1.0), ("right_sole", -1.0)):
        geom = model.geom(sole).id
        bottom = data.geom_xpos[geom] - data.geom_xmat[geom].reshape(3, 3)[:, 2] * model.geom_size[geom, 2]
        ankle = side * 0.5 * float(biped.joint_positions(np.full(4, -0.5 * np.pi))[3, 0])
        center = 0.5 * (biped.chain.sole_outer - biped.chain.sole_inner)
        assert bottom[2] == pytest.approx(0.0, abs=1e-12)
        # legs that the planar model averages differ in URDF by their rounding
        assert bottom[1] == pytest.approx(ankle + side * center, abs=1e-4)


def test_without_mujoco_one_line_names_the_extra(monkeypatch):
    real = builtins.__import__

    def absent(name, *args, **kwargs):
        if name == "mujoco":
            raise ImportError(name)
        return real(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", absent)
    with pytest.raises(MissingExtraError, match=r"frontal-biped\[mujoco\]"):
        import_mujoco()


def test_base_counts_the_freedoms_of_the_plane():
    assert len(BASE_JOINTS) == BASE
