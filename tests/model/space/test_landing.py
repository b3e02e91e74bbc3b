"""Landing with every joint free: the laws of a rigid impact, and the planar impact as its limit."""

from typing import NamedTuple

import numpy as np
import pytest
from robot_laws import tolerance

from frontal_biped.gait.file import load_gait
from frontal_biped.model import FrontalBiped, Stance, impact, load_robot, models_dir
from frontal_biped.model.impact import Landing
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.landing import SpatialLanding, land
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.state import State
from frontal_biped.simulation.space.start import start_in_space

ROLLING = ("alexander", "g1", "human", "icub", "romeo", "simple_humanoid_classical", "talos_full")
"""Whose roll joints are the planar robot's."""

VIRTUAL = ("g1_bent",)
"""Whose virtual legs are."""

SAME = 1e-9
"""Relative: both landings are solved for by different algorithms; one solve loses the condition of a light foot."""


class Case(NamedTuple):
    """The end of a gait's falling phase in space.

    Attributes:
        robot: the robot.
        space: its state before the landing.
        side: the landing foot.
        rolls: (n,) which joints are roll joints.
        planar: the planar impact of the legs as they are, not averaged.
    """

    robot: FrontalBiped
    space: SpaceState
    side: Stance
    rolls: np.ndarray
    planar: Landing

    def with_rotors(self, of_others: float) -> SpatialLanding:
        """Land with other rotors on the joints that the plane holds."""
        return land(self.space, self.side, np.where(self.rolls, self.space.free.armature, of_others))


def case_of(name: str, stance: Stance) -> Case:
    robot = load_robot(name)
    falling = load_gait(models_dir() / f"{name}.gait.json").step(robot).falling
    state = State(falling.motion.q[-1], falling.motion.dq[-1] * falling.dbeta[-1])
    free = FreeRobot(robot.robot)
    space = SpaceState(free)
    space.at(*start_in_space(free, robot, state, stance, space))
    rolls = np.isin(free.joint_names, list(robot.description.joints.values()))
    chain = robot.measured.chain(robot.description.sole, stance)
    own = FrontalBiped(robot.robot, robot.reduction._replace(chain=chain))
    return Case(robot, space, stance.other, rolls, impact(own, *state))


@pytest.fixture(scope="module", params=[(name, stance) for name in ROLLING for stance in Stance], ids=str)
def rolling(request) -> Case:
    return case_of(*request.param)


@pytest.fixture(scope="module", params=[(name, stance) for name in (*ROLLING, *VIRTUAL) for stance in Stance], ids=str)
def case(request) -> Case:
    return case_of(*request.param)


def test_held_joints_make_it_the_planar_impact(rolling):
    """The limit is taken exactly: no other joint can move."""
    landed = rolling.with_rotors(np.inf)
    assert not np.any((landed.v_plus - rolling.space.v)[BASE:][~rolling.rolls])
    within, planar, sign = max(SAME, 10.0 * tolerance(rolling.robot)), rolling.planar, rolling.side.sign
    dq = SpaceState(rolling.space.free).at(rolling.space.q, landed.v_plus).frontal(rolling.side).dq
    np.testing.assert_allclose(dq, planar.dq_plus, atol=within * np.max(np.abs(planar.dq_plus)))
    # in the (h, v) frame of the old stance foot
    _, F_y, F_z, M_x, _, _ = landed.impulse
    np.testing.assert_allclose([sign * F_y, F_z, sign * M_x], planar.impulse, atol=within * planar.impulse[1])


def test_large_rotors_tend_to_it(rolling):
    """From the soft side, and of first order in 1/rotor inertia."""
    soft = [rolling.with_rotors(rotors).impulse[2] for rotors in (1e5, 1e6, 1e7)]
    missing = rolling.with_rotors(np.inf).impulse[2] - np.array(soft)
    assert missing[0] > 0.0
    np.testing.assert_allclose(missing[:-1] / missing[1:], 10.0, rtol=1e-2)


def test_the_foot_sticks_and_momenta_balance(case):
    landed, space = land(case.space, case.side), case.space
    J, jump = space.feet[case.side].J, landed.v_plus - space.v
    np.testing.assert_allclose(J @ landed.v_plus, 0.0, atol=1e-9 * np.max(np.abs(space.v)))
    np.testing.assert_allclose(space.M @ jump, J.T @ landed.impulse, atol=1e-7 * landed.impulse[2])


def test_no_energy_is_made(case):
    """What is lost is the energy of the jump: of all motions that stick it is the nearest."""
    landed, space = land(case.space, case.side), case.space
    jump = landed.v_plus - space.v
    assert landed.energy_before == pytest.approx(0.5 * space.v @ space.M @ space.v, rel=1e-12)
    assert landed.energy_before - landed.energy_after == pytest.approx(0.5 * jump @ space.M @ jump, rel=1e-6)


def test_base_knows_no_rotor(case):
    """By virtual motions of the base alone: all that the robot's momentum changes by is what the ground gives."""
    for rotors in (0.0, 0.3):
        landed = case.with_rotors(rotors)
        change = (case.space.M @ (landed.v_plus - case.space.v))[:BASE]
        given = case.space.feet[case.side].J[:, :BASE].T @ landed.impulse
        np.testing.assert_allclose(change, given, atol=1e-7 * case.robot.mass)


def test_where_and_how_it_acts(rolling):
    """The place and the friction of the planar impulse are those of the held robot's."""
    landed, planar = rolling.with_rotors(np.inf), rolling.planar
    within = max(SAME, 100.0 * tolerance(rolling.robot))
    assert landed.cop[1] == pytest.approx(rolling.side.sign * planar.center_of_pressure, abs=within)
    assert landed.friction_used == pytest.approx(planar.friction_used, abs=within)
    pulled = landed._replace(impulse=-landed.impulse)
    assert pulled.friction_used == float("inf")
