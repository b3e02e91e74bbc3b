"""Stance coordinates of a reading: the stance leg's absolute angle, whatever its foot does."""

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
    q = coordinates.positions_to_stance(reading.joint_positions, stance)
    q[0] = outwards * reading.base_roll + 2.0 * UPRIGHT - q.item(1)
    if reading.joint_velocities is None:
        return q, None
    dq = coordinates.velocities_to_stance(reading.joint_velocities, stance)
    dq[0] = outwards * reading.base_roll_rate - dq.item(1)
    return q, dq
