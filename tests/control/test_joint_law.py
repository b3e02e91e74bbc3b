"""A controller that is a function of (t, q, v): what it is shown, what it may return, and what is said of the rest."""

import numpy as np
import pytest

from frontal_biped.control.joint_law import AskedLaw, checked_torques, is_joint_law
from frontal_biped.exceptions import ControllerError

NAMES = ("left_hip", "right_hip")


def law(t, q, v):
    return {name: t + 10.0 * q[name] + 100.0 * v[name] for name in q}


def test_a_law_sees_time_positions_and_velocities_by_name():
    tau = AskedLaw(law, NAMES, 0.01).torques(0.5, np.array([0.1, 0.2]), np.array([1.0, -1.0]))
    np.testing.assert_allclose(tau, [101.5, -97.5])


def test_rates_that_sensors_do_not_tell_are_differences_of_readings():
    asked = AskedLaw(lambda t, q, v: v, NAMES, 0.01)
    assert not asked.torques(0.0, np.array([0.1, 0.2]), None).any()
    np.testing.assert_allclose(asked.torques(0.01, np.array([0.11, 0.18]), None), [1.0, -2.0])
    asked.reset()
    assert not asked.torques(0.0, np.array([0.3, 0.2]), None).any()


@pytest.mark.parametrize(
    "answer", [{"right_hip": 2, "left_hip": 1.0}, [1.0, 2.0], (1, np.float32(2.0)), np.array([1.0, 2.0])]
)
def test_names_or_an_array_in_their_order_are_taken(answer):
    np.testing.assert_array_equal(checked_torques(answer, NAMES, "it"), [1.0, 2.0])


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (None, "returned NoneType; return a dict of torques"),
        (3.0, "returned float; return a dict of torques"),
        ("12", "returned str; return a dict of torques"),
        ({"left_hip": 1.0}, "no torque of 'right_hip'; return a dict of torques"),
        ({"left_hip": 1.0, "right_hip": 1.0, "left_hop": 1.0}, "'left_hop', which is no joint here; did you mean"),
        ({"left_hip": 1.0, "right_hip": float("nan")}, "nan as the torque of 'right_hip'; return a finite number"),
        ({"left_hip": "1", "right_hip": 1.0}, "'1' as the torque of 'left_hip'; return a finite number"),
        ({"left_hip": None, "right_hip": 1.0}, "None as the torque of 'left_hip'"),
        ({"left_hip": 1j, "right_hip": 1.0}, "1j as the torque of 'left_hip'"),
        ([1.0, 2.0, 3.0], r"array of shape \(3,\), not \(2,\)"),
        (np.zeros((2, 1)), r"array of shape \(2, 1\), not \(2,\)"),
        (np.array([np.inf, 0.0]), "inf as the torque of 'left_hip'"),
        (np.array(["a", "b"]), "'a' as the torque of 'left_hip'"),
        (np.array([[1.0, 2.0], None], dtype=object), r"\[1.0, 2.0\] as the torque of 'left_hip'"),
    ],
)
def test_what_is_no_torque_of_each_joint_is_refused_in_one_line(answer, words):
    asked = AskedLaw(lambda t, q, v: answer, NAMES, 0.01)
    with pytest.raises(ControllerError, match=f"the controller '<lambda>' at t = 0.2500 s .*{words}") as error:
        asked.torques(0.25, np.zeros(2), np.zeros(2))
    assert "\n" not in str(error.value)


def test_a_law_that_fails_is_named_with_its_reason():
    with pytest.raises(ControllerError, match=r"'law' at t = 0\.0000 s fails, KeyError: 'left_knee'; mend it"):

        def law(t, q, v):
            return {"left_knee": q["left_knee"]}

        AskedLaw(law, NAMES, 0.01).torques(0.0, np.zeros(2), np.zeros(2))


def test_a_law_is_told_from_a_factory_and_from_a_controller():
    class Law:
        def __call__(self, t, q, v):
            return q

    class Ticks:
        def tick(self, reading): ...
        def reset(self, stance, q, dq): ...

    assert is_joint_law(law) and is_joint_law(Law()) and is_joint_law(lambda t, q, v: q)
    for other in (
        Law,
        Ticks(),
        lambda biped, gait, period: None,
        lambda free, biped, gait, period=1e-3: None,
        lambda free, biped, gait, **rest: None,
        lambda t, q: q,
        3.0,
    ):
        assert not is_joint_law(other)
