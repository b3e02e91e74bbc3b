"""A humanoid in space on one foot, moving its four roll joints: an oracle that knows nothing of the plane.

The model hangs from its free-flying pelvis, as the URDF has it. Its motion is found from "the sole neither moves nor
accelerates", and the ground's wrench from Newton and Euler at the pelvis, carried to the sole by virtual power.
"""

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from frontal_biped.model import FrontalBiped, Stance

FloatArray = npt.NDArray[np.float64]

BASE = 6


class Standing:
    """A robot on one foot; the origin of world axes is that sole's, the point below the ankle."""

    def __init__(self, biped: FrontalBiped, stance: Stance) -> None:
        self.map, self.stance = biped.stance_map, stance
        self.model = biped.spatial_model.copy()
        data = self.model.createData()
        pin.forwardKinematics(self.model, data, biped.spatial_reference)
        ankle = self.model.getJointId(biped.description.joints[f"{stance.value}_ankle"])
        to_joint = data.oMi[ankle].rotation.T
        below = to_joint @ np.array([0.0, 0.0, -biped.ankle_height])
        self.sole = self.model.addFrame(pin.Frame("sole", ankle, pin.SE3(to_joint, below), pin.OP_FRAME))
        self.data = self.model.createData()
        self.reference = biped.spatial_reference
        self.columns = [self.model.joints[self.model.getJointId(name)] for name in self.map.joint_names]

    def motion(self, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Configuration, velocities and accelerations in space of stance coordinates (4,) and their derivatives."""
        model, data, frame = self.model, self.data, self.sole
        Q, v, a = self.reference.copy(), np.zeros(model.nv), np.zeros(model.nv)
        angles = self.map.positions_to_urdf(q, self.stance)
        rates, changes = (self.map.velocities_to_urdf(part, self.stance) for part in (dq, ddq))
        for joint, angle, rate, change in zip(self.columns, angles, rates, changes, strict=True):
            Q[joint.idx_q], v[joint.idx_v], a[joint.idx_v] = angle, rate, change
        pin.framesForwardKinematics(model, data, Q)
        root = data.oMf[frame].inverse() * data.oMi[1]
        Q[:3], Q[3:7] = root.translation, pin.Quaternion(root.rotation).coeffs()
        J = np.array(pin.computeFrameJacobian(model, data, Q, frame, pin.LOCAL))
        v[:BASE] = np.linalg.solve(J[:, :BASE], -J[:, BASE:] @ v[BASE:])
        pin.forwardKinematics(model, data, Q, v, np.zeros(model.nv))
        drift = pin.getFrameAcceleration(model, data, frame, pin.LOCAL).vector
        a[:BASE] = np.linalg.solve(J[:, :BASE], -drift - J[:, BASE:] @ a[BASE:])
        return Q, v, a

    def wrench(self, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> FloatArray:
        """(6,) force [N] and moment about the sole's origin [N m], world axes."""
        Q, v, a = self.motion(q, dq, ddq)
        pelvis = pin.rnea(self.model, self.data, Q, v, a)[:BASE]
        J = np.array(pin.computeFrameJacobian(self.model, self.data, Q, self.sole, pin.LOCAL))[:, :BASE]
        return np.linalg.solve(J.T, pelvis)

    def momentum(self, q: FloatArray, dq: FloatArray) -> FloatArray:
        """(6,) linear momentum [N s] and angular momentum about the sole's origin [N m s], rotors not counted."""
        Q, v, _ = self.motion(q, dq, np.zeros(4))
        central = pin.computeCentroidalMomentum(self.model, self.data, Q, v)
        return np.concatenate([central.linear, central.angular + np.cross(self.data.com[0], central.linear)])

    def weight(self, q: FloatArray) -> FloatArray:
        """(6,) wrench of gravity about the sole's origin."""
        Q, _, _ = self.motion(q, np.zeros(4), np.zeros(4))
        com = pin.centerOfMass(self.model, self.data, Q)
        force = pin.computeTotalMass(self.model) * self.model.gravity.linear
        return np.concatenate([force, np.cross(com, force)])
