"""What the ground must hold: the orbits of the stored gaits in space, and the law of friction below the sole."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from held_robot import Standing
from hypothesis import given
from hypothesis import strategies as st
from random_states import assert_close
from robot_laws import tolerance

from frontal_biped.gait import GaitSpecification, check_constraints
from frontal_biped.gait.file import load_gait
from frontal_biped.gait.holding_wrench import HoldingWrench, step_holding
from frontal_biped.model import FrontalBiped, Stance, State, load_robot, models_dir
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.plane_masses import F_H, F_V, N_0, S_H, S_V, PlaneMasses
from frontal_biped.model.space.virtual_legs import LENGTH, PITCH, YAW, SpaceState, X
from frontal_biped.simulation.space.start import start_in_space
from frontal_biped.zero_dynamics.orbit import resample

PUBLISHED = {
    "talos_full": ((0.007, 0.008), (0.3, 3.2), 0.004),
    "romeo": ((0.021, 0.022), (-3.8, -1.7), 0.011),
    "g1": ((0.077, 0.079), (-11.1, -0.8), 0.032),
    "icub": ((0.006, 0.006), (-0.4, 0.1), 0.002),
    "alexander": ((0.034, 0.038), (-3.4, 9.0), 0.016),
    "human": ((0.004, 0.004), (-0.8, 0.6), 0.001),
    "simple_humanoid_classical": ((0.031, 0.032), (-8.5, -5.9), 0.007),
}
"""Found by other code on the same gaits, left stance: range of the centre of pressure ahead of the ankle [m], of the
yaw moment about the ankle [N m], and the largest size of that over F_v [m]."""

DIGIT = {"x": 6e-4, "moment": 6e-2, "arm": 6e-4}
"""Half of the last digit printed above, and a little for its grid of points."""

SAME = 1e-9
"""Relative, of the weight and the weight at an arm of 1 m; icub's URDF is rounded."""

AVERAGED_AWAY = {"human": 4.1e-3, "romeo": 1e-12}
"""How far sideways of the FRI target legs as they are put the centre of pressure [m], where it is not below 5e-4: the
planar model moves the centre of mass of an asymmetric trunk to the middle, and romeo's legs are equal."""

DIFFERENCES = np.arange(-4, 5)
"""Stencil of a derivative of order 8."""


@pytest.fixture(scope="module", params=PUBLISHED)
def walker(request):
    robot = load_robot(request.param)
    gait = load_gait(models_dir() / f"{robot.name}.gait.json")
    return robot, gait, gait.step(robot)


@pytest.fixture(scope="module")
def talos() -> FrontalBiped:
    return load_robot("talos_full")


# ---------------------------------------------------------------------- along the orbit
def test_published_ranges(walker):
    robot, _, step = walker
    left = [phase[0] for phase in step_holding(robot, step)]
    (low, high), (least, most), arm = PUBLISHED[robot.name]
    x, moment = (np.concatenate([getattr(at, name) for at in left]) for name in ("cop_x", "yaw_moment_at_ankle"))
    F_v = np.concatenate([at.rows[F_V] for at in left])
    assert [x.min(), x.max()] == pytest.approx([low, high], abs=DIGIT["x"])
    assert [moment.min(), moment.max()] == pytest.approx([least, most], abs=DIGIT["moment"])
    assert np.max(np.abs(moment / F_v)) == pytest.approx(arm, abs=DIGIT["arm"])


def test_inverse_dynamics_in_space_along_the_orbit(walker):
    robot, _, step = walker
    within = max(SAME, tolerance(robot))
    for stance in Stance:
        standing = Standing(robot, stance)
        for orbit, wrenches in zip(step[:2], step_holding(robot, step), strict=True):
            (held,) = (wrench for wrench in wrenches if wrench.sole.side is stance)
            for i in range(0, len(orbit.tau), 3):
                q, slope, bend = (part[i] for part in orbit.motion[:3])
                dq, ddq = slope * orbit.dbeta[i], bend * orbit.dbeta[i] ** 2 + slope * orbit.ddbeta[i]
                assert_close(held.wrench[:, i], standing.wrench(q, dq, ddq), within, floor=robot.weight)


def test_momentum_in_space_changes_by_the_wrench(walker):
    """No acceleration enters here: momenta beside a point of the orbit, over the time that passes between them."""
    robot, gait, step = walker
    weights = np.linalg.solve(np.vander(DIFFERENCES, increasing=True).T.astype(float), np.eye(9)[1])
    width, middle = 4e-3, 0.6
    for stance in Stance:
        standing = Standing(robot, stance)
        for phase, orbit in ((gait.rising, step.rising), (gait.falling, step.falling)):
            beside = resample(robot, phase, orbit, middle + width * DIFFERENCES)
            at = [standing.momentum(q, dq * rate) for q, dq, rate in zip(*beside.motion[:2], beside.dbeta, strict=True)]
            # the rising phase comes down in tau as time goes on
            dtau_dt = -orbit.kind.sign / beside.time_density[4]
            rate = weights @ np.array(at) / width * dtau_dt
            q, slope, bend = (part[4:5] for part in beside.motion[:3])
            rows = PlaneMasses.of(robot, stance).along(q, slope, bend).at(beside.ddbeta[4:5], beside.dbeta[4:5] ** 2)
            (sole,) = (sole for sole in robot.robot.soles if sole.side is stance)
            ground = HoldingWrench(sole, rows).wrench[:, 0]
            within = max(SAME, tolerance(robot))
            assert_close(ground + standing.weight(q[0]), rate, within, floor=robot.weight)


def test_affine_in_zeta(walker):
    """At any energy, not only on the periodic orbit: three of them lie on a line, as the planar forces do."""
    robot, gait, _ = walker
    step = gait.step(robot, 8)
    orbit = step.falling
    dynamics = PlaneMasses.of(robot, Stance.LEFT).along(*orbit.motion[:3])

    def rows(zeta: float):
        squared = np.full(8, 2.0 * zeta) / orbit.restricted.I_P**2
        return dynamics.at(orbit.restricted.acceleration(squared), squared)

    start, middle, end = rows(0.0), rows(5.0), rows(10.0)
    assert_close(middle - start, end - middle, 1e-12, floor=robot.weight)
    assert np.max(np.abs(end - start)) > 0.1


def test_legs_that_differ_hold_nearly_mirrored_wrenches(walker):
    """The planar model has the mean of both legs; each leg as it is differs little."""
    robot, _, step = walker
    for orbit, (left, right) in zip(step[:2], step_holding(robot, step), strict=True):
        assert np.max(np.abs(left.cop_x - right.cop_x)) < 5e-4
        assert np.max(np.abs(left.yaw_moment + right.yaw_moment)) < 0.1
        for held in (left, right):
            sideways = np.max(np.abs(held.cop_h - orbit.restricted.p_fri))
            assert sideways < AVERAGED_AWAY.get(robot.name, 5e-4)


def free_wrench(space, stance, q, v, wanted):
    """(6,) wrench of the ground on the sole of a free robot whose virtual angles accelerate by ``wanted`` (4,)."""
    at, nv = space.at(q, v), space.free.model.nv
    stands, swings, seen = at.feet[stance], at.feet[stance.other], at.frontal(stance)
    R = pin.Quaternion(q[3:7]).matrix()
    root_x = np.concatenate([R[X], np.zeros(nv - 3)])[None], [(R @ np.cross(v[3:6], v[:3]))[X]]
    held = [(seen.J, seen.drift), (stands.J, stands.drift), root_x]
    held += [(swings.turning.J[[PITCH, YAW]], swings.turning.drift[[PITCH, YAW]]), (swings.J[[X]], swings.drift[[X]])]
    held += [(at.pelvis.J[[PITCH, YAW]], at.pelvis.drift[[PITCH, YAW]])]
    held += [(at.legs[side].J[[LENGTH]], at.legs[side].drift[[LENGTH]]) for side in Stance]
    legs = [*range(BASE), *(BASE + joint for side in Stance for joint in space.free.leg(side))]
    J, drift = np.vstack([part[0] for part in held])[:, legs], np.concatenate([part[1] for part in held])
    a = np.zeros(nv)
    a[legs] = np.linalg.lstsq(J, np.concatenate([wanted, np.zeros(len(drift) - 4)]) - drift)[0]
    base = pin.rnea(space.free.model, space.free.model.createData(), q, v, a)[:BASE]
    force, moment = R @ base[:3], R @ base[3:]
    return np.concatenate([force, moment + np.cross(q[:3] - stands.position, force)])


@pytest.mark.parametrize(
    ("name", "within"),
    [("talos_full", 0.0), ("romeo_bent", 0.0), ("icub_bent", 2e-5), ("g1_bent", 1e-2)],
)
def test_free_robot_that_keeps_its_virtual_legs(name, within):
    """Every joint is free and does what keeps lengths, feet and pelvis: the planar motion, and its holding wrench.

    With roll joints about X that is exact; in virtual legs of another order the hips' links move a little otherwise.
    """
    robot = load_robot(name)
    gait = load_gait(models_dir() / f"{name}.gait.json")
    step = gait.step(robot)
    free = FreeRobot(robot.robot)
    space = SpaceState(free)
    for stance in Stance:
        for orbit, wrenches in zip(step[:2], step_holding(robot, step), strict=True):
            (held,) = (wrench for wrench in wrenches if wrench.sole.side is stance)
            for i in range(0, len(orbit.tau), 6):
                at, slope, bend = (part[i] for part in orbit.motion[:3])
                dq, ddq = slope * orbit.dbeta[i], bend * orbit.dbeta[i] ** 2 + slope * orbit.ddbeta[i]
                q, v = start_in_space(free, robot, State(at, dq), stance, space)
                found = free_wrench(space, stance, q, v, ddq)
                assert_close(held.wrench[:, i], found, max(within, SAME), floor=robot.weight)


# ---------------------------------------------------------------------- what a sole holds
extents = st.floats(0.01, 0.2)
shares = st.floats(0.0, 1.0)


def test_force_on_a_sole(talos):
    """Places and moments of one force at one point, written out."""
    left, right = talos.robot.soles
    x, y, F = 0.03, -0.01, np.array([0.0, 50.0, 800.0])
    moment = np.cross([x, y, 0.0], F) + np.array([0.0, 0.0, 7.0])
    for sole, side in ((left, 1.0), (right, -1.0)):
        held = HoldingWrench(sole, np.array([-side * F[1], F[2], -side * moment[0], -side * moment[2], -moment[1]])[
            [F_H, F_V, N_0, S_H, S_V], None
        ])  # fmt: skip
        np.testing.assert_allclose(held.wrench[:, 0], [*F, *moment], atol=1e-12)
        np.testing.assert_allclose([held.cop_x[0], held.cop_h[0]], [x, -side * y], atol=1e-12)
        np.testing.assert_allclose(held.yaw_moment, 7.0, atol=1e-12)


@given(X=extents, Y=extents, share=shares, angle=st.floats(0.0, 6.28))
def test_traction_field_holds_what_is_said(X, Y, share, angle):
    """The field of the derivation, summed over the rectangle: within the cone everywhere, force and moment as said."""
    mu, p, n = 0.6, 1.0, 60
    at = (np.arange(n) + 0.5) / n * 2.0 - 1.0
    x, y = np.meshgrid(X * at, Y * at)
    area = 4.0 * X * Y / n**2
    distance = np.hypot(x, y)
    along = np.array([np.cos(angle), np.sin(angle)])[:, None, None]
    traction = mu * p * (share * along + (1.0 - share) * np.array([-y, x]) / distance)
    assert np.max(np.hypot(*traction)) <= mu * p * (1.0 + 1e-12)
    force, normal = traction.sum(axis=(1, 2)) * area, 4.0 * X * Y * p
    moment = float(np.sum(x * traction[1] - y * traction[0]) * area)
    assert np.hypot(*force) == pytest.approx(share * mu * normal, abs=1e-9 * normal)
    # the arm that is taken is not above what the field has, and not far below
    arm = 0.5 * np.hypot(X, Y)
    assert moment >= (1.0 - share) * mu * normal * arm * (1.0 - 1e-3)
    assert moment <= (1.0 - share) * mu * normal * arm * 1.083


@given(
    x=st.floats(-0.1, 0.09), y=st.floats(-0.06, 0.06), F_h=st.floats(-300.0, 300.0), moment=st.floats(-40.0, 40.0),
    stance=st.sampled_from(Stance),
)  # fmt: skip
def test_inside_the_wrench_cone_of_a_rectangle(talos, x, y, F_h, moment, stance):
    """Caron, Pham and Nakamura 2015, about the middle of the sole: what we say is held, their cone holds as well."""
    (sole,) = (sole for sole in talos.robot.soles if sole.side is stance)
    F_v = talos.weight
    rows = np.array([F_h, F_v, y * F_v, moment + x * F_h, x * F_v])[[F_H, F_V, N_0, S_H, S_V], None]
    held = HoldingWrench(sole, rows)
    mu = float(np.max(np.abs(held.friction)))
    X, Y = 0.5 * sole.length, 0.5 * sole.width
    centre = np.array([0.5 * (sole.front - sole.back), -0.5 * sole.side.sign * (sole.inner - sole.outer), 0.0])
    f, tau = held.wrench[:3, 0], held.wrench[3:, 0] - np.cross(centre, held.wrench[:3, 0])
    slack = 1e-9 * F_v
    assert abs(f[1]) <= mu * f[2] + slack and abs(tau[0]) <= Y * f[2] + slack and abs(tau[1]) <= X * f[2] + slack
    least = -mu * (X + Y) * f[2] + abs(Y * f[0] - mu * tau[0]) + abs(X * f[1] - mu * tau[1])
    most = mu * (X + Y) * f[2] - abs(Y * f[0] + mu * tau[0]) - abs(X * f[1] + mu * tau[1])
    assert least - slack <= tau[2] <= most + slack


# ---------------------------------------------------------------------- rows of a report
def test_rows_are_added_where_asked_for(walker):
    robot, gait, step = walker
    plain = check_constraints(robot, gait.specification, gait.rising, gait.falling, step)
    asked = replace(gait.specification, cop_margin_x=0.01, yaw_friction=0.7)
    full = check_constraints(robot, asked, gait.rising, gait.falling, step)
    assert tuple(check for check in full.checks if check.code not in ("cop_margin_x", "yaw_friction")) == plain.checks
    new = {check.name: check for check in full.checks if check not in plain.checks}
    assert len(new) == 4
    soles = robot.robot.soles
    for k, phase in enumerate(("rising", "falling")):
        fore_aft, friction = new[f"CoP ahead of the ankle, {phase}"], new[f"F_h and yaw moment, over F_v, {phase}"]
        wrenches = step_holding(robot, step)[k]
        room = min(
            float(np.min(np.minimum(s.front - w.cop_x, s.back + w.cop_x))) for s, w in zip(soles, wrenches, strict=True)
        )
        # a dense grid against the quadrature's nodes
        assert fore_aft.margin == pytest.approx(room - 0.01, abs=1e-4)
        assert friction.margin == pytest.approx(0.7 - np.max(np.abs([w.friction for w in wrenches])), abs=5e-3)
        assert fore_aft.satisfied and friction.satisfied == (friction.margin >= 0.0)


def test_either_key_brings_the_centre_of_pressure(talos):
    gait = load_gait(models_dir() / "talos_full.gait.json")
    for asked, codes in (
        ({"cop_margin_x": 0.02}, ["cop_margin_x"] * 2),
        ({"yaw_friction": 0.6}, ["cop_margin_x"] * 2 + ["yaw_friction"] * 2),
    ):
        spec = replace(gait.specification, **asked)
        report = check_constraints(talos, spec, gait.rising, gait.falling, gait.step(talos))
        assert [check.code for check in report.checks if check.code in ("cop_margin_x", "yaw_friction")] == codes


def test_a_sole_too_short_is_told(talos):
    gait = load_gait(models_dir() / "talos_full.gait.json")
    spec = replace(gait.specification, cop_margin_x=0.095)
    report = check_constraints(talos, spec, gait.rising, gait.falling, gait.step(talos))
    assert {check.code for check in report.violated} == {"cop_margin_x"}
    assert "CoP ahead of the ankle" in str(report)


def test_existing_specifications_ask_for_nothing():
    assert not GaitSpecification().bounds_holding_wrench
    assert not {"cop_margin_x", "yaw_friction"} & set(GaitSpecification().as_dict())
