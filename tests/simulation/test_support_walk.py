"""Stand, set off, walk with finite double supports, stop and stand, in our engine and in MuJoCo."""

import numpy as np
import pytest
from support_gaits import designed

from frontal_biped.control.support_walker import SupportMode
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.catalogue import biped_of
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.support_engine import SupportEngine
from frontal_biped.simulation.support_walk import stand_walk_stand, support_world, walk_from_lift_off
from frontal_biped.viewer.page_data import event_marks
from frontal_biped.zero_dynamics.restricted import TORQUES, restrict
from frontal_biped.zero_dynamics.support_dynamics import SupportPoint

DEAD_BEAT = 0.01
"""Largest error of speed one step after one of 10 %."""

FIRST_STEP = 0.05
"""Largest error of the first lift-off's speed after standing."""

TO_REST = 2
"""Most landings between the command to stop and rest."""

ENGINES = ["ours", "mujoco"]
HUMANOIDS = [pytest.param(name, marks=pytest.mark.slow) for name in ("talos_full", "g1")]
ROBOTS = ["frontal_biped", *HUMANOIDS]


def gait_of(name):
    return designed(name).gait


def needs(engine):
    if engine == "mujoco":
        pytest.importorskip("mujoco")


@pytest.mark.parametrize("engine", [pytest.param("ours", marks=pytest.mark.slow), "mujoco"])
@pytest.mark.parametrize("name", ROBOTS)
def test_from_standing_to_standing(name, engine):
    needs(engine)
    biped, gait = biped_of(name), gait_of(name)
    run = stand_walk_stand(biped, gait, steps=3, engine=engine, stand=0.3)
    assert not run.fell, run.outcome
    assert abs(run.steps[0].speed / gait.speed - 1.0) < FIRST_STEP
    assert run.landings_to_rest <= TO_REST
    standing = run.mode == list(SupportMode).index(SupportMode.STANDING)
    assert standing[0] and standing[-1]
    assert np.abs(run.trajectory.dq[-1]).max() < 0.01  # at rest
    assert run.loads[-1] == pytest.approx(np.full(2, 0.5 * biped.weight), rel=0.05)  # on both feet
    # single supports reverse, one more than landings asked for, and so does coming to rest; standing does not
    assert sum(mark["kind"] == "reversal" for mark in event_marks(run.trajectory)) == len(run.steps) + 1


@pytest.mark.parametrize("error", [0.1, -0.1])
@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", ROBOTS)
def test_an_error_of_speed_is_gone_after_one_step(name, engine, error):
    needs(engine)
    biped, gait = biped_of(name), gait_of(name)
    run = walk_from_lift_off(biped, gait, steps=2, engine=engine, speed_error=error)
    assert not run.fell, run.outcome
    first, second = (step.speed / gait.speed - 1.0 for step in run.steps[:2])
    assert first == pytest.approx(error, abs=1e-6)
    assert abs(second) < DEAD_BEAT


def test_without_dead_beat_the_error_stays(biped):
    """The gait is neutral: what the test above sees is the work of double support."""
    gait = gait_of("frontal_biped")
    run = walk_from_lift_off(biped, gait, steps=2, speed_error=0.1, dead_beat=False)
    assert not run.fell, run.outcome
    assert run.steps[1].speed / gait.speed - 1.0 > 0.05


def test_either_foot_may_go_first(biped):
    gait = gait_of("frontal_biped")
    left, right = (walk_from_lift_off(biped, gait, steps=1, stance=side) for side in Stance)
    assert left.trajectory.q == pytest.approx(right.trajectory.q, abs=1e-9)
    assert left.loads == pytest.approx(right.loads[:, ::-1], abs=1e-5)


def test_load_is_handed_over_without_a_jump(biped):
    """In our engine: the foot that lands takes its load from nothing, the one that leaves gives up all of it."""
    run = walk_from_lift_off(biped, gait_of("frontal_biped"), steps=2)
    step = run.steps[0]
    after = run.steps[1].lift_off
    t = run.trajectory.t
    inside = (t > step.landing + 2e-3) & (t < after - 2e-3)
    share = run.loads[inside] / run.loads[inside].sum(axis=1, keepdims=True)
    landed = share[:, 1]  # the first stance foot is the left one
    assert landed[0] < 0.1 and landed[-1] > 0.9
    assert np.abs(np.diff(landed)).max() < 0.05


class TestEngine:
    """Our engine with both feet on the ground."""

    def test_a_plastic_landing_keeps_the_momentum_along_the_family(self, biped):
        gait = gait_of("frontal_biped")
        family, engine = gait.family(biped), SupportEngine(biped)
        at = family.at(gait.rising.beta_start)
        falling = -0.3 * at.dq + np.array([0.0, 0.002, -0.004, 0.002])  # the foot comes down a little
        engine.lift(Stance.LEFT, State(at.q, falling))
        D = biped.D(at.q)
        assert engine._land(0.0) is None
        assert engine.double and engine.stance is Stance.RIGHT
        back = engine.state.relabelled()
        assert at.dq @ D @ back.dq == pytest.approx(at.dq @ D @ falling, rel=1e-9)
        assert 0.5 * back.dq @ D @ back.dq <= 0.5 * falling @ D @ falling

    def test_a_hard_landing_tears_the_other_foot_off(self, biped):
        gait = gait_of("frontal_biped")
        engine = SupportEngine(biped)
        at = gait.family(biped).at(gait.rising.beta_start)
        engine.lift(Stance.LEFT, State(at.q, np.array([-1.0, -6.0, 12.0, -5.0])))
        assert engine._land(0.0) == "a landing tore the other foot off the ground"

    def test_a_foot_that_would_be_pulled_leaves(self, biped):
        """Under the torques of single support at the lift-off; standing still, both feet stay."""
        gait = gait_of("frontal_biped")
        family, engine = gait.family(biped), SupportEngine(biped)
        beta = gait.rising.beta_start
        engine.stand(Stance.LEFT, family, beta)
        standing = SupportPoint.of(family, beta)
        u = standing.forces(0.0, 0.0, standing.shared(0.0, 0.0, gait.p_fri)).u
        engine.advance(0.0, 1e-3, biped.stance_map.torques_to_urdf(u, Stance.LEFT))
        assert engine.double and not engine.lift_offs
        engine.state = State(standing.at.q, gait.speed * standing.at.dq)
        u = restrict(biped, gait.rising, np.array([beta])).forces(np.array([gait.speed**2]))[TORQUES, 0]
        engine.advance(1e-3, 2e-3, biped.stance_map.torques_to_urdf(u, Stance.LEFT))
        assert not engine.double and engine.lift_offs == [1e-3]
        assert biped.swing_clearance(engine.state.q) > 0.0

    @pytest.mark.parametrize("stance", list(Stance))
    def test_a_foot_that_is_pressed_sideways_slips_where_it_can(self, biped, stance):
        """Just below the coefficient that both feet use it is a fall, just above it is none."""
        family = gait_of("frontal_biped").family(biped)
        tau = biped.stance_map.torques_to_urdf(np.array([0.0, 5.0, -5.0, 0.0]), stance)

        def engine(friction):
            one = SupportEngine(biped, friction=friction)
            one.stand(stance, family, family.half_way())
            return one

        held = engine(None)
        assert held.advance(0.0, 1e-6, tau) is None
        used = max(reaction.friction_used for reaction in held.reactions().values())
        assert 0.0 < used < np.inf
        assert engine(0.98 * used).advance(0.0, 1e-6, tau) is EventKind.SLIPPED
        assert engine(1.02 * used).advance(0.0, 1e-6, tau) is None

    def test_unknown(self, biped):
        with pytest.raises(SimulationError, match="ours, mujoco"):
            support_world(biped, "bullet")
