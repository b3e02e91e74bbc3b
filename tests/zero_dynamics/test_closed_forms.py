"""Walkers in closed form as limits of the biped: A-frame rocker, rocking block, inverted pendulum.

A biped with its mass in the pelvis, legs and feet a share eps of it, joints held by constant virtual constraints, rocks
on its ankles like a rigid A: published_numbers rows 6 and 7 (rimless wheel), 12 (Housner's block), 13 (LIP).
"""

import numpy as np
import pytest
from robot_files import write_robot

from frontal_biped.model import load_robot
from frontal_biped.virtual_constraints import Phase, double_support_pose
from frontal_biped.zero_dynamics.energy import phase_energy
from frontal_biped.zero_dynamics.orbit import phase_orbit
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics, step_orbit

GRAVITY = 9.81
CLOSED = 1e-9  # relative, where the closed form is exact up to the light legs
HIPS = 0.2  # [m] between the hips


def a_frame(folder, eps, leg=1.0, inertia=0.0, height=0.0):
    """A biped of mass 1 in the middle of its hip line, ``height`` above it, with light legs and feet."""
    parameters = {
        "W": HIPS, "L": leg, "tx": 0.5 * HIPS, "ty": height, "mt": 1.0, "Jt": max(inertia, eps),
        "ml": eps, "Jl": eps, "leg_lat": 0.0, "leg_com": 0.5 * leg, "mf": eps, "Jf": eps, "fx": 0.0, "fy": 0.0,
        "e_in": 0.05, "e_out": 0.05, "ha": 0.0,
    }  # fmt: skip
    folder.mkdir(parents=True, exist_ok=True)
    return load_robot(write_robot(folder, "a_frame", parameters))


def rocking(robot, width, sway):
    """Constant joints: both phases in the double support pose, reversing ``sway`` above it."""
    beta = -0.5 * np.pi - np.arcsin((width - HIPS) / (2.0 * robot.leg_length))
    pose = double_support_pose(robot, beta, width)
    joints = np.repeat(pose[1:, None], 5, axis=1)
    fri = np.zeros(3)
    return Phase(beta, beta + sway, joints, fri), Phase(beta + sway, beta, joints, fri), pose


def lean(robot, pose):
    """Distance of the mass from the stance ankle, and its angle from the vertical: r and alpha."""
    h, v = robot.com(pose)
    return float(np.hypot(h, v)), float(np.arctan2(h, v))


@pytest.mark.parametrize("width", [0.2, 0.4, 0.8])
def test_jump_at_impact_is_cos_2_alpha(tmp_path, width):
    """Row 6: delta_z = cos 2 alpha for a point mass; the legs' share eps shows at first order and no more."""
    errors = []
    for eps in (1e-4, 1e-5, 1e-6):
        robot = a_frame(tmp_path / f"{eps}", eps)
        rising, falling, pose = rocking(robot, width, 0.02)
        hzd = HybridZeroDynamics(robot, step_orbit(robot, rising, falling, width, 16))
        _, alpha = lean(robot, pose)
        errors.append(abs(hzd.delta_z + np.cos(2.0 * alpha)))
    rates = np.log10(np.array(errors[:-1]) / np.array(errors[1:]))
    assert rates == pytest.approx(1.0, abs=0.05)
    # the limit itself, by Richardson extrapolation
    assert abs((10.0 * errors[2] - errors[1]) / 9.0) < 1e-8


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_reversal_angle_is_the_energy_balance(tmp_path, share):
    """Row 7: cos theta_r = cos alpha + omega^2 r / (2 g), and the quadrature agrees with its inverse."""
    robot = a_frame(tmp_path, 1e-11)
    rising, _, pose = rocking(robot, 0.4, 0.02)
    r, alpha = lean(robot, pose)
    omega = share * np.sqrt(2.0 * GRAVITY / r * (1.0 - np.cos(alpha)))
    theta = np.arccos(np.cos(alpha) + omega**2 * r / (2.0 * GRAVITY))
    energy = phase_energy(robot, rising, rising.beta_start, rising.beta_start + alpha)
    reversal = energy.reversal(float(omega))
    # rising turns the mass from alpha towards the vertical
    assert alpha - (reversal - rising.beta_start) == pytest.approx(theta, rel=CLOSED)
    assert energy.speed(reversal) == pytest.approx(omega, rel=CLOSED)


def test_energy_ratio_of_the_rocking_block(tmp_path):
    """Row 12: (1 - 1.5 sin^2 alpha)^2 for a uniform block; alpha = atan(0.2): 0.88794."""
    leg, errors = 1.0, []
    for eps in (1e-4, 1e-5, 1e-6):
        robot = a_frame(tmp_path / f"{eps}", eps, leg=leg)
        r, alpha = lean(robot, rocking(robot, 0.4, 0.01)[2])
        robot = a_frame(tmp_path / f"block{eps}", eps, leg=leg, inertia=r**2 / 3.0)
        rising, falling, _ = rocking(robot, 0.4, 0.01)
        hzd = HybridZeroDynamics(robot, step_orbit(robot, rising, falling, 0.4, 16))
        errors.append(hzd.delta_z**2 - (1.0 - 1.5 * np.sin(alpha) ** 2) ** 2)
    rates = np.log10(np.array(errors[:-1]) / np.array(errors[1:]))
    assert rates == pytest.approx(1.0, abs=0.05)
    assert abs((10.0 * errors[2] - errors[1]) / 9.0) < 1e-8
    # the published digits are those of a block of slenderness 0.2
    assert (1.0 - 1.5 * np.sin(np.arctan(0.2)) ** 2) ** 2 == pytest.approx(0.88794, abs=1e-5)


def test_quarter_period_of_the_rocking_block_in_the_slender_limit(tmp_path):
    """Row 12: T/4 = acosh(1 / (1 - theta_0 / alpha)) / p, p^2 = 3 g / (4 R); the error falls with alpha^2."""
    errors, angles = [], []
    for leg in (1.0, 2.0, 4.0):
        robot = a_frame(tmp_path / f"probe{leg}", 1e-11, leg=leg)
        rising, _, pose = rocking(robot, HIPS, 0.01)
        R, alpha = lean(robot, pose)
        robot = a_frame(tmp_path / f"{leg}", 1e-11, leg=leg, inertia=R**2 / 3.0)
        sway = 0.5 * alpha  # the block rises by theta_0 = alpha / 2 from its flat stand
        rising, _, _ = rocking(robot, HIPS, sway)
        orbit = phase_orbit(robot, rising, +1, 24)
        p = np.sqrt(0.75 * GRAVITY / R)
        errors.append(abs(orbit.duration * p / np.arccosh(2.0) - 1.0))
        angles.append(alpha)
    rate = np.diff(np.log(errors)) / np.diff(np.log(angles))
    assert rate == pytest.approx(2.0, abs=0.1)
    assert errors[-1] < 1e-3


def test_inverted_pendulum_in_the_limit_of_small_angles(tmp_path):
    """Row 13: v_0 = omega_0 (W/2) tanh(omega_0 T/2), x_min = (W/2) / cosh(omega_0 T/2), to second order in W/z."""
    errors, slenderness = [], []
    for leg in (0.9, 1.8, 3.6):
        robot = a_frame(tmp_path / f"{leg}", 1e-11, leg=leg)
        _, _, pose = rocking(robot, HIPS, 0.01)
        _, alpha = lean(robot, pose)
        sway = 0.25 * alpha
        rising, _, _ = rocking(robot, HIPS, sway)
        orbit = phase_orbit(robot, rising, +1, 24)
        omega, half = np.sqrt(GRAVITY / robot.com(pose)[1]), 0.5 * HIPS
        T = 2.0 * orbit.duration
        v_0 = omega * half * np.tanh(0.5 * omega * T)
        x_min = half / np.cosh(0.5 * omega * T)
        at_reversal = robot.com(orbit.motion.q[0])[0]
        speed = abs(robot.com_velocity(orbit.motion.q[-1], orbit.motion.dq[-1] * orbit.dbeta[-1])[0])
        errors.append([abs(speed / v_0 - 1.0), abs(at_reversal / x_min - 1.0)])
        slenderness.append(alpha)
    rates = np.diff(np.log(errors), axis=0) / np.diff(np.log(slenderness))[:, None]
    assert rates == pytest.approx(2.0, abs=0.15)
    assert np.max(errors[-1]) < 1e-3


def test_published_orbit_of_the_inverted_pendulum():
    """The numbers of row 13 from its own formulas: z = 0.9, T = 0.5, W = 0.2."""
    omega = np.sqrt(GRAVITY / 0.9)
    assert omega == pytest.approx(3.3015148, abs=1e-7)
    assert -omega * 0.1 * np.tanh(0.25 * omega) == pytest.approx(-0.2238383, abs=1e-7)
    assert 0.1 / np.cosh(0.25 * omega) == pytest.approx(0.0735074, abs=1e-7)
    assert np.exp(0.5 * omega) == pytest.approx(5.2109, abs=1e-4)
