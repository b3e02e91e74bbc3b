"""The walker of the robot in space by itself: a rigid foot on the ground, made from Pinocchio's model; no simulator."""

import numpy as np
import pinocchio as pin
import pytest
from whole_robots import whole

from frontal_biped.control.interface import PhaseEvent
from frontal_biped.control.spatial_walker.interface import SpatialReading
from frontal_biped.control.spatial_walker.walker import SOFT, SpatialWalker
from frontal_biped.exceptions import SimulationError
from frontal_biped.model import Stance
from frontal_biped.model.space.free_robot import BASE
from frontal_biped.model.space.landing import land
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.simulation.space.start import start_in_space
from frontal_biped.virtual_constraints.phase import StepPhase

H = 1e-3  # [s]

OUTPUT = 0.02
"""Largest output error of the step after a rigid landing with every joint free [rad]: of the planar one it is none."""

STEP = 0.05
"""Of the duration of a step, from the orbit's: after the first, landings are not those of the plane."""


class RigidFoot:
    """The free robot, its stance foot at rest on the ground, under held torques; lands where the swing foot does."""

    def __init__(self, robot, stance=Stance.LEFT):
        self.free, self.stance, self.t = robot.free, stance, 0.0
        self.space = SpaceState(robot.free)
        start = start_in_space(robot.free, robot.biped, robot.gait.state_after_impact(), stance)
        self.q, self.v, self.landings, self.lifted = start.q, start.v, 0, False
        self.clearance = 0.0

    def reading(self):
        R = pin.Quaternion(self.q[6], self.q[3], self.q[4], self.q[5]).matrix()
        swing = self.clearance <= 0.0 and self.lifted
        contact = (True, swing) if self.stance is Stance.LEFT else (swing, True)
        return SpatialReading(self.t, self.q[BASE + 1 :], self.v[BASE:], R, self.v[3:BASE], contact)

    def land(self):
        self.v = land(self.space.at(self.q, self.v), self.stance.other).v_plus
        self.stance, self.lifted = self.stance.other, False
        self.landings += 1

    def advance(self, tau):
        """A period; the foot is drawn back to rest at 100 1/s where rounding moves it."""
        at = self.space.at(self.q, self.v)
        foot, nv = at.feet[self.stance], len(self.v)
        K = np.block([[at.M, -foot.J.T], [foot.J, np.zeros((BASE, BASE))]])
        applied = np.concatenate([np.zeros(BASE), tau]) - at.bias
        dv = np.linalg.solve(K, np.concatenate([applied, -foot.drift - 100.0 * foot.velocity]))[:nv]
        self.q = pin.integrate(self.free.model, self.q, H * (self.v + 0.5 * H * dv))
        self.v = self.v + H * dv
        self.t += H
        self.clearance = self.space.at(self.q, self.v).clearance(self.stance.other)
        self.lifted |= self.clearance > 0.002


def walk(robot, walker, steps, on_landing=lambda number: None, most=1.5):
    """Commands of a walk of so many steps."""
    plant = RigidFoot(robot)
    walker.reset(plant.stance, plant.q, plant.v)
    commands = []
    while plant.landings < steps:
        assert plant.t < most * steps * walker.sagittal.duration, "it does not land"
        if plant.lifted and plant.clearance <= 0.0 and commands[-1].phase is StepPhase.FALLING:
            plant.land()
            on_landing(plant.landings)
            touched = plant.reading()
            contact = (True, True)
            reading = SpatialReading(
                touched.time, touched.joint_positions, touched.joint_velocities, touched.base_rotation,
                touched.base_angular_velocity, contact,
            )  # fmt: skip
        else:
            reading = plant.reading()
        commands.append(walker.tick(reading))
        assert commands[-1].stance is plant.stance
        plant.advance(commands[-1].joint_torques)
    return plant, commands


@pytest.fixture(scope="module")
def talos():
    return whole("talos_full")


def walker_of(robot, **settings):
    return SpatialWalker(robot.free, robot.biped, robot.gait, period=H, **settings)


# ---------------------------------------------------------------------- walking
@pytest.fixture(scope="module")
def on_the_spot(talos):
    walker = walker_of(talos)
    return walker, *walk(talos, walker, steps=2)


def test_steps_on_the_spot(talos, on_the_spot):
    """Rising, reversal, falling, landing; in the gait's own time, outputs small, every limit kept."""
    walker, plant, commands = on_the_spot
    events = [command.event for command in commands if command.event is not None]
    assert events == [PhaseEvent.REVERSAL, PhaseEvent.LANDING, PhaseEvent.REVERSAL, PhaseEvent.LANDING]
    assert all(command.solved for command in commands)
    assert plant.t == pytest.approx(2.0 * walker.sagittal.duration, rel=STEP)
    assert max(np.abs(command.y).max() for command in commands) < OUTPUT
    assert abs(plant.space.com[0]) < 0.03
    assert walker.counters()["landings"] == 2
    assert walker.counters()["held"] == walker.counters()["early_landings"] == 0


def test_what_is_commanded_is_inside_its_limits(talos, on_the_spot):
    walker, _, commands = on_the_spot
    outer, inner = talos.biped.sole
    effort = talos.free.limits.effort
    for command in commands:
        assert np.all(np.abs(command.joint_torques) <= effort)
        assert outer < command.p_fri_target < inner
        assert walker.sagittal.reach[0] <= command.cop_target_x <= walker.sagittal.reach[1]
        assert command.wrench[2] > 0.0
        assert np.all(np.isfinite(command.foothold))


def test_the_foothold_asked_for_is_where_the_foot_lands(on_the_spot):
    _, plant, commands = on_the_spot
    landed = next(i for i, command in enumerate(commands) if command.event is PhaseEvent.LANDING)
    planned = commands[landed - 1].foothold
    assert planned[0] == pytest.approx(commands[landed - 100].foothold[0], abs=1e-12)  # frozen
    at = plant.space.feet[Stance.RIGHT].position  # it stood there during the second step, and stands still
    assert plant.stance is Stance.LEFT
    assert planned[0] == pytest.approx(at[0], abs=0.02)


def test_the_same_readings_give_the_same_digits(talos, on_the_spot):
    plant = RigidFoot(talos)
    twins = [walker_of(talos), walker_of(talos)]
    for walker in twins:
        walker.reset(plant.stance, plant.q, plant.v)
    for _ in range(60):
        reading = plant.reading()
        first, second = (walker.tick(reading) for walker in twins)
        assert np.array_equal(first.joint_torques, second.joint_torques)
        plant.advance(first.joint_torques)
    # and after a walk, once reset
    used, begun = on_the_spot[0], RigidFoot(talos)
    used.reset(begun.stance, begun.q, begun.v)
    fresh = walker_of(talos)
    fresh.reset(begun.stance, begun.q, begun.v)
    for _ in range(20):
        reading = begun.reading()
        first, second = used.tick(reading), fresh.tick(reading)
        assert np.array_equal(first.joint_torques, second.joint_torques)
        begun.advance(first.joint_torques)


# ---------------------------------------------------------------------- speed
@pytest.mark.slow
def test_a_speed_is_approached_step_by_step(talos):
    """The first step begins on the spot; from then on by what one step may change, forwards and back."""
    walker = walker_of(talos, speed=0.25)

    def landed(number):
        if number == 2:
            walker.command(speed=-0.02)

    plant, commands = walk(talos, walker, steps=3, on_landing=landed)
    events = [0] + [i for i, command in enumerate(commands) if command.event is PhaseEvent.LANDING]
    seen = [commands[i].speed_target for i in events]
    assert seen == pytest.approx([0.0, 0.15, 0.0, -0.02])
    assert plant.space.com[0] > 0.05  # it did go forwards


@pytest.mark.parametrize(("asked", "words"), [
    ({"lateral": 2.0}, "the legs do not reach as far"), ({"turn": -2.0}, "too much for a step"),
])  # fmt: skip
def test_steps_too_wide_or_too_much_turned_are_refused(talos, asked, words):
    walker = walker_of(talos)
    (name,) = asked
    with pytest.raises(SimulationError, match=rf"^{name} = .*{words}; at most [0-9.]+ (m|rad)/s$"):
        walker.command(speed=0.1, **asked)
    walker.command(lateral=0.0, turn=None)


# ---------------------------------------------------------------------- delay and softness
@pytest.mark.parametrize("delay", [1.5e-3, -1e-3, 4e-4])
def test_a_delay_that_is_no_multiple_is_refused(talos, delay):
    with pytest.raises(SimulationError, match=r"no multiple of the period of 0\.001 s; make it one$"):
        walker_of(talos, delay=delay)


def test_what_is_on_its_way_is_taken_into_account(talos):
    """Three periods late: the torques are those of the state three periods ahead, as a walker without delay has them.

    But for what the first three periods begin with.
    """
    delayed, prompt = walker_of(talos, delay=3.0 * H), walker_of(talos)
    late, now = RigidFoot(talos), RigidFoot(talos)
    for walker, plant in ((delayed, late), (prompt, now)):
        walker.reset(plant.stance, plant.q, plant.v)
    acting = []
    for k in range(150):
        acting.append(delayed.tick(late.reading()))
        late.advance(acting[max(0, k - 3)].joint_torques)
        command = prompt.tick(now.reading())
        now.advance(command.joint_torques)
    # two rates that any delay left alone would have made differ
    assert np.abs(late.v - now.v).max() < 0.05
    assert np.abs(acting[-1].y).max() < OUTPUT
    assert acting[-1].solved


def test_feedback_is_soft_after_a_landing(talos, on_the_spot):
    walker = on_the_spot[0]
    begin, end, least = SOFT
    values = []
    for since in (0.0, begin, 0.5 * (begin + end), end, np.inf):
        walker._since = since
        values.append(walker._softness())
    assert values == pytest.approx([least, least, 0.5 * (1.0 + least), 1.0, 1.0])
