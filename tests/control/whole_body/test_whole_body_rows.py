"""The rows of the whole body and the motions in their residuals: against dense solves, Pinocchio's own inverse dynamics
and motion along time."""

import numpy as np
import pinocchio as pin
import pytest
from random_states import assert_close
from whole_robots import adversarial, whole

from frontal_biped.control.whole_body.motion import MotionSolver, SingularRowsError
from frontal_biped.control.whole_body.settings import WholeBodySettings
from frontal_biped.control.whole_body.tasks import COP, FRI, LEGS, LENGTHS, NATURE, OUTPUTS, TaskRows, weights
from frontal_biped.exceptions import RobotError
from frontal_biped.model import Stance, load_robot
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import LENGTH, SpaceState

SAME = 1e-8
"""Relative: two ways to solve the same linear system, whose condition is up to 1e6 at these states."""

EXACT = 1e-10
"""Relative: two ways to the same sums."""

STANDING = 10.0

SETTINGS = WholeBodySettings()


@pytest.fixture(scope="module", params=["talos_full", "g1_bent"])
def robot(request):
    return whole(request.param)


@pytest.fixture(scope="module")
def talos():
    return whole("talos_full")


@pytest.fixture(scope="module")
def solved(robot):
    """At adversarial states: state, targets, rows, what solves them."""
    rows, state = TaskRows(robot.free, SETTINGS), SpaceState(robot.free)
    solver = MotionSolver(rows, weights(rows), STANDING)

    def at(q, v, targets):
        state.at(q, v)
        A, b = rows.write(state, targets)
        solver.factorise(rows.write(state, targets), state, targets.stance)
        return state, targets.stance, A, b, solver

    return [lambda case=case: at(*case) for case in adversarial(robot, 12, seed=1)]


# ---------------------------------------------------------------------- motions
def test_the_motion_meets_every_row(solved):
    for case in solved:
        _, _, A, b, solver = case()
        x = solver.meeting_all().x
        assert A.shape == (len(x), len(x))  # as many rows as unknowns
        assert_close(A @ x, b, EXACT, floor=float(np.max(np.abs(A) @ np.abs(x))))
        assert_close(x, np.linalg.solve(A, b), SAME)


def test_columns_are_what_a_missed_row_changes(solved, robot):
    """A right-hand side moved by one over the row's weight, and solved again: asked-for rows, then standing."""
    worth = weights(TaskRows(robot.free, SETTINGS))
    for case in solved:
        state, stance, A, _, solver = case()
        missing = solver.missing()
        moved = np.zeros((len(A), len(worth) + BASE))
        moved[NATURE:, : len(worth)] = np.diag(1.0 / worth)
        moved[BASE:NATURE, len(worth) :] = np.eye(BASE) / STANDING
        expected = np.linalg.solve(A, moved)
        nv = robot.free.model.nv
        assert_close(missing.x, expected, SAME)
        motion = solver.meeting_all()
        torques = [_torques(robot, state, stance, motion.x + column) - motion.tau for column in missing.x.T]
        assert_close(missing.tau.T, torques, EXACT, floor=float(np.abs(state.M @ missing.x[:nv]).max()))


def _torques(robot, state, stance, x):
    """(n,) by recursive Newton-Euler, rotors beside, the wrench put on the foot's body."""
    model, nv = robot.free.model.copy(), robot.free.model.nv
    model.armature = np.zeros(nv)  # this Pinocchio adds it, others do not
    data = model.createData()
    dv, wrench = x[:nv], x[nv:]
    pin.forwardKinematics(model, data, state.q)
    frame = robot.free.sole_frame(stance)
    placement = pin.updateFramePlacement(model, data, frame)
    local = pin.Force(placement.rotation.T @ wrench[:3], placement.rotation.T @ wrench[3:])
    forces = pin.StdVec_Force()
    for _ in range(model.njoints):
        forces.append(pin.Force.Zero())
    forces[model.frames[frame].parentJoint] = model.frames[frame].placement.act(local)
    return pin.rnea(model, data, state.q, state.v, dv, forces)[BASE:] + robot.free.armature * dv[BASE:]


def test_torques_are_those_of_inverse_dynamics(solved, robot):
    for case in solved:
        state, stance, _, _, solver = case()
        motion = solver.meeting_all()
        floor = float(np.abs(state.M @ motion.x[: robot.free.model.nv]).max())
        assert_close(motion.tau, _torques(robot, state, stance, motion.x), EXACT, floor=floor)


def test_rows_that_contradict_each_other_are_noticed(talos):
    """Straight knees: no joint rate changes the length of a leg."""
    rows, state = TaskRows(talos.free, SETTINGS), SpaceState(talos.free)
    solver = MotionSolver(rows, weights(rows), STANDING)
    written = rows.write(state.at(talos.free.posture, talos.still), talos.standing())
    written.A[NATURE + LENGTHS.start] = 0.0
    with pytest.raises(SingularRowsError, match="contradict"):
        solver.factorise(written, state, Stance.LEFT)


# ---------------------------------------------------------------------- what the rows say
@pytest.mark.parametrize("stance", Stance)
def test_what_the_motion_does(robot, stance):
    """Read off the motion itself: base without a force of its own, foot at rest, FRI, pressure and joints as asked."""
    rows, state = TaskRows(robot.free, SETTINGS), SpaceState(robot.free)
    solver, nv = MotionSolver(rows, weights(rows), STANDING), robot.free.model.nv
    rng = np.random.default_rng(2)
    q = pin.integrate(robot.free.model, robot.free.posture, 0.02 * rng.normal(size=nv))
    v = 0.2 * rng.normal(size=nv)
    targets = robot.standing(stance, p_fri=0.01, cop_x=0.02)
    state.at(q, v)
    solver.factorise(rows.write(state, targets), state, stance)
    x = solver.meeting_all().x
    dv, (*_, F_z, M_x, M_y, _) = x[:nv], x[nv:]
    foot = state.feet[stance]
    np.testing.assert_allclose(
        foot.J @ dv + foot.drift, -SETTINGS.stance * foot.velocity, atol=SAME * np.abs(foot.drift).max()
    )
    # a positive FRI is towards the other foot: to the right of the left one
    assert -stance.sign * M_x / F_z == pytest.approx(targets.frontal.p_fri, abs=SAME)
    assert -M_y / F_z == pytest.approx(targets.cop_x, abs=SAME)
    for side in Stance:  # critically damped
        leg = state.legs[side]
        error, rate = leg.values[LENGTH] - state.lengths[side], leg.rates[LENGTH]
        wanted = -(SETTINGS.length**2) * error - 2.0 * SETTINGS.length * rate
        assert leg.J[LENGTH] @ dv + leg.drift[LENGTH] == pytest.approx(wanted, rel=SAME, abs=SAME)
    out = BASE + rows.outside
    wanted = -(SETTINGS.posture**2) * (q[out + 1] - robot.free.posture[out + 1]) - 2.0 * SETTINGS.posture * v[out]
    assert_close(dv[out], wanted, EXACT)


def test_the_softness_leaves_lengths_and_posture_firm(talos):
    """After a landing all feedback is soft but that of the lengths, by the setting, and of the joints outside."""
    rng = np.random.default_rng(3)
    q = pin.integrate(talos.free.model, talos.free.posture, 0.02 * rng.normal(size=talos.free.model.nv))
    state = SpaceState(talos.free).at(q, talos.still)
    rows = TaskRows(talos.free, SETTINGS)
    firm = rows.write(state, talos.standing()).b[NATURE:].copy()
    soft = rows.write(state, talos.standing(softness=0.25)).b[NATURE:].copy()
    share = np.divide(soft, firm, out=np.ones_like(firm), where=np.abs(firm) > 1e-12)
    reduced = np.r_[7:9, 10:12]  # pitch and yaw of pelvis and swing foot; outputs and swing come softened
    np.testing.assert_allclose(share[reduced], 0.25)
    np.testing.assert_allclose(np.delete(share, reduced), 1.0)


def test_what_is_worth_most(talos):
    rows = TaskRows(talos.free, SETTINGS)
    worth = weights(rows)
    assert worth.shape == (LEGS + len(rows.outside),)
    assert min(worth[OUTPUTS].min(), worth[FRI], worth[LENGTHS].min()) == 1.0
    assert worth[LEGS:].max() < 0.1 * worth[:LEGS].min() < worth[COP]


def test_a_leg_of_five_joints_is_refused(monkeypatch):
    free = FreeRobot(load_robot("talos_full").robot)
    monkeypatch.setattr(FreeRobot, "leg", lambda self, side: (0, 1, 2, 3, 4))
    with pytest.raises(RobotError, match=r"left leg has 5 joints .* needs six: hip yaw"):
        TaskRows(free, SETTINGS)
