"""A robot in MuJoCo, spoken to in the package's coordinates: states, torques, pushes, contact, ground."""

from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import GRAVITY, UPRIGHT
from frontal_biped.model.perturbation import LINKS, ModelErrors
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.mujoco.model import BASE_JOINTS, link_bodies, mujoco_model
from frontal_biped.simulation.mujoco.spec import ContactSettings, floor_of, import_mujoco, sole_of, to_rotation
from frontal_biped.simulation.stance_motion import Reaction


class FootLoad(NamedTuple):
    """What the ground does to one foot.

    Attributes:
        force_y: [N].
        force_z: [N].
        moment: about +X, about the point of the sole below the ankle [N m].
    """

    force_y: float
    force_z: float
    moment: float


class _Turn(NamedTuple):
    """What a roll joint adds to the rotation of what it carries about +X: sign (q - reference)."""

    place: int
    sign: float
    reference: float


class MujocoRobot:
    """One robot, its state and its ground.

    Args:
        biped: the robot of the files.
        errors: how MuJoCo's bodies differ from them.
        contact: contact and physics step.

    Attributes:
        model: MuJoCo's model.
        data: MuJoCo's state.
    """

    def __init__(
        self, biped: FrontalBiped, errors: ModelErrors | None = None, contact: ContactSettings | None = None
    ) -> None:
        self.biped = biped
        self._mujoco = import_mujoco()
        self.model = mujoco_model(biped, contact)
        names = biped.stance_map.joint_names
        joints = [self.model.joint(name) for name in names]
        self._q_at = np.array([joint.qposadr[0] for joint in joints])
        self._v_at = np.array([joint.dofadr[0] for joint in joints])
        self._base = np.array([self.model.joint(name).dofadr[0] for name in BASE_JOINTS])
        roll = self.model.joint(BASE_JOINTS[2])
        self._roll_q, self._roll_v = int(roll.qposadr[0]), int(roll.dofadr[0])
        self._bodies = link_bodies(biped, self.model)
        self._hips = [joints[1].id, joints[2].id]
        self._feet = {Stance.LEFT: self._bodies[LINKS[0]], Stance.RIGHT: self._bodies[LINKS[4]]}
        self._soles = {stance: self.model.geom(sole_of(stance)).id for stance in Stance}
        self._floors = {stance: int(self.model.body(floor_of(stance)).mocapid[0]) for stance in Stance}
        self._sole_id = (self._soles[Stance.LEFT], self._soles[Stance.RIGHT])
        if errors is not None:
            self._apply(errors)
        self.data = self._mujoco.MjData(self.model)
        # views of MuJoCo's own arrays, which stay where they are: asking its data for them costs more than reading
        self._qpos, self._qvel, self._xpos = self.data.qpos, self.data.qvel, self.data.xpos
        self._center_of_mass = self.data.subtree_com[self._bodies["pelvis"]]
        self._applied, self._pushed = self.data.qfrc_applied, False
        self._turns = dict(zip(Stance, self._ankle_turns(), strict=True))
        self._touching: tuple[bool, bool] | None = None

    def _ankle_turns(self) -> tuple[list[_Turn], list[_Turn]]:
        """The two joints of either leg, by which its foot turns against the pelvis."""
        coordinates = self.biped.stance_map
        rows = zip(self._q_at.tolist(), coordinates.axis_sign.tolist(), coordinates.reference.tolist(), strict=True)
        turns = [_Turn(*row) for row in rows]
        return turns[:2], turns[2:]

    def _apply(self, errors: ModelErrors) -> None:
        """Errors of MuJoCo's own bodies; shifts are given along world axes at the reference posture."""
        model = self.model
        data = self._mujoco.MjData(model)
        self._mujoco.mj_forward(model, data)
        for i, link in enumerate(LINKS):
            body = self._bodies[link]
            orientation = data.xmat[body].reshape(3, 3)
            model.body_mass[body] *= errors.mass[i]
            model.body_inertia[body] *= errors.inertia[i]
            model.body_ipos[body] += orientation.T @ np.array([0.0, *errors.com[i]])
        for i, stance in enumerate(Stance):
            model.body_pos[self._feet[stance]] *= errors.length[i]
        self._mujoco.mj_setConst(model, data)

    # ------------------------------------------------------------------ state
    def stand(self, stance: Stance, state: State, foot_y: float) -> None:
        """Stand on a foot, flat and at rest on the ground at ``foot_y`` [m]."""
        q, dq = state
        biped, model, data = self.biped, self.model, self.data
        self._touching = None
        data.qpos[:] = 0.0
        data.qpos[self._q_at] = biped.stance_map.positions_to_urdf(q, stance)
        data.qpos[self._base[2]] = -stance.sign * biped.pelvis_roll(q)
        self._mujoco.mj_kinematics(model, data)
        foot = self._feet[stance]
        data.qpos[self._base[0]] += foot_y - data.xpos[foot, 1]
        data.qpos[self._base[1]] += biped.ankle_height + self.ground(stance) - data.xpos[foot, 2]
        data.qvel[:] = 0.0
        data.qvel[self._v_at] = biped.stance_map.velocities_to_urdf(dq, stance)
        self._mujoco.mj_forward(model, data)
        J = np.zeros((6, model.nv))
        self._mujoco.mj_jac(model, data, J[:3], J[3:], data.xpos[foot], foot)
        J = J[1:4]  # y, z and roll
        data.qvel[self._base] = -np.linalg.solve(J[:, self._base], J[:, self._v_at] @ data.qvel[self._v_at])
        self._mujoco.mj_forward(model, data)

    @property
    def joint_positions(self) -> FloatArray:
        """(4,) URDF joint angles [rad]."""
        return self._qpos.take(self._q_at)

    @property
    def joint_velocities(self) -> FloatArray:
        """(4,) [rad/s]."""
        return self._qvel.take(self._v_at)

    @property
    def base_roll(self) -> float:
        """Rotation of the pelvis about +X [rad]."""
        return self._qpos.item(self._roll_q)

    @property
    def base_roll_rate(self) -> float:
        """[rad/s]."""
        return self._qvel.item(self._roll_v)

    def stance_state(self, stance: Stance) -> State:
        """The state by the joints, for a foot taken as the stance foot."""
        coordinates = self.biped.stance_map
        q = coordinates.positions_to_stance(self.joint_positions, stance)
        return State(q, coordinates.velocities_to_stance(self.joint_velocities, stance))

    @property
    def height(self) -> float:
        """Height of the centre of mass above z = 0 [m]."""
        return self._center_of_mass.item(2)

    def com_offset(self, stance: Stance) -> float:
        """Where the centre of mass is along h, from a foot's ankle [m]."""
        along_y = self._center_of_mass.item(1) - self.foot_position(stance)[0]
        return -stance.sign * along_y  # h points from the stance foot towards the swing foot

    # ------------------------------------------------------------------ motion
    def run(self, tau: FloatArray, steps: int, pushes: list[tuple[float, float]]) -> None:
        """Physics steps under joint torques (4,) [N m] and pushes, pairs of force to the left and height [N, m]."""
        data, self._touching = self.data, None
        if self._pushed:  # a push leaves its share on every joint
            self._applied[:] = 0.0
        self._pushed = bool(pushes)
        self._applied.put(self._v_at, tau)
        for force, height in pushes:
            pelvis = self._bodies["pelvis"]
            up = data.xmat[pelvis].reshape(3, 3) @ self._up_in_pelvis()
            point = data.xanchor[self._hips].mean(axis=0) + height * up
            self._mujoco.mj_applyFT(
                self.model, data, np.array([0.0, force, 0.0]), np.zeros(3), point, pelvis, data.qfrc_applied
            )
        self._mujoco.mj_step(self.model, data, steps)

    def _up_in_pelvis(self) -> FloatArray:
        """The torso's axis in the pelvis frame: world Z at zero roll."""
        return to_rotation(self.model.body_quat[self._bodies["pelvis"]])[2]

    # ------------------------------------------------------------------ feet and ground
    @property
    def contact(self) -> tuple[bool, bool]:
        """Does the left, the right foot touch the ground?"""
        if self._touching is None:
            touching = self.data.contact.geom[:, 1].tolist()
            left, right = self._sole_id
            self._touching = left in touching, right in touching
        return self._touching

    def load(self, stance: Stance) -> FootLoad:
        """What the ground does to a foot."""
        sole, ground, foot_y = self._soles[stance], self.ground(stance), self._xpos.item(self._feet[stance], 1)
        force_y = force_z = moment = 0.0
        contact, solved = self.data.contact, self.data.efc_force.tolist()
        rows = zip(contact.geom.tolist(), contact.efc_address.tolist(), contact.pos, contact.frame, strict=True)
        for (_, touching), first, place, frame in rows:
            if touching != sole or first < 0:
                continue
            # of a cone with sliding friction the solver keeps the force along the normal and two tangents
            along_normal, along_1, along_2 = solved[first : first + 3]
            _, y, z = place.tolist()
            _, n_y, n_z, _, a_y, a_z, _, b_y, b_z = frame.tolist()
            F_y = along_normal * n_y + along_1 * a_y + along_2 * b_y
            F_z = along_normal * n_z + along_1 * a_z + along_2 * b_z
            force_y, force_z = force_y + F_y, force_z + F_z
            moment += (y - foot_y) * F_z - (z - ground) * F_y
        return FootLoad(force_y, force_z, moment)

    def reaction(self, stance: Stance) -> Reaction:
        """Ground reaction on a stance foot."""
        load, h = self.load(stance), -stance.sign
        fri = load.moment * h / load.force_z if load.force_z > 0.0 else float("nan")
        return Reaction(h * load.force_y, load.force_z, fri)

    def foot_position(self, stance: Stance) -> tuple[float, float]:
        """y of a foot's ankle [m] and the foot's rotation about +X [rad]."""
        return self._xpos.item(self._feet[stance], 1), self.foot_rotation(stance)

    def foot_rotation(self, stance: Stance) -> float:
        """Rotation of a foot about +X [rad]."""
        qpos, ((a, sign_a, zero_a), (b, sign_b, zero_b)) = self._qpos.tolist(), self._turns[stance]
        rotation: float = qpos[self._roll_q] + sign_a * (qpos[a] - zero_a) + sign_b * (qpos[b] - zero_b)
        return rotation

    def clearance(self, stance: Stance) -> float:
        """Height of the lowest point of a foot's sole above z = 0 [m]."""
        sole = self._soles[stance]
        size, matrix = self.model.geom_size[sole], self.data.geom_xmat[sole]
        # the box stands along world axes but for its roll
        return float(self.data.geom_xpos[sole, 2] - size[1] * abs(matrix[7]) - size[2] * abs(matrix[8]))

    def ground(self, stance: Stance) -> float:
        """Height of the floor under a foot [m]."""
        return float(self.data.mocap_pos[self._floors[stance], 2])

    def set_ground(self, stance: Stance, height: float) -> None:
        """Set the height of the floor under a foot [m]."""
        self.data.mocap_pos[self._floors[stance], 2] = height

    @property
    def upright_height(self) -> float:
        """Of the centre of mass of the robot of the files [m]."""
        return float(self.biped.com(np.full(4, UPRIGHT))[1])

    @property
    def weight(self) -> float:
        """[N]."""
        return float(self.model.body_mass.sum() * GRAVITY)
