"""Walkers in closed form as limits of the biped: A-frame rocker, rocking block, inverted pendulum.

A biped with its mass in the pelvis, legs and feet a share eps of it, joints held by constant virtual constraints, rocks
on its ankles like a rigid A: published_numbers rows 6 and 7 (rimless wheel), 12 (Housner's block), 13 (LIP).
"""

from math import comb

import numpy as np
import pytest
from robot_files import write_robot
from scipy.optimize import brentq

from frontal_biped.model import load_robot
from frontal_biped.virtual_constraints import Phase, double_support_pose
from frontal_biped.virtual_constraints.phase import StepPhase
from frontal_biped.zero_dynamics.energy import phase_energy
from frontal_biped.zero_dynamics.orbit import phase_orbit
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics, step_orbit

GRAVITY = 9.81
CLOSED = 1e-9  # relative, where the closed form is exact up to the light legs
HIPS = 0.2  # [m] between the hips
ANKLE_ANGLES = (-0.5 * np.pi - 0.1, -0.5 * np.pi + 0.1)  # [rad] where the level pendulum is searched ...
HIP_ANGLES = (-0.5 * np.pi - 0.3, -0.5 * np.pi + 0.3)  # [rad] ... and the pelvis angle that keeps it level


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
        orbit = phase_orbit(robot, rising, StepPhase.RISING, 24)
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
        orbit = phase_orbit(robot, rising, StepPhase.RISING, 24)
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


def level_pendulum(robot, height, swing_pose, start, end):
    """Virtual constraints that keep the mass at a height while it moves over the ankle: the pelvis rolls for that.

    Between two distances of the mass from the ankle [m]; returns the phase, whose reversal is at ``end``.
    """

    def pose(beta):
        def off(hip):
            return robot.com(np.array([beta, hip, *swing_pose]))[1] - height

        return np.array([brentq(off, *HIP_ANGLES, xtol=1e-15), *swing_pose])

    def beta_at(distance):
        return brentq(lambda beta: robot.com(np.array([beta, *pose(beta)]))[0] - distance, *ANKLE_ANGLES, xtol=1e-15)

    ends = beta_at(start), beta_at(end)
    s = 0.5 - 0.5 * np.cos(np.pi * (np.arange(7) + 0.5) / 7)  # Chebyshev points of [0, 1]
    joints = np.array([pose(beta) for beta in ends[0] + s * (ends[1] - ends[0])])
    basis = np.array([[comb(6, k) * x**k * (1.0 - x) ** (6 - k) for k in range(7)] for x in s])
    return Phase(*ends, np.linalg.solve(basis, joints).T, np.zeros(3))


def test_published_orbit_of_the_inverted_pendulum(tmp_path):
    """Row 13, its printed digits: z = 0.9, T = 0.5, W = 0.2; a mass that is kept at one height obeys it at any angle.

    From the distance of the reversal, 0.0735074, follow the duration of half a step, the speed at its end, -0.2238383,
    and the growth 5.2109 of x + v / omega over a step, each as good as the last digit printed.
    """
    leg = 0.9
    robot = a_frame(tmp_path, 1e-11, leg=leg)
    upright = double_support_pose(robot, -0.5 * np.pi, HIPS)
    half, reversal, digit = 0.5 * HIPS, 0.0735074, 0.5e-7
    phase = level_pendulum(robot, leg, upright[2:], half, reversal)
    orbit = phase_orbit(robot, phase, StepPhase.RISING, 24)
    heights = np.array([robot.com(q)[1] for q in orbit.motion.q])
    assert heights == pytest.approx(leg, abs=CLOSED)
    omega = np.sqrt(GRAVITY / leg)
    speed = float(robot.com_velocity(orbit.motion.q[-1], orbit.motion.dq[-1] * orbit.dbeta[-1])[0])
    # v^2 = omega^2 (x^2 - x_min^2) and x_min = x / cosh(omega t): what half a digit of x_min makes of either
    assert speed == pytest.approx(-0.2238383, abs=digit + digit * omega**2 * reversal / 0.2238383)
    assert 2.0 * orbit.duration == pytest.approx(0.5, abs=2.0 * digit * omega * half / (reversal * 0.2238383))
    assert (half - speed / omega) / (half + speed / omega) == pytest.approx(5.2109, abs=0.5e-4)
