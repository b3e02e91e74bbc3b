"""The sampled loop: who is asked when, what arrives at the motors, and its limit, control in continuous time."""

from itertools import pairwise

import numpy as np
import pytest

from frontal_biped.control.controller import QpController
from frontal_biped.control.interface import Contract, PhaseEvent, WalkerCommand
from frontal_biped.control.walker.walker import Walker
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.stance_map import Stance, relabel
from frontal_biped.simulation import Disturbances, SimulationSettings, simulate
from frontal_biped.simulation.engine import Move
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.loop import PHASE_TIME_LIMIT, TIMED_OUT, Decision, run_sampled
from frontal_biped.simulation.motors import Motors
from frontal_biped.simulation.pushes import PushForces
from frontal_biped.simulation.rigid import MOST_TURNS, RigidEngine
from frontal_biped.simulation.sensed import walk_in
from frontal_biped.simulation.trajectory import COMPLETED
from frontal_biped.virtual_constraints.phase import StepPhase

PERIOD = 1e-3
STRONG = np.full(4, 1e3)  # motors that clip nothing [N m]


class Clockwork:
    """An engine that stops at given times, and a pilot that writes down what it is told."""

    def __init__(self, stops=(), last=np.inf):
        self.stops, self.last = list(stops), last
        self.asked, self.sent_at, self.moves = [], [], []
        self.since = 0.0

    def advance(self, t, end, tau, pushes):
        stop = next((s for s in self.stops if t < s < end), None)
        return Move(end, [(end - t, end, None)]) if stop is None else Move(stop, (), EventKind.REVERSAL)

    def decide(self, t):
        self.asked.append(t)
        return None if t >= self.last else Decision(np.full(4, float(len(self.asked))))

    def sent(self, t, tau):
        self.sent_at.append((t, float(tau[0])))

    def moved(self, move):
        self.moves.append(move)


def walk(clockwork, **disturbances):
    motors = Motors(Disturbances(**disturbances), PERIOD, STRONG)
    return run_sampled(clockwork, clockwork, motors, PushForces(()), PERIOD)


def test_one_decision_a_period_and_none_within():
    """An event splits a period into two moves under the same torques; the next decision waits for the tick."""
    clockwork = Clockwork(stops=[1.4e-3], last=3.5e-3)
    assert walk(clockwork) == COMPLETED
    assert clockwork.asked == pytest.approx([0.0, 1e-3, 2e-3, 3e-3, 4e-3])
    assert [move.t for move in clockwork.moves] == pytest.approx([1e-3, 1.4e-3, 2e-3, 3e-3, 4e-3])
    assert [move.event for move in clockwork.moves].count(EventKind.REVERSAL) == 1
    assert [u for _, u in clockwork.sent_at] == [1.0, 2.0, 3.0, 4.0]


def test_torques_arrive_late_by_the_delay():
    clockwork = Clockwork(last=5.5e-3)
    walk(clockwork, delay=2e-3)
    assert [u for _, u in clockwork.sent_at] == [1.0, 1.0, 1.0, 2.0, 3.0, 4.0]


def test_a_phase_that_never_ends_is_no_walk():
    clockwork = Clockwork()
    assert walk(clockwork) == TIMED_OUT
    assert clockwork.asked[-1] == pytest.approx(PHASE_TIME_LIMIT, abs=2 * PERIOD)


class Rocking:
    """A walker that believes to reverse and to be turned outwards for ever, and never to land."""

    def reset(self, stance, q, dq):
        self.ticks, self.state = 0, (q, dq)

    def tick(self, reading):
        self.ticks += 1
        event = {0: PhaseEvent.REVERSAL, 250: PhaseEvent.TURNED_OUTWARDS}.get(self.ticks % 500)
        none = np.zeros(4)
        return WalkerCommand(none, StepPhase.RISING, Stance.LEFT, none, *self.state, np.zeros(3), 0.0, True, event)


class Still(RigidEngine):
    """An engine in which nothing moves."""

    def advance(self, t, end, tau, pushes):
        return Move(end)


def test_rocking_on_the_spot_is_no_walk(biped, robust_gait):
    settings = SimulationSettings(steps=1, period=PERIOD, record_rate=10.0)
    run = walk_in(Still(biped, None, settings), biped, Rocking(), robust_gait.state_after_impact(), settings)
    assert run.outcome == TIMED_OUT
    assert run.event_t[-1] == pytest.approx(PHASE_TIME_LIMIT, abs=0.3)
    assert run.event_kind.count("TURNED_OUTWARDS") > 5


def test_a_robot_that_turns_outwards_again_and_again_falls(biped, robust_gait):
    engine = RigidEngine(biped, None, SimulationSettings())
    engine.place(Stance.LEFT, robust_gait.state_after_impact())
    assert [engine.cross(EventKind.TURNED_OUTWARDS) for _ in range(MOST_TURNS)] == [None] * MOST_TURNS
    assert engine.cross(EventKind.TURNED_OUTWARDS) is EventKind.TURNED_OUTWARDS


def test_a_foot_below_the_ground_at_the_reversal_has_landed_early(biped, robust_gait):
    engine = RigidEngine(biped, None, SimulationSettings())
    engine.place(Stance.LEFT, robust_gait.state_after_impact())
    engine.raise_ground(Stance.RIGHT, 0.01)  # the swing foot is still on the old ground
    assert engine.cross(EventKind.REVERSAL) is EventKind.EARLY_LANDING


@pytest.mark.parametrize(
    ("settings", "complaint"),
    [({"steps": 0}, "steps = 0"), ({"steps": -1}, "steps = -1"), ({"steps": 2.5}, "steps = 2.5"),
     ({"period": 0.0}, "period = 0.0"), ({"period": float("nan")}, "period = nan")],
)  # fmt: skip
def test_a_walk_has_steps_and_a_period(settings, complaint):
    with pytest.raises(SimulationError, match=complaint):
        SimulationSettings(**settings)


def test_noise_follows_the_chain_it_is_drawn_along():
    """The same draws in either order: on the right foot the chain from stance to swing runs the other way."""
    tau = np.array([1.0, 2.0, 3.0, 4.0])
    left, right = (
        Motors(Disturbances(torque_noise=0.1, seed=5), PERIOD, STRONG).send(tau, stance) / tau for stance in Stance
    )
    assert right == pytest.approx(relabel(left), rel=1e-15)
    assert np.ptp(left) > 0.0


def test_no_motor_gives_more_than_it_has():
    motors = Motors(Disturbances(torque_limits=(5.0, 50.0)), PERIOD, np.full(4, 20.0))
    assert motors.send(np.array([-9.0, 30.0, -30.0, 3.0])).tolist() == [-5.0, 20.0, -20.0, 3.0]
    assert motors.arriving.tolist() == [-9.0, 30.0, -30.0, 3.0]


def test_sampled_control_tends_to_continuous_control(biped, robust_gait):
    """The hold is a perturbation of first order in the period: halving it halves the distance to the oracle."""
    oracle = simulate(biped, robust_gait, steps=2, period=None, stabiliser="fixed")
    distance = []
    for period in (4e-3, 2e-3, 1e-3):
        # the same gains, whatever the period
        settings = QpController(biped, robust_gait).settings
        run = simulate(
            biped, robust_gait, steps=2, period=period, stabiliser="fixed", controller_settings=settings,
            simulation_settings=SimulationSettings(),
        )  # fmt: skip
        distance.append(np.max(np.abs(run.event_t - oracle.event_t)))
    for coarse, fine in pairwise(distance):
        assert fine < 0.75 * coarse  # first order would be 0.5, order zero 1


@pytest.mark.parametrize(
    ("make", "contract"),
    [
        (lambda biped, gait: QpController(biped, gait), Contract.TOLD),
        (lambda biped, gait: Walker(biped, gait), Contract.SENSED),
        (lambda *_: Walker, None),  # a class is a factory
        (lambda *_: print, None),
        (lambda *_: type("Half", (), {"tick": None})(), None),
    ],
)
def test_contract_of_a_controller(biped, robust_gait, make, contract):
    assert Contract.of(make(biped, robust_gait)) is contract
