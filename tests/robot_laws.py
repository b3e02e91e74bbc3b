"""Laws that every robot obeys, whatever its description: shared by the tests and by the smoke test of the wheel.

Plain functions of a robot, so that they run from any folder, with nothing but the installed package.
"""

from collections.abc import Callable, Iterator

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from frontal_biped.model import FrontalBiped, Stance, impact, relabel
from frontal_biped.model.chain import UPRIGHT, FrontalChain

FloatArray = npt.NDArray[np.float64]

EXACT = 1e-10
"""Relative: both sides are computed by different algorithms on the same numbers."""

ROUNDED_URDF = {"icub": 1e-5}
"""Relative, for robots whose URDF prints axes to six digits: 0.0008 degrees off the plane."""

STATES = 20


def tolerance(robot: FrontalBiped) -> float:
    return ROUNDED_URDF.get(robot.name, EXACT)


def random_states(seed: int = 0) -> Iterator[tuple[FloatArray, FloatArray, FloatArray]]:
    """(7,) positions, velocities and accelerations of the floating model: foot anywhere, legs up to 0.5 rad."""
    rng = np.random.default_rng(seed)
    for _ in range(STATES):
        foot = rng.uniform(-0.3, 0.3, 3)
        q = UPRIGHT + rng.uniform(-0.5, 0.5, 4)
        yield np.concatenate([foot, q]), rng.uniform(-3.0, 3.0, 7), rng.uniform(-10.0, 10.0, 7)


def close(actual: npt.ArrayLike, expected: npt.ArrayLike, relative: float, what: str) -> None:
    actual, expected = np.asarray(actual, dtype=float), np.asarray(expected, dtype=float)
    error = float(np.max(np.abs(actual - expected)))
    size = max(float(np.max(np.abs(expected))), 1.0)
    assert error <= relative * size, f"{what}: error {error:.3g}, size {size:.3g}, allowed {relative:g}"


# ---------------------------------------------------------------------- the plane against the room
class _Room:
    """The 3D model moved by the planar one: positions, velocities and accelerations of its ten freedoms."""

    def __init__(self, robot: FrontalBiped, chain: FrontalChain, stance: Stance) -> None:
        self.side = 1.0 if stance is Stance.LEFT else -1.0
        self.stance, self.map = stance, robot.stance_map
        self.model = robot.spatial_model.copy()
        self.columns = [self.model.joints[self.model.getJointId(name)] for name in self.map.joint_names]
        left_to_right = chain.armature if stance is Stance.LEFT else chain.armature[::-1]
        armature = np.zeros(self.model.nv)  # a URDF cannot tell it, the description does
        for joint, value in zip(self.columns, left_to_right, strict=True):
            armature[joint.idx_v] = value
        self.model.armature = armature
        self.data = self.model.createData()
        data = self.model.createData()
        reference = robot.spatial_reference
        pin.forwardKinematics(self.model, data, reference)
        self.upright = data.oMi[1].rotation.copy()
        hip = self.model.getJointId(self.map.joint_names[1 if stance is Stance.LEFT else 2])
        self.root_from_hip = (data.oMi[1].translation - data.oMi[hip].translation).copy()
        self.planar = chain.floating_model()
        self.planar_data = self.planar.createData()

    def state(self, q: FloatArray, v: FloatArray, a: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """q, v, a (10 freedoms) of the 3D model for q, v, a (7,) of the planar one, from rigid-body kinematics."""
        model, data, pelvis = self.planar, self.planar_data, 5  # three freedoms of the foot, ankle, hip
        pin.forwardKinematics(model, data, q, v, a)
        local = pin.LOCAL_WORLD_ALIGNED
        # h = -side y, v = z; turning counter-clockwise in (h, v) is -side about X
        turn = np.array([[0.0, 0.0, -self.side], [-self.side, 0.0, 0.0], [0.0, 1.0, 0.0]])
        hip = turn @ data.oMi[pelvis].translation
        hip_velocity = turn @ pin.getVelocity(model, data, pelvis, local).linear
        hip_acceleration = turn @ pin.getClassicalAcceleration(model, data, pelvis, local).linear
        spin = turn @ pin.getVelocity(model, data, pelvis, local).angular
        spin_rate = turn @ pin.getClassicalAcceleration(model, data, pelvis, local).angular
        roll = pin.exp3(turn @ pin.log3(data.oMi[pelvis].rotation))
        arm = roll @ self.root_from_hip
        position = hip + arm
        velocity = hip_velocity + np.cross(spin, arm)
        acceleration = hip_acceleration + np.cross(spin_rate, arm) + np.cross(spin, np.cross(spin, arm))
        body = (roll @ self.upright).T  # a free-flyer's velocity is measured in its own frame
        q_room, v_room, a_room = pin.neutral(self.model), np.zeros(self.model.nv), np.zeros(self.model.nv)
        q_room[:3], q_room[3:7] = position, pin.Quaternion(body.T).coeffs()
        v_room[:3], v_room[3:6] = body @ velocity, body @ spin
        a_room[:3] = body @ acceleration - np.cross(v_room[3:6], v_room[:3])
        a_room[3:6] = body @ spin_rate
        angles = self.map.positions_to_urdf(q[3:], self.stance)
        rates = self.map.velocities_to_urdf(v[3:], self.stance)
        changes = self.map.velocities_to_urdf(a[3:], self.stance)
        for joint, angle, rate, change in zip(self.columns, angles, rates, changes, strict=True):
            q_room[joint.idx_q], v_room[joint.idx_v], a_room[joint.idx_v] = angle, rate, change
        return q_room, v_room, a_room


def planar_is_3d(robot: FrontalBiped) -> None:
    """Inverse dynamics in the plane are those of the 3D model moved in the plane, either foot, legs as in the URDF."""
    for stance in Stance:
        chain = robot.measured.chain(robot.description.sole, stance)
        room = _Room(robot, chain, stance)
        for q, v, a in random_states():
            q_room, v_room, a_room = room.state(q, v, a)
            forces = pin.rnea(room.model, room.data, q_room, v_room, a_room)
            # virtual power: each planar freedom moves the room's ten
            zero = np.zeros(7)
            freedoms = np.array([room.state(q, unit, zero)[1] for unit in np.eye(7)])
            planar = pin.rnea(room.planar, room.planar_data, q, v, a)
            close(freedoms @ forces, planar, tolerance(robot), f"{robot.name}, {stance.value} stance, rnea")


def pinned_is_projected(robot: FrontalBiped) -> None:
    """The pinned model is the floating one with the stance foot held: D, C dq, G, and forward dynamics by KKT."""
    floating, data = robot.floating, robot.floating.createData()
    J = np.hstack([np.eye(3), np.zeros((3, 4))])
    for q7, v7, u7 in random_states(1):
        q, dq, u = q7[3:], v7[3:], u7[3:]
        held, rates = np.concatenate([np.zeros(3), q]), np.concatenate([np.zeros(3), dq])
        M = np.array(pin.crba(floating, data, held))
        bias = np.array(pin.nonLinearEffects(floating, data, held, rates))
        gravity = np.array(pin.computeGeneralizedGravity(floating, data, held))
        close(robot.D(q), M[3:, 3:], EXACT, f"{robot.name}, D")
        close(robot.C(q, dq) @ dq, (bias - gravity)[3:], EXACT, f"{robot.name}, C dq")
        close(robot.G(q), gravity[3:], EXACT, f"{robot.name}, G")
        torques = np.concatenate([np.zeros(3), u])
        KKT = np.block([[M, J.T], [J, np.zeros((3, 3))]])
        motion = np.linalg.solve(KKT, np.concatenate([torques - bias, np.zeros(3)]))
        ddq = robot.forward_dynamics(q, dq, u)
        # a light foot on a stiff ankle: the solve loses cond(D) of the digits
        loss = max(1.0, float(np.linalg.cond(M[3:, 3:])) / 1e4)
        close(ddq, motion[3:7], EXACT * loss, f"{robot.name}, ddq")


def impact_is_kkt(robot: FrontalBiped) -> None:
    """The impact is the solution of its KKT system, and the landing foot sticks."""
    floating, data = robot.floating, robot.floating.createData()
    last = floating.njoints - 1
    for q7, v7, _ in random_states(2):
        q, dq = q7[3:], v7[3:]
        held, v_minus = np.concatenate([np.zeros(3), q]), np.concatenate([np.zeros(3), dq])
        M = np.array(pin.crba(floating, data, held))
        pin.computeJointJacobians(floating, data, held)
        J = np.array(pin.getJointJacobian(floating, data, last, pin.LOCAL_WORLD_ALIGNED))[[0, 1, 5]]
        KKT = np.block([[M, -J.T], [J, np.zeros((3, 3))]])
        solution = np.linalg.solve(KKT, np.concatenate([M @ v_minus, np.zeros(3)]))
        landed = impact(robot, q, dq)
        close(relabel(landed.dq_plus), solution[3:7], EXACT, f"{robot.name}, dq+")
        close(landed.impulse[:2], solution[7:9], EXACT, f"{robot.name}, impulse")
        before, after = 0.5 * v_minus @ M @ v_minus, 0.5 * solution[:7] @ M @ solution[:7]
        assert after <= before * (1.0 + EXACT), f"{robot.name}: the impact makes energy"


def legs_are_mirrored(robot: FrontalBiped) -> None:
    """After symmetrisation either foot sees the same chain, and the robot's mass is what it was."""
    chain, bodies = robot.chain, robot.chain.bodies
    joints = chain.joints.copy()
    joints[:, 0] = chain.joints[-1, 0] - joints[:, 0]
    close(joints[::-1], chain.joints, EXACT, f"{robot.name}, joints")
    for left, right in zip(bodies, bodies[::-1], strict=True):
        mirrored = np.array([chain.joints[-1, 0] - right.com[0], right.com[1]])
        close(left.com, mirrored, EXACT, f"{robot.name}, centres of mass")
        close([left.mass, left.inertia], [right.mass, right.inertia], EXACT, f"{robot.name}, masses")
    for values in (chain.armature, chain.max_torque, chain.max_velocity, chain.lower, chain.upper):
        close(values, values[::-1], EXACT, f"{robot.name}, limits")
    q = np.full(4, UPRIGHT)
    close(robot.mass, sum(inertia.mass for inertia in robot.spatial_model.inertias), EXACT, f"{robot.name}, mass")
    height = pin.centerOfMass(robot.spatial_model, robot.spatial_model.createData(), robot.spatial_reference)[2]
    data = robot.spatial_model.createData()
    pin.forwardKinematics(robot.spatial_model, data, robot.spatial_reference)
    names = robot.stance_map.joint_names
    ankle = np.mean([data.oMi[robot.spatial_model.getJointId(names[i])].translation[2] for i in (0, 3)])
    close(robot.com(q)[1] - robot.ankle_height, height - ankle, EXACT, f"{robot.name}, height of the centre of mass")


def limits_are_the_urdfs(robot: FrontalBiped) -> None:
    """What a joint may do in stance coordinates, either foot standing, is inside what its URDF joint may do."""
    model, names = robot.spatial_model, robot.stance_map.joint_names
    columns = [model.joints[model.getJointId(name)] for name in names]
    low = np.array([model.lowerPositionLimit[joint.idx_q] for joint in columns])
    high = np.array([model.upperPositionLimit[joint.idx_q] for joint in columns])
    speed = np.array([model.velocityLimit[joint.idx_v] for joint in columns])
    assert np.all(robot.joint_lower < UPRIGHT), robot.name
    assert np.all(robot.joint_upper > UPRIGHT), robot.name
    tight = np.zeros((2, 4), dtype=bool)
    for stance in Stance:
        for q in (robot.joint_lower, robot.joint_upper):
            angles = robot.stance_map.positions_to_urdf(q, stance)
            assert np.all(angles >= low - EXACT), robot.name
            assert np.all(angles <= high + EXACT), robot.name
            tight |= np.abs(np.array([angles - low, angles - high])) < EXACT
        rates = np.abs(robot.stance_map.velocities_to_urdf(robot.joint_max_velocity, stance))
        assert np.all(rates <= speed + EXACT), robot.name
    # and no narrower than need be: of each mirrored pair some joint is at its own limit, below and above
    assert np.all(np.any(tight, axis=0) | np.any(tight[:, ::-1], axis=0)), robot.name


LAWS: tuple[Callable[[FrontalBiped], None], ...] = (
    planar_is_3d,
    pinned_is_projected,
    impact_is_kkt,
    legs_are_mirrored,
    limits_are_the_urdfs,
)
