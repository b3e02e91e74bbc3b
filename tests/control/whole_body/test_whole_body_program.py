"""The whole-body program: the planar torques in the plane, optimal under active limits, and what gives way."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from random_states import assert_close
from scipy.optimize import nnls
from whole_robots import adversarial, whole

from frontal_biped.control.settings import ControllerSettings
from frontal_biped.control.torques.torque_program import Source
from frontal_biped.control.whole_body.limits import LOADED, MotionLimits, contact_rows
from frontal_biped.control.whole_body.nearest import ACCELERATION
from frontal_biped.control.whole_body.program import STANDING, WholeBodyProgram
from frontal_biped.control.whole_body.settings import WholeBodySettings
from frontal_biped.control.whole_body.targets import WholeBodyTargets
from frontal_biped.control.whole_body.tasks import COP, FRI, LEGS, NATURE, OUTPUTS, weights
from frontal_biped.model import Stance
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import LENGTH, PITCH, YAW, SpaceState, X
from frontal_biped.model.state import State
from frontal_biped.numerics.quadratic_program import ProxQpSolver, QpSolution
from frontal_biped.simulation.space.start import start_in_space
from frontal_biped.virtual_constraints.phase import StepPhase

PLANAR = 1e-8
"""Of the largest torque, for a robot whose planar model leaves nothing out."""

AVERAGED = {"romeo_bent": PLANAR, "talos_full": 2e-2}
"""The same where left and right are averaged in the plane, or links between the hips' joints turn otherwise."""

ROWS = {"talos_full": 1e-8, "romeo_bent": 1e-8, "g1_bent": 1e-6}
"""By how much a solved tick may miss a row, in the program's units times the size of the row's terms.

One state of g1's thousand has rows of condition 1e6, and takes more than 1e-8; its feet are light.
"""

RELAXED_ROWS = 1e-3
"""The same, and what the contact may miss in weights, where limits gave way: straight knees, motions of 1e5 rad/s^2
that cancel. 1e-5 but for one state in a thousand."""

STATIONARY = 1e-8
"""Gradient, in the residuals, that no admissible multipliers of active rows balance; relative to the residuals."""

AS_PROXQP = 1e-7
"""Of the largest torque limit; ProxQP is asked for 1e-8."""

UNBOUND = WholeBodySettings(
    torque_share=1e3, speed_share=1e3, friction=100.0, sole_share=100.0, min_normal_force=-100.0, limit_rate=1e4
)
"""Limits nothing reaches."""


@pytest.fixture(scope="module")
def talos():
    return whole("talos_full")


# ---------------------------------------------------------------------- in the plane
def near_the_gait(robot, seed, count):
    """Phases and planar states: along the gait, and off it by some hundredths."""
    rng = np.random.default_rng(seed)
    for i in range(count):
        which = (StepPhase.RISING, StepPhase.FALLING)[i % 2]
        phase = robot.gait.rising if which is StepPhase.RISING else robot.gait.falling
        beta = phase.beta_start + rng.uniform() * phase.range
        h_d, h_d1, *_ = phase.desired(beta)
        rate = rng.uniform(-1.0, 1.0) * robot.gait.orbit.beta_dot_after_impact
        off = 0.0 if i < 4 else 0.02
        yield (
            which,
            State(
                np.r_[beta, h_d + off * rng.normal(size=3)], np.r_[rate, h_d1 * rate + 5.0 * off * rng.normal(size=3)]
            ),
        )


def in_the_plane(robot, state, stance, planar):
    """(dv, wrench) of the motion in space that is the planar one: kinematics, then Pinocchio's inverse dynamics."""
    model, out = robot.free.model, robot.free.model.createData()
    swing, legs = stance.other, [state.legs[side] for side in Stance]
    joints = [i for i in range(model.nv - BASE) if all(i not in robot.free.leg(side) for side in Stance)]
    frontal, stands, swings = state.frontal(stance), state.feet[stance], state.feet[swing]
    J = [frontal.J, *(leg.J[[LENGTH]] for leg in legs), state.pelvis.J[[PITCH, YAW]], stands.J]
    J += [swings.J[[X]], swings.turning.J[[PITCH, YAW]], np.eye(model.nv)[[BASE + i for i in joints]]]
    drift = [frontal.drift, *(leg.drift[[LENGTH]] for leg in legs), state.pelvis.drift[[PITCH, YAW]], stands.drift]
    drift += [swings.drift[[X]], swings.turning.drift[[PITCH, YAW]], np.zeros(len(joints))]
    J, drift = np.vstack(J), np.concatenate(drift)
    wanted = np.zeros(len(J))
    wanted[:4] = planar
    dv, *_ = np.linalg.lstsq(J, wanted - drift)
    np.testing.assert_allclose(J @ dv, wanted - drift, atol=1e-9 * np.abs(planar).max())
    force = pin.rnea(model, out, state.q, state.v, dv)[:BASE]
    return dv, np.linalg.solve(stands.J[:, :BASE].T, force)


@pytest.mark.parametrize("stance", Stance)
@pytest.mark.parametrize("name", AVERAGED)
def test_in_the_plane_roll_torques_are_the_planar_ones(name, stance):
    """The centre of pressure where inverse dynamics in space puts it: roll joints as in the plane."""
    robot = whole(name)
    planar = robot.planar(ControllerSettings(frequency=60.0, friction=100.0, max_torque=(1e5,) * 4))
    program, space = WholeBodyProgram(robot.free, UNBOUND), SpaceState(robot.free)
    rolls = [robot.free.joint_names.index(joint) for joint in robot.biped.stance_map.joint_names]
    for which, at in near_the_gait(robot, seed=0, count=12):
        targets, *_ = planar.targets(which, at)
        source, u, ddq, *_ = planar.program.solve(at, targets)
        assert source is Source.CLOSED_FORM
        start = start_in_space(robot.free, robot.biped, at, stance, space)
        state = space.at(start.q, start.v)
        dv, wrench = in_the_plane(robot, state, stance, ddq)
        whole_targets = WholeBodyTargets(stance, targets, -wrench[4] / wrench[2], 0.0, robot.joints)
        solution = program.solve(state, whole_targets)
        assert program.counts["linear"] > 0 and solution.solved
        within = AVERAGED[name]
        assert_close(solution.tau[rolls], robot.biped.stance_map.torques_to_urdf(u, stance), within)
        if within == PLANAR:
            assert_close(solution.dv, dv, PLANAR)
            assert_close(solution.wrench, wrench, PLANAR)


# ---------------------------------------------------------------------- adversarial states
class Judge:
    """Looks at answers with the posed program alone."""

    def __init__(self, robot, settings):
        self.robot, self.settings = robot, settings
        self.program = WholeBodyProgram(robot.free, settings)
        self.limits, self.state = MotionLimits(robot.free, settings), SpaceState(robot.free)
        self.effort = robot.free.limits.effort
        nv = robot.free.model.nv
        # the program's units: forces in weights, moments in weights at 0.1 m
        self.units = np.ones(nv + 6)
        self.units[nv:] = robot.free.weight * np.array([1.0, 1.0, 1.0, 0.1, 0.1, 0.1])
        self.worth = weights(self.program.rows)
        self.worth[[FRI, COP]] /= 0.01 * robot.free.weight

    def answer(self, q, v, targets):
        """The solution, and which way it came."""
        before = dict(self.program.counts)
        solution = self.program.solve(self.state.at(q, v), targets)
        (how,) = (kind for kind, count in self.program.counts.items() if count != before[kind])
        return solution, how

    def posed(self, targets, relaxed):
        """The program at the state, and its cost as |T x - t|^2/2."""
        program, state = self.program, self.state
        rows = program.rows.write(state, targets)
        qp = program.pose(rows, state, targets.stance, self.limits.at(state))
        T, t = rows.A[NATURE:] * self.units * self.worth[:, None], rows.b[NATURE:] * self.worth
        np.testing.assert_allclose(T.T @ T, qp.H, atol=1e-9 * np.abs(qp.H).max())
        if relaxed:
            standing = STANDING * ACCELERATION
            T, t = np.vstack([T, standing * qp.A[BASE:]]), np.concatenate([t, standing * qp.b[BASE:]])
            qp = program.relaxed(qp)
        return qp, T, t

    def optimality(self, solution, targets, relaxed):
        """Violation of the rows relative to their terms, and the gradient that no multipliers balance.

        The gradient in the residuals T x - t, where the cost is round: of the squared distance from the origin to what
        the rows allow. In x it would be a sum of terms 1e10 times larger.
        """
        qp, T, t = self.posed(targets, relaxed)
        x = np.concatenate([solution.dv, solution.wrench]) / self.units
        value, terms = qp.C @ x, np.maximum(1.0, np.abs(qp.C) @ np.abs(x))
        missed = np.maximum(qp.l - value, value - qp.u) / terms
        equality = np.abs(qp.A @ x - qp.b) / np.maximum(1.0, np.abs(qp.A) @ np.abs(x))
        within = (RELAXED_ROWS if relaxed else 1e-6) * terms
        low, high = value - qp.l < within, qp.u - value < within
        residuals = T @ x - t
        G = np.linalg.solve(np.vstack([qp.A, T]).T, qp.C.T).T[:, len(qp.b) :]
        pulls = np.vstack([G[low], -G[high]])
        left = float(np.linalg.norm(residuals))
        if len(pulls):
            left = nnls(pulls.T / np.linalg.norm(pulls, axis=1), residuals, maxiter=10000)[1]
        return max(missed.max(), equality.max()), left / max(1.0, float(np.linalg.norm(residuals)))


def judged(name, count, seed):
    """Every adversarial state: answered, torques and contact kept, optimal."""
    robot, settings = whole(name), WholeBodySettings()
    judge = Judge(robot, settings)
    contact = {side: contact_rows(robot.free, side, settings) / robot.free.weight for side in Stance}
    for q, v, targets in adversarial(robot, count, seed):
        solution, how = judge.answer(q, v, targets)
        assert solution.solved == (how != "relaxed") == (solution.given_way == "")
        assert np.all(np.abs(solution.tau) <= robot.free.limits.effort)
        kept = contact[targets.stance] @ solution.wrench
        kept[LOADED] -= settings.min_normal_force
        assert kept.min() > -RELAXED_ROWS
        violation, gradient = judge.optimality(solution, targets, relaxed=how == "relaxed")
        assert violation < (RELAXED_ROWS if how == "relaxed" else ROWS[name])
        assert gradient < STATIONARY
    counts = judge.program.counts
    assert counts["held"] == 0
    assert sum(counts.values()) == count
    return counts


@pytest.mark.parametrize("name", ["talos_full", "romeo_bent", "g1_bent"])
def test_adversarial_states(name):
    counts = judged(name, 60, seed=11)
    assert min(counts["limited"], counts["relaxed"]) >= 3  # of both kinds


@pytest.mark.slow
@pytest.mark.parametrize("name", ["talos_full", "romeo_bent", "g1_bent"])
def test_a_thousand_adversarial_states(name):
    counts = judged(name, 1000, seed=12)
    assert min(counts["linear"], counts["limited"], counts["relaxed"]) >= 5  # of every kind


@pytest.mark.parametrize("name", ["talos_full", "g1_bent"])
def test_proxqp_finds_the_same(name):
    """Another algorithm on the same program, wherever some motion keeps every limit."""
    robot, settings = whole(name), WholeBodySettings()
    exact, other = Judge(robot, settings), Judge(robot, replace(settings, solver="proxqp"))
    compared = 0
    for case in adversarial(robot, 60, seed=13):
        found, how = exact.answer(*case)
        if how == "relaxed":
            continue
        theirs, by = other.answer(*case)
        if by != "program":
            continue  # ProxQP gives up on a few that have a solution
        compared += 1
        assert_close(theirs.tau, found.tau, AS_PROXQP, floor=float(np.minimum(exact.effort, 1e3).max()))
    assert compared > 25


# ---------------------------------------------------------------------- what gives way
def limited(robot, **changed):
    """The robot with other limits of its joints: functions of (joint names, present values)."""
    free = FreeRobot(robot.biped.robot)
    names = np.array(free.joint_names)
    vars(free)["limits"] = free.limits._replace(
        **{kind: change(names, getattr(free.limits, kind)) for kind, change in changed.items()}
    )
    return robot._replace(free=free)


def after_impact(robot, stance=Stance.LEFT):
    """State after the impact, and the gait's targets there."""
    at = State(*robot.gait.state_after_impact())
    start = start_in_space(robot.free, robot.biped, at, stance)
    targets, *_ = robot.planar(ControllerSettings(frequency=60.0)).targets(StepPhase.RISING, at)
    return start, WholeBodyTargets(stance, targets, 0.0, 0.0, robot.joints)


def missed(program, state, targets, solution):
    """(12 + outside,) residuals of what was asked for, the last rows those of the joints outside the legs."""
    A, b = program.rows.write(state, targets)
    return (A @ np.concatenate([solution.dv, solution.wrench]) - b)[NATURE:]


def test_a_weak_arm_gives_way_alone():
    """An arm asked for more than its motors have: its joints lag behind by far more than anything of the legs."""
    arms = limited(
        whole("talos_full"), effort=lambda names, of: np.where(np.char.find(names, "arm_left") >= 0, 5.0, of)
    )
    start, targets = after_impact(arms)
    asked = targets.joints.copy()
    arm = arms.free.joint_names.index("arm_left_2_joint")
    asked[arm] += 0.3
    targets = replace(targets, joints=asked)
    program, state = WholeBodyProgram(arms.free, WholeBodySettings()), SpaceState(arms.free)
    solution = program.solve(state.at(start.q, start.v), targets)
    assert program.counts["limited"] == 1 and solution.solved
    assert np.abs(solution.tau[arm]) == pytest.approx(5.0)
    residuals = np.abs(missed(program, state, targets, solution))
    residuals[[FRI, COP]] /= 0.01 * arms.free.weight
    assert residuals[LEGS:].max() > 10.0
    assert residuals[:LEGS].max() < 1e-3 * residuals[LEGS:].max()


def test_a_pressure_beyond_the_sole_stays_at_its_edge():
    """What it would have held, arms and trunk give; the paper's outputs, worth more, all but stay."""
    robot, settings = whole("talos_full"), WholeBodySettings()
    start, targets = after_impact(robot)
    program, state = WholeBodyProgram(robot.free, settings), SpaceState(robot.free)
    targets = replace(targets, cop_x=0.15)
    solution = program.solve(state.at(start.q, start.v), targets)
    assert solution.solved
    _, _, F_z, _, M_y, _ = solution.wrench
    assert -M_y / F_z == pytest.approx(settings.sole_share * robot.free.soles.left.front, rel=1e-6)
    residuals = np.abs(missed(program, state, targets, solution))
    assert residuals[OUTPUTS].max() < 1e-3 * residuals[LEGS:].max()


def test_no_torque_at_all_still_has_an_answer():
    """A body that falls, and may not: joints and foot give way, and the answer says so; the contact never does."""
    dead = limited(
        whole("talos_full"),
        effort=lambda names, of: np.full(len(names), 1e-3),
        velocity=lambda names, of: np.full(len(names), 1e-3),
    )
    start, targets = after_impact(dead)
    program, state = WholeBodyProgram(dead.free, WholeBodySettings()), SpaceState(dead.free)
    solution = program.solve(state.at(start.q, dead.still), targets)
    assert not solution.solved
    assert solution.given_way == "joint ranges and speeds, standing foot"
    assert np.abs(solution.tau).max() <= 1e-3
    rows = contact_rows(dead.free, Stance.LEFT, WholeBodySettings())
    assert (rows @ solution.wrench).min() > -RELAXED_ROWS * dead.free.weight


def test_a_joint_driven_against_its_end_stops_there():
    """A fifth of a second of the gait, an arm asked for far beyond its range: integrated, no joint passes its end."""
    robot, settings, h = whole("talos_full"), WholeBodySettings(), 1e-3
    free = robot.free
    start, targets = after_impact(robot)
    arm = free.joint_names.index("arm_left_4_joint")
    asked = targets.joints.copy()
    end = free.limits.upper[arm]
    asked[arm] = end + 1.0
    planar = robot.planar(ControllerSettings(frequency=60.0))
    program, state = WholeBodyProgram(free, settings), SpaceState(free)
    q, v, highest = start.q, start.v, -np.inf
    for _ in range(200):
        seen = state.at(q, v).frontal(Stance.LEFT)
        frontal, *_ = planar.targets(StepPhase.RISING, State(seen.q, seen.dq))
        solution = program.solve(state, replace(targets, frontal=frontal, joints=asked))
        assert solution.solved
        v = v + h * solution.dv
        q = pin.integrate(free.model, q, h * v)
        highest = max(highest, q[BASE + 1 + arm])
        assert np.all(q[BASE + 1 :] <= free.limits.upper) and np.all(q[BASE + 1 :] >= free.limits.lower)
    assert program.counts["limited"] > 50
    # on its way there as a critically damped spring
    assert end - 2.0 * settings.range_margin < highest < end - 0.9 * settings.range_margin


def test_where_nothing_was_ever_solved_no_torque_is_held(monkeypatch, talos):
    """Neither way finds anything: the last torques are held, at first none."""
    program, state = WholeBodyProgram(talos.free, WholeBodySettings()), SpaceState(talos.free)
    start, targets = after_impact(talos)
    state.at(start.q, start.v)

    def lose(patch):
        patch.setattr(WholeBodyProgram, "_exact", lambda *_: None)
        patch.setattr(ProxQpSolver, "solve", lambda _, qp: QpSolution(qp.g, qp.b, qp.l, False, "lost", 0))

    with monkeypatch.context() as nothing:
        lose(nothing)
        held = program.solve(state, targets)
        assert np.array_equal(held.tau, np.zeros(len(talos.joints)))
        assert held.given_way == "everything: the last torques are held"
    found = program.solve(state, targets)
    assert found.solved
    with monkeypatch.context() as nothing:
        lose(nothing)
        held = program.solve(state, targets)
    assert np.array_equal(held.tau, found.tau) and not held.solved
    assert program.counts["held"] == 2
    program.reset()
    assert sum(program.counts.values()) == 0
