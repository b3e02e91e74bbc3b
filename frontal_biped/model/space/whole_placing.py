r"""From motions in the frontal plane to motions of the whole robot.

With the axes of the roll joints along X nothing else moves: the four joints turn, every other joint stays at the
posture. With virtual legs the joints of both legs make the planar robot's turns (`planar_state`). Either way the stance
foot lies flat and at rest on z = 0, and position, velocity and acceleration belong together; so inverse dynamics

.. math:: M \dot v + h = S^T \tau + J^T w

has one solution: six rows of the base give the wrench w on the stance sole, the rest the torques. Joints that are held
have one too. At the four roll joints of a robot whose axes are along X the torques are not these but the planar run's
own, in URDF coordinates; the two agree to rounding where the legs of the URDF are equal and nothing else acts on the
robot.
"""

from typing import NamedTuple, Protocol

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError, UnreachablePoseError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.joint_arrays import ROOT
from frontal_biped.model.space.planar_state import PlanarStates
from frontal_biped.model.space.standing import ANKLE, standing_configurations
from frontal_biped.model.space.whole_motion import WholeMotion, one_freedom
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State


class PlanarSamples(NamedTuple):
    """Samples of a motion in the frontal plane.

    Attributes:
        t: (T,) [s].
        q: (T, 4) stance coordinates [rad].
        dq: (T, 4) [rad/s].
        u: (T, 4) torques [N m].
        phase: (T,) +1 rising, -1 falling.
        stance: (T,) +1 left, -1 right.
        stance_y: (T,) world y of the stance ankle [m].
        step: (T,) index of the step.
        bears: (T,) 1 where the stance foot bears on the ground, else 0.
    """

    t: FloatArray
    q: FloatArray
    dq: FloatArray
    u: FloatArray
    phase: FloatArray
    stance: FloatArray
    stance_y: FloatArray
    step: FloatArray
    bears: FloatArray


def place_whole_robot(biped: FrontalBiped, samples: PlanarSamples) -> WholeMotion:
    """The whole robot in a motion of its frontal plane.

    Args:
        biped: the robot in its frontal plane.
        samples: of the motion; accelerations are those of the undisturbed planar robot under its torques.

    Returns:
        Every joint, the base and the wrench on the stance sole.

    Raises:
        RobotError: the robot has virtual legs, and they do not reach a pose; one line.
    """
    robot = biped.robot
    placing: _Placing = _VirtualLegs(biped) if biped.description.virtual_legs else _RollJoints(biped, samples)
    model, data = robot.model, robot.model.createData()
    soles = {
        side: (model.getJointId(biped.stance_map.joint_names[row]), robot.sole_placement(side))
        for side, row in ANKLE.items()
    }
    count = len(samples.t)
    q, v = np.tile(robot.posture, (count, 1)), np.zeros((count, model.nv))
    tau, wrench = np.zeros((count, model.nv - BASE)), np.zeros((count, 2, 6))
    for k in range(count):
        stance = Stance.of_sign(samples.stance[k])
        ddq = biped.forward_dynamics(samples.q[k], samples.dq[k], samples.u[k])
        q[k], v[k], a = placing.at(k, samples, ddq, stance)
        forces = pin.rnea(model, data, q[k], v[k], a)
        joint, placement = soles[stance]
        pin.computeJointJacobians(model, data, q[k])
        sole = data.oMi[joint] * placement
        # what the root would have to be held with, held at the sole instead
        at_sole = pin.SE3(np.eye(3), sole.translation).actInv(data.oMi[1].act(pin.Force(forces[:BASE])))
        in_joint = pin.SE3(data.oMi[joint].rotation.T, placement.translation).act(at_sole)
        J = pin.getJointJacobian(model, data, joint, pin.LOCAL)
        tau[k] = (forces - J.T @ in_joint.vector)[BASE:]
        wrench[k, 0 if stance is Stance.LEFT else 1] = at_sole.vector
    own = placing.recorded_torques(samples)
    if own is not None:
        tau[:, [model.joints[model.getJointId(name)].idx_v - BASE for name in biped.stance_map.joint_names]] = own
    contact = np.stack([samples.stance > 0.0, samples.stance < 0.0], axis=1) * samples.bears[:, None]
    return WholeMotion(
        robot=robot,
        t=samples.t,
        q=q,
        v=v,
        tau=tau,
        contact=contact.astype(float),
        wrench=wrench,
        phase=samples.phase,
        stance=samples.stance,
        step=samples.step,
        held=tuple(name for name in one_freedom(robot) if name not in placing.moving),
    )


class _Placing(Protocol):
    """How a robot makes a planar motion."""

    @property
    def moving(self) -> tuple[str, ...]:
        """Names of the joints that move."""

    def at(
        self, k: int, samples: PlanarSamples, ddq: FloatArray, stance: Stance
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Configuration, velocity and acceleration of the whole robot at a sample, ddq (4,) there [rad/s^2]."""

    def recorded_torques(self, samples: PlanarSamples) -> FloatArray | None:
        """(T, 4) torques of the four roll joints where the planar run's own are theirs [N m]."""


class _RollJoints:
    """Four joints turn about X, everything else is held."""

    def __init__(self, biped: FrontalBiped, samples: PlanarSamples) -> None:
        self._biped, model = biped, biped.robot.model
        self._model, self._data = model, model.createData()
        self.moving = biped.stance_map.joint_names
        full = [model.joints[model.getJointId(name)] for name in self.moving]
        self._in_q, self._in_v = [joint.idx_q for joint in full], [joint.idx_v for joint in full]
        self._plane = standing_configurations(biped, samples.q, samples.stance, samples.stance_y)
        plane = biped.spatial_model
        self._in_plane = [plane.joints[plane.getJointId(name)].idx_q for name in self.moving]

    def at(
        self, k: int, samples: PlanarSamples, ddq: FloatArray, stance: Stance
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        model, data, chart = self._model, self._data, self._biped.stance_map
        q, v, a = self._biped.robot.posture.copy(), np.zeros(model.nv), np.zeros(model.nv)
        q[:ROOT], q[self._in_q] = self._plane[k, :ROOT], self._plane[k, self._in_plane]
        v[self._in_v] = chart.velocities_to_urdf(samples.dq[k], stance)
        a[self._in_v] = chart.velocities_to_urdf(ddq, stance)
        ankle = model.getJointId(self.moving[ANKLE[stance]])
        pin.computeJointJacobians(model, data, q)
        J = pin.getJointJacobian(model, data, ankle, pin.LOCAL)
        v[:BASE] = np.linalg.solve(J[:, :BASE], -J[:, BASE:] @ v[BASE:])
        pin.forwardKinematics(model, data, q, v, np.zeros(model.nv))
        drift = data.a[ankle].vector  # spatial acceleration where nothing accelerates
        a[:BASE] = np.linalg.solve(J[:, :BASE], -J[:, BASE:] @ a[BASE:] - drift)
        return q, v, a

    def recorded_torques(self, samples: PlanarSamples) -> FloatArray | None:
        chart = self._biped.stance_map
        return np.array(
            [chart.torques_to_urdf(u, Stance.of_sign(sign)) for u, sign in zip(samples.u, samples.stance, strict=True)]
        ).reshape(-1, 4)


class _VirtualLegs:
    """All joints of both legs make the planar robot's turns."""

    def __init__(self, biped: FrontalBiped) -> None:
        self._free = free = FreeRobot(biped.robot)
        self._states, self._near = PlanarStates(free), free.posture
        self._posture = biped.robot.posture
        full, model = biped.robot.model, free.model
        joints = [
            (full.joints[full.getJointId(name)], model.joints[model.getJointId(name)]) for name in model.names[1:]
        ]
        self._q = [(_rows(whole.idx_q, whole.nq), _rows(part.idx_q, part.nq)) for whole, part in joints]
        self._v = [(_rows(whole.idx_v, whole.nv), _rows(part.idx_v, part.nv)) for whole, part in joints]
        self._nv = full.nv
        legs = {joint for side in Stance for joint in free.leg(side)}
        self.moving = tuple(name for i, name in enumerate(free.joint_names) if i in legs)

    def at(
        self, k: int, samples: PlanarSamples, ddq: FloatArray, stance: Stance
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        foothold = np.array([0.0, samples.stance_y[k], 0.0])
        try:
            free_q, free_v = self._states.state(State(samples.q[k], samples.dq[k]), stance, foothold, self._near)
        except UnreachablePoseError as error:
            raise RobotError(
                f"{self._free.name}: its legs do not reach the pose at t = {samples.t[k]:.3f} s, {error}; export the"
                " steps before with --steps, or bend the knees further in the [posture] of its description"
            ) from None
        to_next = samples.t[k + 1] - samples.t[k] if k + 1 < len(samples.t) else 0.0
        self._near = pin.integrate(self._free.model, free_q, to_next * free_v)
        free_a = self._states.acceleration(free_q, free_v, ddq, stance)
        q, v, a = self._posture.copy(), np.zeros(self._nv), np.zeros(self._nv)
        for whole, part in self._q:
            q[whole] = free_q[part]
        for whole, part in self._v:
            v[whole], a[whole] = free_v[part], free_a[part]
        return q, v, a

    def recorded_torques(self, samples: PlanarSamples) -> FloatArray | None:
        return None


def _rows(start: int, size: int) -> slice:
    return slice(start, start + size)
