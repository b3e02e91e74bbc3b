"""The energy of a step, in the plane and of the free robot: constant along a step, and the closed form's numbers."""

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped.control import ControllerSettings
from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions
from frontal_biped.gait import load_gait
from frontal_biped.model import Stance, State, load_robot, models_dir
from frontal_biped.model.chain import GRAVITY
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.simulation import SimulationSettings, simulate
from frontal_biped.simulation.space.start import start_in_space
from frontal_biped.virtual_constraints import StepPhase
from frontal_biped.zero_dynamics.frontal_energy import FrontalEnergy, angular_momentum
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics

SAME = 1e-9
"""Relative: quadrature from the reversal, and panels from the impact."""

WALKED = 1e-5
"""Relative: the full model under continuous control, integrated with the tolerances below."""

STRONG = {
    "simulation_settings": SimulationSettings(rtol=1e-9, atol=1e-11, record_rate=200.0),
    "controller_settings": ControllerSettings(friction=10.0, min_normal_force=1e-3, max_torque=(1e4,) * 4),
}
"""An accurate integration, and a robot that no motor and no ground keeps from its virtual constraints."""

EQUAL_LEGS = ("romeo", "romeo_bent")
"""Humanoids whose planar model is exact: nothing was averaged, and their roll joints are the planar robot's."""

AVERAGED = {"talos_full": 1e-3, "simple_humanoid_classical": 2e-3}
"""Others, and how far averaging their legs moves the energy of the step, over its own [-]."""


def energy_of(biped, gait):
    """With the rising phase that is followed to the barrier."""
    rising = ReanchoringTransitions(biped, gait).planned_rising
    return FrontalEnergy(biped, rising, gait.falling, gait.speed_after_impact)


@pytest.fixture(scope="module", params=["reference_gait", "level_gait"])
def case(request, biped):
    gait = request.getfixturevalue(request.param)
    return biped, gait, energy_of(biped, gait)


# ---------------------------------------------------------------------- in the plane
def test_constant_along_the_orbit(case):
    biped, gait, energy = case
    step = gait.step(biped)
    assert energy.orbit == pytest.approx(step.rising.zeta[-1], rel=SAME)
    for phase, orbit in ((StepPhase.RISING, step.rising), (StepPhase.FALLING, step.falling)):
        for beta, zeta in zip(orbit.beta, orbit.zeta, strict=True):
            read = energy.at(phase, float(beta), float(np.sqrt(2.0 * zeta)))
            assert read.energy == pytest.approx(energy.orbit, rel=SAME)
            assert read.next_energy == pytest.approx(energy.orbit, rel=SAME)
            assert read.barrier_margin == pytest.approx(energy.barrier / energy.orbit - 1.0, rel=1e-7)
            assert abs(read.error) < SAME


def test_next_step_is_the_poincare_map(case):
    """Its slope is the multiplier, and the orbit its fixed point."""
    biped, gait, energy = case
    start = gait.rising.beta_start

    def following(factor: float) -> float:
        return energy.at(StepPhase.RISING, start, float(np.sqrt(2.0 * factor * energy.orbit))).next_energy

    slope = (following(1.1) - following(0.9)) / (0.2 * energy.orbit)
    assert slope == pytest.approx(HybridZeroDynamics(biped, gait.step(biped)).multiplier, rel=1e-8)


@pytest.mark.parametrize(("error", "early"), [(0.05, WALKED), (-0.02, 5e-3)])
def test_constant_along_a_perturbed_walk(biped, level_gait, error, early):
    """The full model, re-anchored: each step's energy is known from any sample of it, and so is the next one's.

    A late reversal is retraced and costs nothing; an early one rejoins its path, which costs at second order.
    """
    energy = energy_of(biped, level_gait)
    run = simulate(biped, level_gait, steps=3, period=None, speed_error=error, stabiliser="re-anchored", **STRONG)
    assert not run.fell
    energies, following = [], []
    for step in range(3):
        rising = np.flatnonzero((run.step == step) & (run.phase > 0.0))
        states = zip(run.q[rising], run.dq[rising], run.p_fri[rising], strict=True)
        reads = [energy.at(StepPhase.RISING, float(q[0]), biped.sigma(q, dq, p)) for q, dq, p in states]
        values = np.array([read.energy for read in reads])
        np.testing.assert_allclose(values, values[0], rtol=WALKED)
        energies.append(values[0])
        following.append(reads[0].next_energy)
    assert energies[0] == pytest.approx(energy.orbit * (1.0 + error) ** 2, rel=WALKED)
    np.testing.assert_allclose(energies[1:], following[:-1], rtol=early)


def test_a_late_fall_is_led_back_over_the_reversal(case):
    """Above the planned reversal the falling phase retraces the rising one: the same numbers, other sense."""
    _, gait, energy = case
    beta, sigma = gait.beta_reversal + 0.2 * gait.rising.range, 3.0
    up, down = (energy.at(phase, beta, sigma) for phase in (StepPhase.RISING, StepPhase.FALLING))
    assert up.energy == down.energy > energy.orbit
    at, above = (energy.at(StepPhase.FALLING, gait.beta_reversal + d, sigma).energy for d in (-1e-9, 1e-9))
    assert at == pytest.approx(above, rel=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("factor", [0.98, 1.02])
def test_margin_tells_who_tips(biped, level_gait, factor):
    """An impact with a little more than the barrier takes the robot over; with a little less it comes back."""
    energy = energy_of(biped, level_gait)
    assert energy.reaches_barrier
    start, sigma = level_gait.rising.beta_start, float(np.sqrt(2.0 * factor * energy.barrier))
    read = energy.at(StepPhase.RISING, start, sigma)
    assert read.barrier_margin == pytest.approx((1.0 - factor) * energy.barrier / energy.orbit, rel=1e-9)
    error = float(np.sqrt(factor * energy.barrier / energy.orbit)) - 1.0
    run = simulate(biped, level_gait, steps=1, period=None, speed_error=error, stabiliser="re-anchored", **STRONG)
    turned = run.events("REVERSAL").size > 0
    assert turned == (read.barrier_margin > 0.0), run.outcome


def test_beyond_what_was_followed_nothing_is_said(case):
    _, gait, energy = case
    for beta in (gait.rising.beta_start - 1.0, gait.rising.beta_start + 3.0):
        read = energy.at(StepPhase.RISING, beta, 1.0)
        assert read.zeta == 0.5 and np.isnan(read.energy) and np.isnan(read.barrier_margin)


# ---------------------------------------------------------------------- in space
def humanoid(name):
    robot, gait = load_robot(name), load_gait(models_dir() / f"{name}.gait.json")
    free = FreeRobot(robot.robot)
    return robot, gait, SpaceState(free)


def embedded(robot, gait, space, stance, every=4):
    """Phase, orbit and node of states of the orbit, with the robot put there in space."""
    step = gait.step(robot)
    for phase, orbit in ((StepPhase.RISING, step.rising), (StepPhase.FALLING, step.falling)):
        for i in range(0, len(orbit.tau), every):
            state = State(orbit.motion.q[i], orbit.motion.dq[i] * orbit.dbeta[i])
            q, v = start_in_space(space.free, robot, state, stance, space)
            yield phase, orbit, i, space.at(q, v)


@pytest.mark.parametrize("stance", Stance)
@pytest.mark.parametrize("name", [*EQUAL_LEGS, *AVERAGED])
def test_planar_motion_in_space_has_the_planar_numbers(name, stance):
    robot, gait, space = humanoid(name)
    energy = energy_of(robot, gait)
    within = AVERAGED.get(name, SAME)
    for phase, orbit, i, at in embedded(robot, gait, space, stance):
        read = energy.in_space(at, stance, phase)
        assert read.beta == pytest.approx(orbit.beta[i], abs=1e-11)
        assert read.dbeta == pytest.approx(orbit.dbeta[i], abs=1e-9)
        assert read.sigma == pytest.approx(orbit.restricted.I_P[i] * orbit.dbeta[i], abs=within * np.sqrt(energy.orbit))
        assert read.zeta == pytest.approx(orbit.zeta[i], abs=within * energy.orbit)
        assert abs(read.error) < within
        assert read.next_energy == pytest.approx(energy.orbit, rel=within)


@pytest.fixture(scope="module", params=["talos_full", "g1_bent"])
def space(request):
    return humanoid(request.param)[2]


def random_states(space, seed, count=5):
    """Anywhere, leaning, all joints moving."""
    rng, free = np.random.default_rng(seed), space.free
    for _ in range(count):
        shift = np.concatenate([rng.uniform(-1.0, 1.0, 3), rng.uniform(-0.3, 0.3, free.model.nv - 3)])
        yield pin.integrate(free.model, free.posture, shift), rng.uniform(-1.0, 1.0, free.model.nv), rng


def test_angular_momentum_of_all_bodies(space):
    model, data = space.free.model, space.free.model.createData()
    for q, v, rng in random_states(space, 0):
        heading, p = rng.uniform(-3.0, 3.0), rng.uniform(-0.1, 0.1)
        central = pin.computeCentroidalMomentum(model, data, q, v)
        pin.framesForwardKinematics(model, data, q)
        for stance in Stance:
            forward = np.array([np.cos(heading), np.sin(heading), 0.0])
            inwards = -stance.sign * np.array([-forward[1], forward[0], 0.0])
            point = data.oMf[space.free.sole_frame(stance)].translation + p * inwards
            expected = -stance.sign * forward @ (central.angular + np.cross(data.com[0] - point, central.linear))
            found = angular_momentum(space.at(q, v, heading), stance, p)
            assert found == pytest.approx(expected, abs=1e-11 * space.free.mass)


def test_changes_by_the_moment_of_ground_and_weight(space):
    """Euler's law of the free robot: what the closed form's kappa_2 is made of, however the joints move.

    The ground's wrench is what inverse dynamics leaves to the base; nothing else pushes.
    """
    free = space.free
    model, data, step = free.model, free.model.createData(), 1e-6
    stance = Stance.RIGHT
    for q, v, rng in random_states(space, 1):
        a = rng.uniform(-5.0, 5.0, model.nv)
        point = space.at(q, v).feet[stance].position.copy()

        def sigma(t, q=q, v=v, a=a, point=point):
            moved = space.at(pin.integrate(model, q, v * t + 0.5 * a * t**2), v + a * t)
            # about the place where the foot was
            P = moved.M[:BASE] @ moved.v
            R = pin.Quaternion(moved.q[3:7]).matrix()
            at_foot = angular_momentum(moved, stance, 0.0)
            drift = moved.feet[stance].position - point
            return at_foot + stance.sign * -np.cross(drift, R @ P[:3])[0]

        rate = (sigma(step) - sigma(-step)) / (2.0 * step)
        wrench = pin.rnea(model, data, q, v, a)[:BASE]  # of the ground, on the base and in its axes
        R = pin.Quaternion(q[3:7]).matrix()
        force, moment = R @ wrench[:3], R @ wrench[3:]
        ground = -stance.sign * (moment + np.cross(q[:3] - point, force))[0]
        h = -stance.sign * (pin.centerOfMass(model, data, q) - point)[1]
        assert rate == pytest.approx(ground - free.mass * GRAVITY * h, abs=1e-5 * free.weight)
