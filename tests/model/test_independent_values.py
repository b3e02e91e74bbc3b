"""Every mechanical quantity against numbers from a separately written symbolic model."""

import numpy as np
import pytest
from random_states import assert_close

from frontal_biped.model import impact, relabel

INDEPENDENT_TOLERANCE = 1e-9
"""Relative to the largest entry; both sides carry about 1e-13 of rounding."""

TINY = 1e-3
"""Quantities are compared on their own scale down to this; some entries of the file are zero."""


@pytest.mark.parametrize("index", range(8))
class TestStates:
    @pytest.fixture
    def state(self, independent, robot_name, index):
        return {key: np.array(value) for key, value in independent[robot_name]["states"][index].items()}

    def test_mass_matrix(self, robot, state):
        assert_close(robot.D(state["q"]), state["D"], INDEPENDENT_TOLERANCE)

    def test_bias_is_coriolis_plus_gravity(self, robot, state):
        q, dq = state["q"], state["dq"]
        assert_close(robot.bias(q, dq), state["C_dq_plus_G"], INDEPENDENT_TOLERANCE)
        assert_close(robot.C(q, dq) @ dq + robot.G(q), state["C_dq_plus_G"], INDEPENDENT_TOLERANCE)

    def test_gravity(self, robot, state):
        assert_close(robot.G(state["q"]), state["G"], INDEPENDENT_TOLERANCE)

    def test_torques(self, robot, state):
        wrench = robot.inverse_dynamics(state["q"], state["dq"], state["ddq"])
        assert_close(wrench[3:], state["u"], INDEPENDENT_TOLERANCE)

    def test_forward_dynamics(self, robot, state):
        ddq = robot.forward_dynamics(state["q"], state["dq"], state["u"])
        assert_close(ddq, state["ddq"], INDEPENDENT_TOLERANCE)

    def test_ground_reaction(self, robot, state):
        force = robot.ground_reaction(state["q"], state["dq"], state["ddq"])
        assert_close(force, state["ground_reaction_hv"], INDEPENDENT_TOLERANCE)

    def test_centre_of_mass(self, robot, state):
        assert_close(robot.com(state["q"]), state["com_hv"], INDEPENDENT_TOLERANCE)

    def test_angular_momentum(self, robot, state):
        q, dq = state["q"], state["dq"]
        about_ankle = state["sigma_about_stance_ankle_ground_point"]
        assert_close(robot.sigma(q, dq), about_ankle, INDEPENDENT_TOLERANCE, TINY)
        assert_close(robot.sigma(q, dq, 0.03), state["sigma_about_p_0p03"], INDEPENDENT_TOLERANCE, TINY)

    def test_swing_sole(self, robot, state):
        ends = [state["swing_sole_inner_hv"], state["swing_sole_outer_hv"]]
        assert_close(robot.swing_sole(state["q"]), ends, INDEPENDENT_TOLERANCE)
        # of many states in one call: each of its own, and none left from the last
        heights = robot.swing_sole_heights(np.stack([state["q"], state["q"] + 0.1, state["q"]]))
        assert_close(heights[:, 0], np.array(ends)[:, 1], INDEPENDENT_TOLERANCE, TINY)
        assert_close(heights[:, 1], robot.swing_sole(state["q"] + 0.1)[:, 1], INDEPENDENT_TOLERANCE, TINY)
        assert np.array_equal(heights[:, 2], heights[:, 0])


@pytest.mark.parametrize("index", range(6))
def test_impact(robot, robot_name, independent, index):
    row = {key: np.array(value) for key, value in independent[robot_name]["impacts"][index].items()}
    landing = impact(robot, row["q_minus"], row["dq_minus"])
    assert np.array_equal(landing.q_plus, relabel(row["q_minus"]))
    assert_close(landing.dq_plus, row["dq_plus_relabelled"], INDEPENDENT_TOLERANCE)
    assert_close(landing.impulse, row["impulse_h_v_moment_at_sole_below_ankle"], INDEPENDENT_TOLERANCE)
    assert_close(landing.lift_off, row["old_stance_sole_vertical_velocity_inner_outer"], INDEPENDENT_TOLERANCE)


def test_parameters_of_the_packaged_robot(biped, independent):
    p = independent["table1"]["parameters"]
    assert biped.mass == pytest.approx(p["mt"] + 2.0 * (p["ml"] + p["mf"]), rel=INDEPENDENT_TOLERANCE)
    assert biped.weight == pytest.approx(p["g"] * biped.mass, rel=INDEPENDENT_TOLERANCE)
    assert biped.leg_length == pytest.approx(p["L"], rel=INDEPENDENT_TOLERANCE)
    assert biped.hip_width == pytest.approx(p["W"], rel=INDEPENDENT_TOLERANCE)
    assert biped.sole == (-p["e_out"], p["e_in"])


def test_inner_end_of_an_asymmetric_sole_points_to_the_other_foot(raised_ankle, independent):
    p = independent["raised_ankle"]["parameters"]
    upright = np.full(4, -0.5 * np.pi)
    ankles = raised_ankle.joint_positions(upright)
    inner, outer = raised_ankle.swing_sole(upright)
    assert_close(inner, ankles[3] + [-p["e_in"], -p["ha"]], INDEPENDENT_TOLERANCE)
    assert_close(outer, ankles[3] + [p["e_out"], -p["ha"]], INDEPENDENT_TOLERANCE)
    assert raised_ankle.sole == (-p["e_out"], p["e_in"])
