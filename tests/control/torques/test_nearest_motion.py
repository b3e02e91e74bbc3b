"""The program solved in the residuals of its targets: against ProxQP, at and beyond the limits."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from random_states import assert_close, vectors

from frontal_biped.control import ControllerSettings, QpController, Source
from frontal_biped.control.settings import OUTPUTS
from frontal_biped.control.torques.linearisation import StanceModel
from frontal_biped.control.torques.relaxation import weights
from frontal_biped.control.torques.walking_qp import VARIABLES
from frontal_biped.model.state import State
from frontal_biped.virtual_constraints import StepPhase

SAME = 1e-7
"""Relative agreement with ProxQP, which is asked for 1e-9 of a gradient and refined on the rows it found active."""

LEAST = 1e-4
"""Relative agreement of the least overstepping; ProxQP is asked for 1e-6 there."""

BORDER = 2e-3
"""Share of the torque limits by which torques may change where limits begin to give way, over 1e-7 of the way there.

Far from zero for continuity's sake only: what satisfies all limits shrinks to a point there, in a direction along which
torques may change by 1e4 times what the state does. A jump would be of order one.
"""

SHIPPED = ("frontal_biped", "g1", "talos_full")
SETTINGS = {outputs: ControllerSettings(frequency=60.0, joint_rate=60.0, outputs=outputs) for outputs in OUTPUTS}


def state(gait, which, s, speed, y, dy):
    """Off the virtual constraints by y and dy, at a share ``speed`` of the gait's own."""
    phase = gait.rising if which is StepPhase.RISING else gait.falling
    beta = phase.beta_start + s * phase.range
    h_d, h_d1, *_ = phase.desired(beta)
    rate = speed * gait.orbit.beta_dot_after_impact
    return np.r_[beta, h_d + y], np.r_[rate, h_d1 * rate + dy]


off_the_gait = {
    "which": st.sampled_from(list(StepPhase)),
    "s": st.floats(0.0, 1.0),
    "speed": st.floats(-1.0, 1.0),
    "y": vectors(-0.03, 0.03, 3),
    "dy": vectors(-0.5, 0.5, 3),
}


def overstepping(controller, which, q, dq, command):
    """Weighted sum of the squares by which limits are overstepped, as `relaxation` weighs them."""
    qp = controller.program.qp
    at = State(q, dq)
    program = controller.program.pose(at, controller.targets(which, at)[0]).program
    x = np.zeros(len(program.g))
    x[:VARIABLES] = np.concatenate([command.ddq, command.u, command.force]) / qp.scale
    value = program.C @ x
    s = np.maximum(0.0, np.maximum(program.l - value, value - program.u))
    weight = weights(qp.rows)
    soft = np.isfinite(weight)
    return weight[soft] @ s[soft] ** 2


# ---------------------------------------------------------------------- against ProxQP
@pytest.mark.parametrize("outputs", OUTPUTS)
@pytest.mark.parametrize("name", SHIPPED)
@given(**off_the_gait)
def test_active_limits_as_proxqp_has_them(solvers, name, outputs, which, s, speed, y, dy):
    exact, always = solvers(name, SETTINGS[outputs])
    q, dq = state(exact.gait, which, s, speed, y, dy)
    found = exact.command(which, q, dq)
    assume(found.source is Source.PROGRAM)
    other = always.command(which, q, dq)
    assume(other.solved)  # ProxQP gives up on a few that have a solution
    lever = 0.1 * exact.biped.weight
    assert_close(found.u, other.u, SAME, floor=lever)
    assert_close(found.force, other.force, SAME, floor=exact.biped.weight)
    assert found.relaxation == pytest.approx(other.relaxation, rel=SAME, abs=1e-5)


@pytest.mark.parametrize("outputs", OUTPUTS)
@given(seed=st.integers(0, 2**32 - 1))
def test_limits_give_way_as_little_as_proxqp_has_them(solvers, outputs, seed):
    exact, always = solvers("frontal_biped", SETTINGS[outputs])
    rng = np.random.default_rng(seed)
    which = StepPhase(rng.choice(["rising", "falling"]))
    y, dy = 0.2 * rng.normal(size=3), 4.0 * rng.normal(size=3)
    q, dq = state(exact.gait, which, rng.uniform(), 3.0 * rng.normal(), y, dy)
    found = exact.command(which, q, dq)
    assume(found.source is Source.RELAXED)
    other = always.command(which, q, dq)
    least, theirs = (overstepping(exact, which, q, dq, command) for command in (found, other))
    assert least == pytest.approx(theirs, rel=LEAST, abs=LEAST)


# ---------------------------------------------------------------------- at the border
@pytest.mark.parametrize("outputs", OUTPUTS)
def test_torques_are_continuous_where_limits_begin_to_give_way(biped, reference_gait, outputs):
    """Along lines of states from solved to not: the last torques that keep the limits are the first that do not."""
    controller = QpController(biped, reference_gait, ControllerSettings(frequency=60.0, outputs=outputs))
    rng = np.random.default_rng(3)
    changes = []
    for _ in range(100):
        q, dq = state(reference_gait, StepPhase.RISING, rng.uniform(), 1.0, np.zeros(3), np.zeros(3))
        way, rates = 0.04 * rng.normal(size=4), 2.0 * rng.normal(size=4)

        def at(share, q=q, dq=dq, way=way, rates=rates):
            return controller.command(StepPhase.RISING, q + share * way, dq + share * rates)

        inside, outside = 0.0, 1.0
        if not at(inside).solved or at(outside).solved:
            continue
        while outside - inside > 1e-7:
            middle = 0.5 * (inside + outside)
            inside, outside = (middle, outside) if at(middle).solved else (inside, middle)
        before, after = at(inside), at(outside)
        assert (before.source, after.source) == (Source.PROGRAM, Source.RELAXED)
        changes.append(np.max(np.abs(before.u - after.u) / biped.max_torque))
    assert len(changes) >= 10
    assert max(changes) < BORDER


def test_where_the_decoupling_matrix_is_singular(biped, reference_gait):
    """C03: no torques reach the targets, and the residuals do not tell what the robot does; ProxQP is left."""
    controller = QpController(biped, reference_gait)
    q, dq = state = reference_gait.state_after_impact()
    targets = controller.targets(StepPhase.RISING, state)[0]
    momentum = StanceModel(biped).at(state).M[:, 3:] @ np.concatenate([[1.0], targets.h_d1])
    for nearly in (0.0, *(sign * 10.0**-k for sign in (1.0, -1.0) for k in range(6, 16))):
        p_fri = momentum[2] / momentum[1] + nearly
        answer = controller.program.solve(state, targets._replace(p_fri=p_fri))
        assert answer is not None
        F_h, F_v = answer.force
        N_0, (outer, inner) = biped.inverse_dynamics(q, dq, answer.ddq)[2], biped.sole
        assert answer.source is Source.PROGRAM
        assert abs(F_h) <= 0.6 * F_v * (1.0 + 1e-6)
        assert outer * F_v - 1e-4 <= N_0 <= inner * F_v + 1e-4
        assert np.all(np.abs(answer.u) <= biped.max_torque)
