"""Gains by which an estimate follows noisy readings: of a Kalman filter whose every coordinate is a triple integrator.

Position, rate and the acceleration that the model does not explain. The gains depend on nothing but the time since the
last impact, and are tabulated once.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from frontal_biped.arrays import FloatArray

TABULATED = 400
"""Readings after an impact for which gains are tabulated; they have settled by then."""


@dataclass(frozen=True)
class EstimatorSettings:
    """How much the estimator trusts what.

    Attributes:
        encoder_noise: standard deviation of a position reading [rad].
        velocity_noise: standard deviation of a velocity reading, where there are any [rad/s].
        impact_velocity: standard deviation of the velocities that the impact map predicts [rad/s].
        impact_acceleration: standard deviation of the acceleration error remembered from the last step [rad/s^2].
        drift: of the acceleration error, standard deviation after one second [rad/s^2].
        blind: time after an impact during which the readings are left aside, since the contact is still at work [s].
    """

    encoder_noise: float = 2e-4
    velocity_noise: float = 1e-3
    impact_velocity: float = 0.1
    impact_acceleration: float = 1.0
    drift: float = 2.0
    blind: float = 0.006


@lru_cache(maxsize=16)
def gain_table(settings: EstimatorSettings, period: float, velocities: bool) -> FloatArray:
    """(TABULATED, 3, 1 or 2) Kalman gains of position, rate and acceleration error after an impact.

    Of one joint, whose error is a triple integrator; rows q, dq, a, columns the readings of q (and dq). Every walker of
    the same settings has the same table, which is not to be changed.
    """
    h = period
    F = np.array([[1.0, h, 0.5 * h**2], [0.0, 1.0, h], [0.0, 0.0, 1.0]])
    # white noise on da/dt, integrated over a period
    Q = settings.drift**2 * np.array(
        [
            [h**5 / 20.0, h**4 / 8.0, h**3 / 6.0],
            [h**4 / 8.0, h**3 / 3.0, h**2 / 2.0],
            [h**3 / 6.0, h**2 / 2.0, h],
        ]
    )
    rows = 2 if velocities else 1
    H = np.eye(rows, 3)
    R = np.diag(np.array([settings.encoder_noise, settings.velocity_noise])[:rows] ** 2)
    P = np.diag([settings.encoder_noise, settings.impact_velocity, settings.impact_acceleration]) ** 2
    table = np.zeros((TABULATED, 3, rows))
    for k in range(TABULATED):
        if k:
            P = F @ P @ F.T + Q
        if k * h < settings.blind:
            continue
        K = P @ H.T @ np.linalg.inv(H @ P @ H.T + R)
        P = (np.eye(3) - K @ H) @ P
        table[k] = K
    table.setflags(write=False)
    return table


@lru_cache(maxsize=16)
def joint_gains(settings: tuple[EstimatorSettings, ...], period: float, velocities: bool) -> FloatArray:
    """(TABULATED, 3 n, n or 2 n) the gains of n joints, each with settings of its own, as one matrix a reading.

    It takes the readings of all q (and then of all dq) to the corrections of all q, dq, a: NumPy multiplies by it in
    less time than by a joint's gains one after another. Read-only, as `gain_table`.
    """
    n = len(settings)
    of_joint = np.stack([gain_table(one, period, velocities) for one in settings])
    table = np.zeros((TABULATED, 3, n, of_joint.shape[-1], n))
    each = np.arange(n)
    table[:, :, each, :, each] = of_joint
    table.setflags(write=False)
    return table.reshape(TABULATED, 3 * n, -1)
