"""The walker by itself, on readings made from Pinocchio's model: no simulator of the package is near."""

import numpy as np
import pytest

from frontal_biped.analysis.return_map import RestrictedMap
from frontal_biped.control.interface import Reading
from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions
from frontal_biped.control.walker.walker import Walker
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.chain import UPRIGHT
from frontal_biped.model.stance_map import Stance
from frontal_biped.virtual_constraints import StepPhase

H = 1e-3  # [s]

HELD = 2e-3
"""Output error that torques held for 1 ms leave on the reference gait [rad]."""


class PinnedRobot:
    """The robot on a foot that stands, integrated finely under held joint torques; what its sensors read."""

    def __init__(self, biped, stance, q, dq, velocities=True):
        self.biped, self.stance, self.q, self.dq, self.velocities, self.t = biped, stance, q, dq, velocities, 0.0

    def reading(self, touches=False):
        coordinates, outwards = self.biped.stance_map, -1.0 if self.stance is Stance.LEFT else 1.0
        stance_left = self.stance is Stance.LEFT
        return Reading(
            time=self.t,
            joint_positions=coordinates.positions_to_urdf(self.q, self.stance),
            joint_velocities=coordinates.velocities_to_urdf(self.dq, self.stance) if self.velocities else None,
            base_roll=outwards * (self.q[0] + self.q[1] - 2.0 * UPRIGHT),
            base_roll_rate=outwards * (self.dq[0] + self.dq[1]),
            contact=(True, touches) if stance_left else (touches, True),
        )

    def advance(self, tau):
        u = self.biped.stance_map.torques_to_stance(tau, self.stance)
        for _ in range(10):
            middle = self.dq + 0.05 * H * self.biped.forward_dynamics(self.q, self.dq, u)
            half = self.q + 0.05 * H * self.dq
            self.q = self.q + 0.1 * H * middle
            self.dq = self.dq + 0.1 * H * self.biped.forward_dynamics(half, middle, u)
        self.t += H


def half_a_step(biped, gait, stance, velocities=True, delay=0):
    """Robot and commands from an impact to a hundredth of a second before the next."""
    q, dq = gait.state_after_impact()
    robot = PinnedRobot(biped, stance, q, dq, velocities)
    walker = Walker(biped, gait, delay=delay * H)
    walker.reset(stance, q, dq)
    commands, acting = [], []
    for _ in range(round(gait.orbit.step_duration / H) - 10):
        commands.append(walker.tick(robot.reading()))
        acting.append((robot.q, robot.dq))
        robot.advance(commands[max(0, len(commands) - 1 - delay)].joint_torques)
    return robot, commands, acting


@pytest.mark.parametrize("stance", list(Stance))
@pytest.mark.parametrize("velocities", [True, False], ids=["rates read", "rates estimated"])
def test_follows_the_orbit_of_the_closed_form(biped, reference_gait, stance, velocities):
    robot, commands, _ = half_a_step(biped, reference_gait, stance, velocities)
    reversals = [i for i, command in enumerate(commands) if command.event is not None]
    planned = reference_gait.step(biped).rising.duration
    assert len(reversals) == 1
    assert reversals[0] * H == pytest.approx(planned, abs=0.01)
    assert max(np.max(np.abs(command.y)) for command in commands) < HELD
    assert all(command.solved and command.stance is stance for command in commands)
    assert reference_gait.falling.beta_end < robot.q[0] < reference_gait.beta_reversal


def test_left_and_right_stance_are_mirror_images(biped, reference_gait):
    left, right = (half_a_step(biped, reference_gait, stance)[1] for stance in Stance)
    for a, b in zip(left, right, strict=True):
        assert b.joint_torques == pytest.approx(-a.joint_torques[::-1], abs=1e-6)


@pytest.mark.parametrize("delay", [1, 3])
def test_commands_are_for_the_state_at_which_they_act(biped, reference_gait, delay):
    """A known delay is predicted over with the torques on their way."""
    _, commands, acting = half_a_step(biped, reference_gait, Stance.LEFT, delay=delay)
    for command, (q, dq) in list(zip(commands, acting[delay:], strict=False))[20:]:
        assert command.q == pytest.approx(q, abs=2e-5)
        assert command.dq == pytest.approx(dq, abs=5e-3)


def test_landing_swaps_the_feet(biped, reference_gait):
    robot, _, _ = half_a_step(biped, reference_gait, Stance.LEFT)
    walker = Walker(biped, reference_gait)
    q, dq = reference_gait.state_after_impact()
    walker.reset(Stance.LEFT, q, dq)
    robot = PinnedRobot(biped, Stance.LEFT, q, dq)
    for _ in range(2000):
        lowest = float(biped.swing_sole(robot.q)[:, 1].min())
        command = walker.tick(robot.reading(touches=lowest <= 0.0))
        if command.stance is Stance.RIGHT:
            break
        robot.advance(command.joint_torques)
    assert walker.landings == 1
    assert robot.t == pytest.approx(reference_gait.orbit.step_duration, rel=0.05)
    assert command.phase is StepPhase.RISING
    assert command.q == pytest.approx(q, abs=0.02)


def test_early_reversals_ask_less_of_a_robot_than_rejoining_its_path(biped, reference_gait):
    """5 % too slow: I_P nearly vanishes where the path is rejoined; the walker rescales the falling phase instead."""
    speed = 0.95
    least = {}
    for rejoin in (True, False):
        transitions = ReanchoringTransitions(biped, reference_gait, anticipate=False, rejoin=rejoin)
        step = RestrictedMap(biped, reference_gait, transitions)
        least[rejoin] = step.step(step.start(speed)).tightest.value
    assert Walker(biped, reference_gait).controller.stabiliser.rejoin is False
    assert least[True] < 0.0 < least[False]


def test_what_cannot_be_followed_over_the_sway_is_refused(low_torso, biped, reference_gait):
    """The low torso sways inwards while it rises; a stabiliser chooses phases over the ankle."""
    assert Walker(biped, reference_gait).over == "sway"
    assert Walker(biped, reference_gait, stabiliser="fixed").over == "ankle"
    assert Walker(low_torso, reference_gait).over == "ankle"
    for robot, options, word in (
        (low_torso, {"over": "sway"}, "outwards"),
        (biped, {"over": "sway", "stabiliser": "fixed"}, "stabilisers"),
        (biped, {"over": "knee"}, "knee"),
    ):
        with pytest.raises(SimulationError, match=word):
            Walker(robot, reference_gait, **options)


@pytest.mark.filterwarnings("error")
def test_readings_beyond_all_numbers_leave_torques_as_they_were(biped, reference_gait):
    """A broken encoder may say anything; the answer is numbers within the limits, and no warning."""
    q, dq = reference_gait.state_after_impact()
    robot = PinnedRobot(biped, Stance.LEFT, q, dq)
    walker = Walker(biped, reference_gait)
    walker.reset(Stance.LEFT, q, dq)
    walker.tick(robot.reading())
    robot.q, robot.dq = q * 1e200, dq * 1e200
    for _ in range(3):
        command = walker.tick(robot.reading())
        assert not command.solved
        assert np.all(np.abs(command.joint_torques) <= np.max(biped.max_torque))
