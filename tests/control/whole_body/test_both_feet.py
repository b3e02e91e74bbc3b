"""Standing on both feet: the torques do what they say, by inverse dynamics of the free robot; limits are kept."""

import numpy as np
import pinocchio as pin
import pytest
from whole_robots import whole

from frontal_biped.control.whole_body.both_feet import ACCURACY, BothFeetProgram, BothFeetTargets
from frontal_biped.control.whole_body.limits import contact_rows
from frontal_biped.control.whole_body.nearest import ACCELERATION
from frontal_biped.control.whole_body.settings import WholeBodySettings
from frontal_biped.control.whole_body.targets import Yaw
from frontal_biped.control.whole_body.tasks import TaskRows
from frontal_biped.model import Stance
from frontal_biped.model.space.free_robot import BASE
from frontal_biped.model.space.virtual_legs import LENGTH, PITCH, YAW, SpaceState
from frontal_biped.simulation.space.start import standing_in_space

FEET = ACCURACY * ACCELERATION
"""Of ProxQP, where a limit is active: the rows of the feet are in units of `ACCELERATION` [m/s^2, rad/s^2]."""

LINEAR = 1e-7
"""Of the solution of a linear system of a hundred unknowns [rad/s^2, of the weight]."""

GIVEN = 1e-3
"""What targets of the motion give for the wrenches to be shared, of 1 m/s^2: `WORTH_OF_WRENCHES` says a ten thousandth
of a tenth for each centimetre that the centre of pressure is from the middle [m/s^2]."""

SETTINGS = WholeBodySettings()


class Stand:
    """A robot on both feet, at rest."""

    def __init__(self, name):
        self.robot = whole(name)
        self.free = self.robot.free
        self.state = SpaceState(self.free)
        self.state.at(*standing_in_space(self.free, self.robot.biped, self.robot.gait))
        self.program = BothFeetProgram(self.free, SETTINGS, TaskRows(self.free, SETTINGS).outside)

    def solve(self, ddc=(0.0, 0.0), share=0.5, **others):
        return self.program.solve(self.state, BothFeetTargets(np.array(ddc), share, self.robot.joints, **others))

    def wrenches(self, solution):
        return {Stance.LEFT: solution.wrench, Stance.RIGHT: solution.other_wrench}


@pytest.fixture(scope="module", params=["talos_full", "g1_bent", "simple_humanoid_bent"])
def stand(request):
    return Stand(request.param)


ASKED = [((0.0, 0.0), 0.5), ((0.1, 0.2), 0.5), ((0.0, -0.3), 0.4), ((-0.1, 0.1), 0.6)]


@pytest.mark.parametrize(("ddc", "share"), ASKED)
def test_what_is_asked_for_is_what_the_torques_do(stand, ddc, share):
    """By inverse dynamics: torques and both wrenches balance the accelerations; the feet stay, the mass goes."""
    solution = stand.solve(ddc, share)
    free, state = stand.free, stand.state
    model, data = free.model, free.model.createData()
    tau = pin.rnea(model, data, state.q, state.v, solution.dv)
    for side, wrench in stand.wrenches(solution).items():
        tau -= state.feet[side].J.T @ wrench
    tau[BASE:] -= solution.tau
    assert np.abs(tau).max() < LINEAR * free.weight
    for side in Stance:
        assert np.abs(state.feet[side].J @ solution.dv + state.feet[side].drift).max() < FEET
    J, drift = state.com_rows
    assert (J @ solution.dv + drift)[:2] == pytest.approx(ddc, abs=GIVEN)
    for side in Stance:
        assert state.legs[side].J[LENGTH] @ solution.dv == pytest.approx(0.0, abs=GIVEN)
    assert state.pelvis.J[PITCH:] @ solution.dv == pytest.approx((0.0, 0.0), abs=GIVEN)


def test_the_jacobian_of_the_centre_of_mass_is_pinocchios(stand):
    free, state = stand.free, stand.state
    J, _ = state.com_rows
    assert np.abs(J - pin.jacobianCenterOfMass(free.model, free.model.createData(), state.q)).max() < LINEAR


def test_at_rest_both_carry_the_weight(stand):
    solution = stand.solve()
    total = solution.wrench + solution.other_wrench
    assert total[:3] == pytest.approx((0.0, 0.0, stand.free.weight), abs=1e-3 * stand.free.weight)
    assert solution.wrench[2] == pytest.approx(solution.other_wrench[2], rel=0.02)


@pytest.mark.parametrize("ddc", [(0.0, 0.0), (0.5, 1.0), (-0.5, -1.0), (3.0, 0.0), (0.0, 6.0)])
def test_what_soles_and_motors_can_do_is_kept(stand, ddc):
    """What cannot be had gives way: soles and torques do not."""
    solution = stand.solve(ddc)
    assert np.all(np.abs(solution.tau) <= stand.free.limits.effort)
    for side, wrench in stand.wrenches(solution).items():
        rows = contact_rows(stand.free, side, SETTINGS) @ wrench
        assert rows.min() > -1e-4 * stand.free.weight


def test_the_whole_load_on_one_foot(stand):
    """The centre of mass thrown away from a foot that carries everything: the other one carries nothing."""
    state = stand.state
    over = state.com[1] - state.feet[Stance.LEFT].position[1]
    solution = stand.solve((0.0, 0.9 * 9.81 / state.com[2] * over), share=1.0)
    assert solution.other_wrench[2] < 0.12 * stand.free.weight


def test_the_pelvis_turns_as_it_is_led(stand):
    solution = stand.solve(pelvis_yaw=Yaw(0.0, 0.0, 0.5))
    state = stand.state
    assert state.pelvis.J[YAW] @ solution.dv == pytest.approx(0.5, abs=0.01)
