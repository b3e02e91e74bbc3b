"""The loop of walks in space, without physics: a robot that is lifted from foot to foot, and a walker that follows."""

import numpy as np
import pytest
from standing import Stander

from frontal_biped import load_robot
from frontal_biped.control.interface import PhaseEvent
from frontal_biped.control.spatial_walker.interface import SpatialReading
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.engine import Move
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.pushes import Push
from frontal_biped.simulation.space.engine import SolePose, SpatialState
from frontal_biped.simulation.space.pushes import SpatialPush
from frontal_biped.simulation.space.run import SAMPLED, load_spatial_run, save_spatial_run
from frontal_biped.simulation.space.settings import SpatialSettings, SpeedChange
from frontal_biped.simulation.space.soles import footsteps
from frontal_biped.simulation.space.steps import step_table
from frontal_biped.simulation.space.walking import walk_in_space
from frontal_biped.virtual_constraints.phase import StepPhase

STEP, HALF, DOUBLE = 0.3, 0.15, 0.01
"""Duration of a step, of its rising phase and of double support [s]."""

LENGTH = 0.1  # of a step [m]


class Lifted:
    """An engine that knows no forces: the robot glides at its posture, its contacts alternate."""

    name = "lifted"

    def __init__(self, free):
        self.free, self.t, self.pushed, self.raised, self.falls_at = free, 0.0, [], [], np.inf

    def place(self, q, v):
        self.q, self.v = q, v

    def stance(self):
        return Stance.LEFT if int(self.t / STEP + 1e-9) % 2 == 0 else Stance.RIGHT

    def state(self):
        q = self.q.copy()
        q[0] += LENGTH * self.t / STEP
        return SpatialState(q, self.v)

    def read(self, t):
        self.t = t
        both = t % STEP < DOUBLE
        contact = tuple(both or side is self.stance() for side in Stance)
        n = len(self.free.joint_names)
        return SpatialReading(t, self.q[7:], np.full(n, 0.5), np.eye(3), np.zeros(3), contact)

    def com(self):
        return np.array([LENGTH * self.t / STEP, 0.0, 0.8]), np.array([LENGTH / STEP, 0.0, 0.0])

    def sole(self, side):
        step = int(self.t / STEP + 1e-9)
        mine = step if side is self.stance() else step - 1
        return SolePose(np.array([LENGTH * mine, 0.1 * side.sign, 0.0]), np.eye(3))

    def wrenches(self):
        wrenches = np.zeros((2, 6))
        # pressed 3 cm ahead of the ankle and 2 cm to the left of it
        wrenches[0 if self.stance() is Stance.LEFT else 1] = [0.0, 0.0, 100.0, 2.0, -3.0, 0.0]
        return wrenches

    def torques(self):
        return self.acting

    def raise_ground(self, stance, height):
        self.raised.append((round(self.t, 6), stance, height))

    def advance(self, t, end, tau, pushes):
        self.acting = tau
        self.pushed += [(round(t, 6), *each.force) for each in pushes.at(t)]
        return Move(end, fell=EventKind.COLLAPSED if end > self.falls_at else None)


class Follower(Stander):
    """Takes every alternation of the contacts for a landing; half-way it notices a reversal."""

    def tick(self, reading):
        phase = StepPhase.RISING if reading.time % STEP < HALF else StepPhase.FALLING
        event = None
        if abs(reading.time % STEP - HALF) < 1e-9:
            event = PhaseEvent.REVERSAL
        elif reading.time > 0.0 and (reading.time + 1e-9) % STEP < 1e-8:
            event, self.stance = PhaseEvent.LANDING, self.stance.other
        return super().tick(reading, event, phase)

    def torques(self, reading):
        return np.arange(len(self.free.joint_names), dtype=float)


@pytest.fixture(scope="module")
def free():
    return FreeRobot(load_robot("talos_full").robot)


@pytest.fixture
def start(free):
    return SpatialState(free.posture, np.zeros(free.model.nv))


def lifted(free, start, walker=None, falls_at=np.inf, **settings):
    engine = Lifted(free)
    engine.falls_at = falls_at
    on_step = []
    run = walk_in_space(
        free, walker or Follower(free), start, SpatialSettings(**settings), engine=engine, on_step=on_step.append
    )
    return run, engine, on_step


def test_steps_phases_and_events(free, start):
    run, _, told = lifted(free, start, steps=3)
    assert (run.outcome, run.steps_completed, told) == ("completed", 3, [1, 2, 3])
    assert run.event_kind == ("IMPACT", "REVERSAL", "IMPACT", "REVERSAL", "IMPACT", "REVERSAL", "IMPACT")
    assert run.event_t == pytest.approx(STEP * np.arange(0.0, 3.1, 0.5))
    assert run.event_step.tolist() == [-1, 0, 0, 1, 1, 2, 2]
    table = step_table(run)
    assert table.duration == pytest.approx(np.full(3, STEP), abs=0.005)  # a sample
    assert table.speed == pytest.approx(np.full(3, LENGTH / STEP), rel=0.02)
    inside = (run.t % STEP > 1e-3) & (run.t % STEP < STEP - 1e-3)
    assert run.step[inside] == pytest.approx(np.floor(run.t[inside] / STEP))
    assert run.stance[inside] == pytest.approx(np.where(run.step[inside] % 2 == 0, 1.0, -1.0))
    stood = [(foot.step, foot.side, foot.x, foot.y) for foot in footsteps(run)[1:]]
    sides = (Stance.LEFT, Stance.RIGHT, Stance.LEFT)
    assert stood == [(k, side, pytest.approx(LENGTH * k), 0.1 * side.sign) for k, side in enumerate(sides)]


def test_samples_come_at_the_record_rate_and_at_events(free, start):
    run, _, _ = lifted(free, start, steps=2, record_rate=100.0)
    ticks = np.round(run.t * 1000.0).astype(int)
    assert set(range(0, 600, 10)) <= set(ticks)
    assert set(ticks) - set(range(0, 600, 10)) <= {150, 300, 450}


def test_pressure_is_told_along_the_stance_foot(free, start):
    """3 cm ahead; 2 cm to the left is away from the swing foot on the left foot, towards it on the right."""
    run, _, _ = lifted(free, start, steps=2)
    assert run.cop_x == pytest.approx(np.full(len(run.t), 0.03))
    assert run.p_fri == pytest.approx(-0.02 * run.stance)


def test_motors_and_their_measures(free, start):
    run, _, _ = lifted(free, start, steps=2)
    n = len(free.joint_names)
    assert run.tau == pytest.approx(np.tile(np.minimum(np.arange(n), free.limits.effort), (len(run.t), 1)))
    measured = run.settings["measured"]
    share = np.minimum(np.arange(n) / free.limits.effort, 1.0)
    assert measured["torque_share"]["largest"] == pytest.approx(share.max())
    assert measured["speed_share"]["largest"] == pytest.approx(np.max(0.5 / free.limits.velocity))
    assert measured["beyond_range"]["largest"] == 0.0
    acting = np.minimum(np.arange(n), free.limits.effort)
    assert measured["work"]["mean"] == pytest.approx(STEP * 0.5 * acting.sum())
    assert measured["effort"]["mean"] == pytest.approx(STEP * acting @ acting)
    assert measured["double_support"]["mean"] == pytest.approx(DOUBLE, abs=2e-3)  # within two ticks
    assert measured["slip"]["largest"] == 0.0


def test_delay_holds_the_torques_back(free, start):
    class Counter(Follower):
        def torques(self, reading):
            return np.full(len(self.free.joint_names), 1e-3 * len(self.readings))

    run, _, _ = lifted(free, start, Counter(free), steps=1, record_rate=1000.0, disturbances=Disturbances(delay=0.003))
    assert run.tau[:, 0] == pytest.approx(1e-3 * np.maximum(1 + np.arange(len(run.t)) - 3, 1))


def test_pushes_begin_with_their_phase(free, start):
    at_time = SpatialPush(0.05, 0.002, (1.0, 0.0, 0.0))
    in_step = SpatialPush(0.01, 0.002, (0.0, 2.0, 0.0), step=1, phase="falling")
    _, engine, _ = lifted(free, start, steps=3, pushes=(at_time, in_step))
    begins = STEP + HALF + 0.01
    assert engine.pushed == [
        (0.05, 500.0, 0.0, 0.0),
        (0.051, 500.0, 0.0, 0.0),
        (pytest.approx(begins), 0.0, 1000.0, 0.0),
        (pytest.approx(begins + 0.001), 0.0, 1000.0, 0.0),
    ]


def test_ground_is_raised_under_the_next_foot(free, start):
    _, engine, _ = lifted(free, start, steps=2, disturbances=Disturbances(ground=(0.001, -0.002)))
    assert engine.raised == [(0.0, Stance.RIGHT, 0.001), (pytest.approx(STEP), Stance.LEFT, -0.002)]


def test_commands_come_when_they_are_due(free, start):
    walker = Follower(free)
    commands = (
        SpeedChange(speed=0.2, step=0),
        SpeedChange(turn=0.1, time=0.1),
        SpeedChange(speed=-0.1, lateral=0.05, step=1),
    )
    lifted(free, start, walker, steps=2, commands=commands)
    # before the readings number 0, 100, and the first one of the second step
    assert walker.commanded == [
        (0, 0.2, None, None),
        (100, None, None, 0.1),
        (round(STEP / 1e-3) + 1, -0.1, 0.05, None),
    ]


def test_a_fall_is_an_outcome(free, start):
    run, _, _ = lifted(free, start, steps=5, falls_at=0.4)
    assert run.fell
    assert run.outcome == EventKind.COLLAPSED.value
    assert run.steps_completed == 1
    assert run.event_kind[-1] == "COLLAPSED"
    assert run.event_t[-1] == pytest.approx(0.401)


def test_what_gave_way_is_counted(free, start):
    class Strained(Follower):
        def tick(self, reading):
            command = super().tick(reading)
            tick = len(self.readings)
            return command.__class__(
                **{**vars(command), "solved": tick % 2 == 0, "given_way": "arms" if tick <= 10 else ""}
            )

    run, _, _ = lifted(free, start, Strained(free), steps=1)
    assert run.settings["controller"]["gave_way"] == {"arms": 10}
    assert run.settings["controller"]["unsolved"] == round(0.5 * STEP / 1e-3)


def test_the_run_file_keeps_it_all(free, start, tmp_path):
    push = SpatialPush(0.05, 0.002, (1.0, 0.0, 0.0), "torso_2_link")
    run, _, _ = lifted(free, start, steps=1, pushes=(push,), commands=(SpeedChange(speed=0.1, step=0),))
    save_spatial_run(run, tmp_path / "run.npz")
    back = load_spatial_run(tmp_path / "run.npz")
    for name in (*SAMPLED, "event_t", "event_step", "event_frontal"):
        assert np.array_equal(getattr(back, name), getattr(run, name), equal_nan=True), name
    assert back.settings["pushes"] == [
        {
            "start": 0.05, "duration": 0.002, "impulse": [1.0, 0.0, 0.0], "link": "torso_2_link",
            "point": [0.0, 0.0, 0.0], "profile": "constant", "step": None, "phase": None,
        }
    ]  # fmt: skip
    assert back.settings["commands"][0]["speed"] == 0.1
    assert back.locked == free.locked


def test_a_standing_robot_stays_where_it_is(free, start):
    """In MuJoCo, under a controller that never steps: five seconds, then it is told that this is no walk."""
    pytest.importorskip("mujoco")
    run = walk_in_space(free, Stander(free), start, SpatialSettings(steps=1, period=2e-3, record_rate=20.0))
    assert "longer than 5 s" in run.outcome
    moved = run.com[-1] - run.com[0]
    assert np.linalg.norm(moved) < 5e-3
    assert abs(run.yaw[-1]) < 1e-3
    np.testing.assert_allclose(run.frontal_q[-1], -0.5 * np.pi, atol=1e-3)
    com_x = run.com[-1, 0] - 0.5 * run.sole_position[-1, :, 0].sum()
    assert run.cop_x[-1] == pytest.approx(com_x, abs=2e-3)
    assert run.settings["contact"]["timestep"] == 5e-4


@pytest.mark.parametrize(
    ("settings", "match"),
    [
        ({"steps": 0}, "steps = 0"),
        ({"period": 0.0}, "period = 0.0"),
        ({"velocity_noise": -1.0}, "velocity_noise"),
        ({"disturbances": Disturbances(pushes=(Push(0.1, 0.1, 1.0),))}, "pushes of the plane"),
        ({"disturbances": Disturbances(torque_limits=(1.0, 1.0))}, "torque_limits"),
    ],
)
def test_settings_that_make_no_walk_are_refused(settings, match):
    with pytest.raises(SimulationError, match=match):
        SpatialSettings(**settings)


def test_a_command_needs_a_moment():
    for wrong in ({}, {"step": 1, "time": 0.1}):
        with pytest.raises(SimulationError, match="either a step or a time"):
            SpeedChange(speed=0.1, **wrong)


def test_a_push_on_no_link_is_refused(free, start):
    with pytest.raises(SimulationError, match="no such link"):
        lifted(free, start, steps=1, pushes=(SpatialPush(0.1, 0.1, (1.0, 0.0, 0.0), "tail"),))
