"""Planar states in the room: X forward, Y left, Z up, the stance foot flat on z = 0 below its ankle."""

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance

ANKLE = {Stance.LEFT: 0, Stance.RIGHT: 3}
"""Index of each foot's ankle in `StanceMap.joint_names`."""


def standing_configurations(biped: FrontalBiped, q: FloatArray, stance: FloatArray, stance_y: FloatArray) -> FloatArray:
    """(T, nq) configurations of ``biped.spatial_model``, free-flyer (xyz, quaternion xyzw) and roll joints.

    Args:
        biped: the robot.
        q: (T, 4) stance coordinates [rad].
        stance: (T,) +1 left, -1 right.
        stance_y: (T,) where the stance ankle is on the y axis [m].
    """
    model, chart = biped.spatial_model, biped.stance_map
    data = model.createData()
    reference = biped.spatial_reference
    pin.forwardKinematics(model, data, reference)
    ankle_id = {foot: model.getJointId(chart.joint_names[row]) for foot, row in ANKLE.items()}
    ankle_at_reference = {foot: data.oMi[joint].copy() for foot, joint in ankle_id.items()}
    address = [model.joints[model.getJointId(name)].idx_q for name in chart.joint_names]

    configurations = np.tile(reference, (len(q), 1))
    for row, angles, sign, y in zip(configurations, q, stance, stance_y, strict=True):
        foot = Stance.of_sign(sign)
        row[address] = chart.positions_to_urdf(angles, foot)
        pin.forwardKinematics(model, data, row)
        wanted = ankle_at_reference[foot].copy()
        wanted.translation = np.array([wanted.translation[0], y, biped.ankle_height])
        root = data.oMi[1]
        row[:7] = pin.SE3ToXYZQUAT(wanted * data.oMi[ankle_id[foot]].inverse() * root)
    return configurations
