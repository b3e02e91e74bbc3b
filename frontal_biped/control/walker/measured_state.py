"""Stance coordinates of a reading: the stance leg's absolute angle, whatever its foot does."""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Reading
from frontal_biped.model.chain import UPRIGHT
from frontal_biped.model.stance_map import Stance, StanceMap


def measured_state(coordinates: StanceMap, reading: Reading, stance: Stance) -> tuple[FloatArray, FloatArray | None]:
    """q (4,) [rad] and dq (4,) [rad/s]; None where the reading tells no rates.

    Args:
        coordinates: of the robot.
        reading: joints and inertial unit.
        stance: the foot taken for the stance foot.
    """
    outwards = -stance.sign  # sense of +X in (h, v)
    # `StanceMap.positions_to_stance` and `velocities_to_stance` of all joints but the ankle, in plain numbers
    _, (a, sense_a, zero_a), (b, sense_b, zero_b), (c, sense_c, zero_c) = coordinates.chain[stance]
    at = reading.joint_positions.tolist()
    hip = UPRIGHT + sense_a * (at[a] - zero_a)
    leg = outwards * reading.base_roll + 2.0 * UPRIGHT - hip
    q = np.array((leg, hip, UPRIGHT + sense_b * (at[b] - zero_b), UPRIGHT + sense_c * (at[c] - zero_c)))
    if reading.joint_velocities is None:
        return q, None
    rates = reading.joint_velocities.tolist()
    hip_rate = sense_a * rates[a]
    leg_rate = outwards * reading.base_roll_rate - hip_rate
    return q, np.array((leg_rate, hip_rate, sense_b * rates[b], sense_c * rates[c]))
