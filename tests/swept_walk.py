"""A walk in space without a controller: a planar gait swept forward, for what is drawn, written and measured.

Both soles go where the planar orbit has them in (y, z), and forward along a smooth path; pelvis and every other joint
keep their posture; the legs follow by inverse kinematics. Wrenches and torques are those of inverse dynamics, the whole
robot on its stance foot.
"""

import numpy as np
import pinocchio as pin

from frontal_biped.gait.file import gait_to_dict
from frontal_biped.model.chain import GRAVITY
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.orbit import orbit_trajectory
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.world import resample, world_configurations

RATE = 200.0  # [Hz]
HAIR = 1e-9  # [s] inside a step: at its ends two samples share one time
SOLE_ACCURACY = 1e-10
"""Of the inverse kinematics [m, rad]."""


def swept_walk(biped, gait, steps=4, step_length=0.2, turn=0.0):
    """A walk of so many steps; ``turn`` [rad] for every step, to the left."""
    robot = FreeRobot(biped.robot)
    orbit = orbit_trajectory(biped, gait, steps)
    duration = orbit.t[-1] / steps
    own = np.linspace(HAIR, duration - HAIR, int(np.ceil(RATE * duration)))
    times = np.concatenate([k * duration + own for k in range(steps)])
    planar = resample(orbit, times)
    plane = world_configurations(biped, planar)
    model, data = robot.model, robot.model.createData()
    flat = biped.spatial_model.createData()

    # where a foot is between two footholds, and the pelvis between both feet
    share = np.clip(times / duration - planar.step, 0.0, 1.0)
    smooth = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    travelled = np.zeros((len(times), 2))
    for foot, sign in enumerate((1.0, -1.0)):
        # the right foot swings first, by one step; from then on either goes two at a time
        late = 0.0 if foot == 0 else 1.0
        landed = np.floor((planar.step + late) / 2.0)
        going = np.where(planar.stance == sign, 0.0, smooth)
        first = (foot == 1) & (landed == 0)
        travelled[:, foot] = step_length * (np.maximum(2.0 * landed - late, 0.0) + going * np.where(first, 1.0, 2.0))
    middle = travelled.mean(axis=1)

    q = np.tile(robot.posture, (len(times), 1))
    names = list(biped.stance_map.joint_names)
    for row, (k, configuration) in zip(q, enumerate(plane), strict=True):
        pin.forwardKinematics(biped.spatial_model, flat, configuration)
        row[:7] = configuration[:7]
        row[0] += middle[k]
        targets = []
        for foot, side in enumerate((robot.soles.left, robot.soles.right)):
            placement = flat.oMi[biped.spatial_model.getJointId(names[0 if foot == 0 else 3])] * side.placement
            targets.append(
                pin.SE3(placement.rotation, placement.translation + np.array([travelled[k, foot], 0.0, 0.0]))
            )
        _reach(robot, data, row, targets, q[k - 1] if k else None)
    if turn:
        _bend(q, step_length / turn)

    v, a = np.zeros((2, len(times), model.nv))
    for step in range(steps):
        inside = np.flatnonzero(planar.step == step)
        between = np.array([pin.difference(model, q[k], q[k + 1]) for k in inside[:-1]]) / (own[1] - own[0])
        v[inside] = np.concatenate([between[:1], 0.5 * (between[1:] + between[:-1]), between[-1:]])
        a[inside] = np.gradient(v[inside], own, axis=0)
    return _recorded(biped, gait, robot, planar, np.round(times, 8), q, v, a, step_length / duration)


def _reach(robot, data, row, targets, start):
    """Move the joints of both legs until the soles are where they should be."""
    model = robot.model
    for side, target in zip((Stance.LEFT, Stance.RIGHT), targets, strict=True):
        leg = np.array(robot.leg(side))
        if start is not None:
            row[7 + leg] = start[7 + leg]
        frame = robot.sole_frame(side)
        for _ in range(30):
            pin.computeJointJacobians(model, data, row)
            pin.updateFramePlacement(model, data, frame)
            error = pin.log6(data.oMf[frame].actInv(target)).vector
            if np.abs(error).max() < SOLE_ACCURACY:
                break
            jacobian = pin.getFrameJacobian(model, data, frame, pin.LOCAL)[:, 6 + leg]
            row[7 + leg] += np.linalg.lstsq(jacobian, error, rcond=1e-8)[0]
        else:
            raise AssertionError(f"the {side.value} leg does not reach {target.translation}: {error}")


def _bend(q, radius):
    """Lay a straight way on a circle: what went forward turns about a centre to the left."""
    for row in q:
        angle = row[0] / radius
        turned = pin.Quaternion(pin.utils.rotate("z", angle)) * pin.Quaternion(row[3:7])
        sideways = radius - row[1]
        row[:2] = sideways * np.sin(angle), radius - sideways * np.cos(angle)
        row[3:7] = turned.coeffs()


def _recorded(biped, gait, robot, planar, times, q, v, a, speed):
    model, data = robot.model, robot.model.createData()
    count = len(times)
    soles, yaws = np.zeros((count, 2, 3)), np.zeros((count, 2))
    com, dcom = np.zeros((count, 3)), np.zeros((count, 3))
    wrench, tau, yaw = np.zeros((count, 2, 6)), np.zeros((count, model.nv - 6)), np.zeros(count)
    stances = [Stance.of_sign(sign) for sign in planar.stance]
    p_fri, cop_x = np.zeros(count), np.zeros(count)
    for k, stance in enumerate(stances):
        force = pin.rnea(model, data, q[k], v[k], a[k])
        com[k] = pin.centerOfMass(model, data, q[k], v[k])
        dcom[k] = data.vcom[0]
        pin.computeJointJacobians(model, data, q[k])
        pin.updateFramePlacements(model, data)
        placements = [data.oMf[frame] for frame in robot.sole_frames]
        for foot, place in enumerate(placements):
            soles[k, foot] = place.translation
            yaws[k, foot] = np.arctan2(place.rotation[1, 0], place.rotation[0, 0])
        foot = 0 if stance is Stance.LEFT else 1
        # what the root joint would have to carry, carried by the sole instead
        root = data.oMi[1].act(pin.Force(force[:6]))
        here = pin.SE3(np.eye(3), placements[foot].translation).actInv(root)
        wrench[k, foot] = here.vector
        jacobian = pin.getFrameJacobian(model, data, robot.sole_frames[foot], pin.LOCAL_WORLD_ALIGNED)
        tau[k] = (force - jacobian.T @ here.vector)[6:]
        x, y = -here.angular[1] / here.linear[2], here.angular[0] / here.linear[2]
        own = placements[foot].rotation[:2, :2].T @ [x, y]
        cop_x[k], p_fri[k] = own[0], -stance.sign * own[1]
        rotation = pin.Quaternion(q[k, 3:7]).matrix()
        yaw[k] = np.arctan2(rotation[1, 0], rotation[0, 0])
    nxt = np.array([np.flatnonzero(planar.step == step)[-1] for step in planar.step])
    swing = np.array([1 if stance is Stance.LEFT else 0 for stance in stances])
    foothold = np.column_stack([soles[nxt, swing, :2], yaws[nxt, swing]])
    contact = np.stack([planar.stance > 0.0, planar.stance < 0.0], axis=1).astype(float)
    orbit = orbit_trajectory(biped, gait, int(planar.step[-1]) + 1)
    return SpatialRun(
        t=times,
        q=q,
        v=v,
        tau=tau,
        wrench=wrench,
        contact=contact,
        com=com,
        com_velocity=dcom,
        sole_position=soles,
        sole_yaw=yaws,
        frontal_q=planar.q,
        frontal_dq=planar.dq,
        frontal_y=np.zeros((count, 3)),
        p_fri=p_fri,
        p_fri_target=planar.p_fri,
        cop_x=cop_x,
        cop_target_x=np.zeros(count),
        phase=planar.phase,
        stance=planar.stance,
        step=planar.step,
        speed_target=np.full(count, speed),
        yaw=yaw,
        foothold=foothold,
        solved=np.ones(count),
        event_t=orbit.event_t,
        event_kind=orbit.event_kind,
        event_step=orbit.event_step,
        event_frontal=orbit.event_state,
        robot=biped.name,
        joint_names=robot.joint_names,
        locked=robot.locked,
        outcome="completed",
        steps_completed=int(planar.step[-1]) + 1,
        gait=gait_to_dict(gait),
        settings={"weight": robot.mass * GRAVITY},
    )
