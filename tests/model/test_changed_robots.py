"""A robot of another mass or posture: what changes, what does not, and what is refused; and a robot by any name."""

import pickle

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped.exceptions import HypothesisError, RobotError
from frontal_biped.model import FrontalBiped, Stance, load_robot
from frontal_biped.model.catalogue import biped_of, whole_of
from frontal_biped.model.perturbation import ModelErrors, perturbed
from frontal_biped.model.space.free_robot import FreeRobot


@pytest.fixture(scope="module")
def g1():
    return load_robot("g1")


def test_dynamics_of_another_total_mass_are_scaled_with_it(biped):
    """All forces are linear in the density: at the same motion every term is multiplied by the factor."""
    factor = 1.3
    heavy = biped.with_mass(factor * biped.mass)
    q, dq = np.array([-1.5, -1.6, -1.62, -1.5]), np.array([0.3, -0.2, 0.4, 0.1])
    assert heavy.mass == pytest.approx(factor * biped.mass, rel=1e-12)
    for change in (heavy.D(q) - factor * biped.D(q), heavy.bias(q, dq) - factor * biped.bias(q, dq)):
        assert np.abs(change).max() < 1e-9
    assert np.allclose(heavy.com(q), biped.com(q), atol=1e-12)
    assert heavy.fingerprint != biped.fingerprint
    assert np.array_equal(heavy.max_torque, biped.max_torque)


def test_one_link_of_another_mass_keeps_shape_and_place(g1):
    heavy = g1.with_mass({"torso_link": 20.0})
    name = "waist_pitch_joint"
    old, new = (robot.robot.model.inertias[robot.robot.model.getJointId(name)] for robot in (g1, heavy))
    added = 20.0 - 6.78
    assert heavy.mass - g1.mass == pytest.approx(added, abs=1e-9)
    assert new.mass - old.mass == pytest.approx(added, abs=1e-9)  # head and logo hang on the same joint, unchanged
    for other in g1.robot.joint_names:
        if other != name:
            joint = g1.robot.model.getJointId(other)
            assert heavy.robot.model.inertias[joint] == g1.robot.model.inertias[joint]


def test_the_change_travels_with_the_robot(g1):
    heavy = pickle.loads(pickle.dumps(g1.with_mass(50.0)))
    assert (heavy.mass, pin.computeTotalMass(FreeRobot(heavy.robot).model)) == pytest.approx((50.0, 50.0))
    assert g1.mass == pytest.approx(33.34, abs=0.01)  # the robot itself stays


def test_another_posture_is_the_description_changed(g1):
    raised = g1.with_posture({"left_shoulder_roll_joint": 1.0, "right_shoulder_roll_joint": -1.0})
    q = np.full(4, -0.5 * np.pi)
    assert raised.com(q)[1] > g1.com(q)[1] + 0.005  # arms out at the sides carry their mass higher
    assert raised.mass == pytest.approx(g1.mass)
    assert raised.fingerprint != g1.fingerprint
    assert raised.description.posture["left_shoulder_roll_joint"] == 1.0
    assert "left_shoulder_roll_joint" not in g1.description.posture


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        (lambda r: r.with_mass({"torso": 3.0}), RobotError, "no link 'torso'; did you mean 'torso_link'"),
        (lambda r: r.with_mass({"left_knee_link": 3.0}), HypothesisError, "HR3"),
        (lambda r: r.with_mass({"imu_in_torso": 1.0}), RobotError, "has no mass to scale"),
        (lambda r: r.with_mass({"torso_link": 0.0}), RobotError, "must be positive"),
        (lambda r: r.with_mass(-1.0), RobotError, "must be positive"),
        (lambda r: r.with_mass(float("nan")), RobotError, "not a finite number"),
        (lambda r: r.with_mass("heavy"), RobotError, "not a finite number"),
        (lambda r: r.with_posture({"left_kne": 0.1}), RobotError, "did you mean 'left_knee_joint'"),
        (lambda r: r.with_posture({"left_knee_joint": 9.0}), RobotError, "outside its limits"),
        (lambda r: r.with_posture({"left_knee_joint": 0.4}), HypothesisError, "HR2"),
        (lambda r: r.with_posture({"left_knee_joint": None}), RobotError, "not a finite number"),
        (
            lambda r: perturbed(r, ModelErrors(mass=np.full(5, 1.1)), Stance.LEFT).with_mass(30.0),
            RobotError,
            "errors of its own",
        ),
    ],
)
def test_what_makes_no_robot_is_refused_in_one_line(g1, change, error, words):
    with pytest.raises(error, match=words) as refused:
        change(g1)
    assert "\n" not in str(refused.value) and g1.name in str(refused.value)


def test_a_robot_is_taken_by_name_by_path_and_in_any_view(g1):
    for given in ("g1", g1.path, str(g1.path), g1, g1.robot, FreeRobot(g1.robot)):
        assert isinstance(biped_of(given), FrontalBiped)
        assert biped_of(given).fingerprint == whole_of(given).fingerprint == g1.fingerprint
    assert biped_of(g1) is g1
    for nothing in (None, 3, object()):
        with pytest.raises(RobotError, match="no robot; give one"):
            biped_of(nothing)
