"""The whole robot in MuJoCo, spoken to as a `FreeRobot`: Pinocchio's configurations and velocities, joint torques.

Motors are those of the URDF: a torque is cut at the joint's effort, and no motor drives a joint beyond its speed. In
the last `SPEED_BAND` of the speed limit, the torque in the direction of motion fades in proportion to the speed that is
left,

    tau = tau_cut (v_max - |v|) / (band + h |tau_cut| / I),      at most tau_cut, at least 0,

where the second term of the denominator is what the torque adds to the speed of inertia I, the joint's own with all
others free, in a physics step h: without it the fading is a damper too stiff for the step. Torques against the motion
are not touched, and what else moves a joint, impact or push, may move it faster.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.space.errors import SpatialErrors
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.mujoco.space_model import IndexArray, joint_addresses, moved_bodies, mujoco_space_model
from frontal_biped.simulation.mujoco.spec import ContactSettings, floor_of, import_mujoco, sole_of
from frontal_biped.simulation.space.engine import SolePose, SpatialState
from frontal_biped.simulation.space.pushes import LinkForce, link_place

SPEED_BAND = 0.1
"""Share of the speed limit over which a motor's torque fades [-]."""

_UNLIMITED = 1e9
"""Stands for a torque or speed without limit: arithmetic with it stays finite."""


class _Load(NamedTuple):
    """Contacts of one physics step, as MuJoCo keeps them.

    Attributes:
        geoms: (k,) the sole of each.
        points: (k, 3) in the world [m].
        frames: (k, 9) axes, row by row: normal, then two tangents.
        forces: (k, 3) on the sole along those axes [N].
        feet: (2, 3) where the left and the right foot's body is [m].
        axes: (2, 9) their rotations, row by row.
    """

    geoms: IndexArray
    points: FloatArray
    frames: FloatArray
    forces: FloatArray
    feet: FloatArray
    axes: FloatArray


_CONE = np.arange(3)
_NOTHING = _Load(
    np.zeros(0, dtype=int), np.zeros((0, 3)), np.zeros((0, 9)), np.zeros((0, 3)), np.zeros((2, 3)), np.zeros((2, 9))
)


class SpaceRobot:
    """One robot in space, its state and its ground.

    Between calls, everything that MuJoCo derives from positions and velocities is up to date.

    Args:
        free: the robot of the files.
        errors: how MuJoCo's bodies differ from them.
        contact: contact and physics step.

    Attributes:
        model: MuJoCo's model.
        data: MuJoCo's state.
    """

    def __init__(
        self, free: FreeRobot, errors: SpatialErrors | None = None, contact: ContactSettings | None = None
    ) -> None:
        self.free = free
        self._mujoco = import_mujoco()
        self.model = mujoco_space_model(free, contact)
        self._q_at, self._v_at = joint_addresses(free, self.model)
        self._bodies = moved_bodies(free, self.model)
        self._root = int(self._bodies[0])
        self._sole_geoms = tuple(self.model.geom(sole_of(side)).id for side in Stance)
        self._floors = {side: int(self.model.body(floor_of(side)).mocapid[0]) for side in Stance}
        self._sole_bodies = tuple(int(self.model.geom_bodyid[geom]) for geom in self._sole_geoms)
        self._feet = list(self._sole_bodies)
        self._sole_placements = tuple((sole.placement.translation, sole.placement.rotation) for sole in free.soles)
        self._sole_normals = tuple(sole.placement.rotation[:, 2] for sole in free.soles)
        if errors is not None:
            self._apply(errors)
        self.data = self._mujoco.MjData(self.model)
        self._effort = np.minimum(free.limits.effort, _UNLIMITED)
        self._speed = np.minimum(free.limits.velocity, _UNLIMITED)
        self._band = SPEED_BAND * self._speed
        self._speed_gain = self.model.opt.timestep / _free_inertias(free)
        self._load = _NOTHING
        self._torques, self._rates, self._acting = (np.zeros(len(self._v_at)) for _ in range(3))

    def _apply(self, errors: SpatialErrors) -> None:
        model, bodies = self.model, self._bodies
        if len(errors.mass) != len(bodies):
            raise SimulationError(
                f"SpatialErrors of {len(errors.mass)} bodies for a robot of {len(bodies)}: its root and"
                f" {len(bodies) - 1} joints"
            )
        model.body_mass[bodies] *= errors.mass
        model.body_inertia[bodies] *= errors.inertia[:, None]
        model.body_ipos[bodies] += errors.com
        self._mujoco.mj_setConst(model, self._mujoco.MjData(model))

    # ------------------------------------------------------------------ state
    def place(self, q: FloatArray, v: FloatArray) -> None:
        """Put the robot at q (nq,), v (nv,) of its `FreeRobot`, on level ground at z = 0."""
        data = self.data
        self._mujoco.mj_resetData(self.model, data)
        rotation = pin.Quaternion(*q[[6, 3, 4, 5]]).matrix()
        data.qpos[:3] = q[:3]
        data.qpos[3:7] = q[[6, 3, 4, 5]]  # scalar first
        data.qpos[self._q_at] = q[7:]
        data.qvel[:3] = rotation @ v[:3]  # along the axes of the world
        data.qvel[3:6] = v[3:6]  # about those of the root link, as in Pinocchio
        data.qvel[self._v_at] = v[BASE:]
        self._load = _NOTHING
        self._mujoco.mj_step1(self.model, data)

    def state(self) -> SpatialState:
        """Configuration and velocity of the `FreeRobot`."""
        data = self.data
        q, v = np.empty(7 + len(self._q_at)), np.empty(BASE + len(self._v_at))
        q[:3] = data.qpos[:3]
        q[3:7] = data.qpos[[4, 5, 6, 3]]
        q[7:] = data.qpos[self._q_at]
        v[:3] = self.base_rotation.T @ data.qvel[:3]
        v[3:6] = data.qvel[3:6]
        v[BASE:] = data.qvel[self._v_at]
        return SpatialState(q, v)

    @property
    def base_rotation(self) -> FloatArray:
        """(3, 3) axes of the root link in the world."""
        return self.data.xmat[self._root].reshape(3, 3)

    @property
    def joint_positions(self) -> FloatArray:
        """(n,) [rad]."""
        return self.data.qpos[self._q_at]

    @property
    def joint_velocities(self) -> FloatArray:
        """(n,) [rad/s]."""
        return self.data.qvel[self._v_at]

    def com(self) -> tuple[FloatArray, FloatArray]:
        """Centre of mass (3,) of the true robot in the world [m] and its velocity (3,) [m/s]."""
        self._mujoco.mj_subtreeVel(self.model, self.data)
        return self.data.subtree_com[self._root].copy(), self.data.subtree_linvel[self._root].copy()

    # ------------------------------------------------------------------ motion
    def run(self, tau: FloatArray, steps: int, pushes: Sequence[LinkForce] = ()) -> None:
        """Physics steps under commanded joint torques (n,) [N m] and forces on links."""
        mujoco, model, data = self._mujoco, self.model, self.data
        data.qfrc_applied[:] = 0.0
        for push in pushes:
            body, point = self._point(push.link, push.point)
            mujoco.mj_applyFT(model, data, push.force, np.zeros(3), point, body, data.qfrc_applied)
        pushed = data.qfrc_applied[self._v_at]
        cut = np.minimum(np.maximum(tau, -self._effort), self._effort)
        sense, denominator = np.sign(cut), self._band + self._speed_gain * np.abs(cut)
        rates, acting = self._rates, self._acting
        self._torques[:] = 0.0
        for step in range(steps):
            np.take(data.qvel, self._v_at, out=rates)
            np.multiply(sense, rates, out=acting)
            np.subtract(self._speed, acting, out=acting)  # what is left of the speed
            np.divide(acting, denominator, out=acting)
            np.minimum(acting, 1.0, out=acting)
            np.maximum(acting, 0.0, out=acting)
            np.multiply(cut, acting, out=acting)
            self._torques += acting
            data.qfrc_applied[self._v_at] = acting + pushed
            mujoco.mj_step2(model, data)
            if step == 0:
                self._load = self._take_load()
            mujoco.mj_step1(model, data)
        self._torques /= steps

    def torques(self) -> FloatArray:
        """(n,) what the motors gave in the last `run`, on average over its steps [N m]."""
        return self._torques.copy()

    def _point(self, link: str, point: FloatArray) -> tuple[int, FloatArray]:
        """MuJoCo's body that a link is part of, and a point of the link in the world (3,) [m]."""
        joint, placement = link_place(self.free, link)
        body = int(self._bodies[joint - 1])
        return body, self.data.xpos[body] + self.data.xmat[body].reshape(3, 3) @ placement.act(point)

    # ------------------------------------------------------------------ feet and ground
    def is_edge_on(self, side: Stance, least_upright: float) -> bool:
        """Is the normal of a foot's sole so far from the vertical that its vertical part is below ``least_upright``?"""
        index = 0 if side is Stance.LEFT else 1
        return bool(self.data.xmat[self._sole_bodies[index], 6:] @ self._sole_normals[index] < least_upright)

    @property
    def contact(self) -> tuple[bool, bool]:
        """Does the left, the right foot touch the ground?"""
        touching = self.data.contact.geom[:, 1].tolist()
        left, right = self._sole_geoms
        return left in touching, right in touching

    def sole(self, side: Stance) -> SolePose:
        """Where a foot's sole is."""
        index = 0 if side is Stance.LEFT else 1
        body, (offset, axes) = self._sole_bodies[index], self._sole_placements[index]
        rotation = self.data.xmat[body].reshape(3, 3)
        return SolePose(self.data.xpos[body] + rotation @ offset, rotation @ axes)

    def wrenches(self) -> FloatArray:
        """(2, 6) what the ground does to the left and the right foot as the last `run` began.

        Force [N], then moment about the origin of the sole's frame [N m], in world axes.
        """
        load, wrenches = self._load, np.zeros((2, 6))
        forces = np.einsum("kij,ki->kj", load.frames.reshape(-1, 3, 3), load.forces)
        for foot, (geom, (offset, _)) in enumerate(zip(self._sole_geoms, self._sole_placements, strict=True)):
            own = load.geoms == geom
            force, origin = forces[own], load.feet[foot] + load.axes[foot].reshape(3, 3) @ offset
            product = (load.points[own] - origin).T @ force
            wrenches[foot, :3] = force.sum(axis=0)
            wrenches[foot, 3:] = (product - product.T)[[1, 2, 0], [2, 0, 1]]  # sum of arm x force
        return wrenches

    def _take_load(self) -> "_Load":
        """Contacts and forces of the last step; kinematics and contacts are still those before it."""
        contact, data = self.data.contact, self.data
        return _Load(
            contact.geom[:, 1].copy(),
            contact.pos.copy(),
            contact.frame.copy(),
            # of a cone with sliding friction: normal and two tangents
            data.efc_force[contact.efc_address[:, None] + _CONE],
            data.xpos[self._feet],
            data.xmat[self._feet],
        )

    def clearance(self, side: Stance) -> float:
        """Height of the lowest point of a foot's box above z = 0 [m]."""
        geom = self._sole_geoms[0 if side is Stance.LEFT else 1]
        down = np.abs(self.data.geom_xmat[geom][6:9]) @ self.model.geom_size[geom]
        return float(self.data.geom_xpos[geom, 2] - down)

    def ground(self, stance: Stance) -> float:
        """Height of the floor under a foot [m]."""
        return float(self.data.mocap_pos[self._floors[stance], 2])

    def set_ground(self, stance: Stance, height: float) -> None:
        """Set the height of the floor under a foot [m]."""
        self.data.mocap_pos[self._floors[stance], 2] = height


def _free_inertias(free: FreeRobot) -> FloatArray:
    """(n,) what each joint feels of the robot at its posture while all others are free [kg m^2]."""
    model = free.model
    inverse = np.array(pin.computeMinverse(model, model.createData(), free.posture))
    inertias: FloatArray = 1.0 / np.diag(inverse)[BASE:]
    return inertias
