"""A run as a motion of the whole robot: every joint of the URDF, the base and both feet, at any rate.

    motion = fb.whole_motion(robot, run, rate=500.0)
    motion.positions["leg_left_4_joint"], motion.torques["leg_left_4_joint"]
    motion.pinocchio.q, motion.mujoco.q

Between the samples of a planar run the joints follow the cubic that has their positions and rates at both ends, so that
the velocities at any rate are the derivatives of the positions; torques are interpolated linearly. Nothing is
interpolated across an event.
"""

from dataclasses import replace

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import RobotLike, biped_of, whole_of
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.joint_arrays import ROOT
from frontal_biped.model.space.whole_motion import WholeMotion
from frontal_biped.model.space.whole_placing import PlanarSamples, place_whole_robot
from frontal_biped.model.stance_map import relabel
from frontal_biped.simulation.space.resampling import drawable_part, resample_spatial
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.world import drawable, even_times, neighbours


def whole_motion(robot: RobotLike, run: Trajectory | SpatialRun, rate: float | None = None) -> WholeMotion:
    """A run, planar or in space, as a motion of every joint of the URDF.

    Args:
        robot: whose run it is, in any of its three views, or by name or path.
        run: as far as its postures are finite.
        rate: samples per second; None: the samples of the run, of which an event has two at one time.

    Returns:
        The motion. Of a planar run `whole_placing` says what the joints that do not turn in the plane do and bear; of a
        walk in space, joints that were held have the torque 0, for nothing is known of it.

    Raises:
        ValueError: the run has no sample with a finite posture.
        RobotError: virtual legs do not reach a pose; of a walk in space, a joint has more than one freedom; one line.
        HypothesisError: of a planar run, the robot is no frontal biped (HR1 to HR5).
    """
    if isinstance(run, SpatialRun):
        return _of_space(robot if isinstance(robot, FreeRobot) else FreeRobot(whole_of(robot)), run, rate)
    return _of_plane(biped_of(robot), run, rate)


def _of_plane(biped: FrontalBiped, trajectory: Trajectory, rate: float | None) -> WholeMotion:
    run = drawable(trajectory)
    if rate is not None:
        run = _smoothly(run, even_times(run.t, rate))
    bears = (run.force[:, 1] > 0.0).astype(float)
    return place_whole_robot(
        biped, PlanarSamples(run.t, run.q, run.dq, run.u, run.phase, run.stance, run.stance_y, run.step, bears)
    )


def _smoothly(run: Trajectory, times: FloatArray) -> Trajectory:
    """What a `PlanarSamples` needs of a run, at other instants (K,) [s]."""
    between = neighbours(run.t, times)
    left, right, s = between.left, between.right, between.weight[:, None]
    h = (run.t[right] - run.t[left])[:, None]
    # where the feet change roles between two samples, both are seen from the foot that stood before
    changed = (run.stance[left] != run.stance[right])[:, None]
    q_0, dq_0, u_0 = run.q[left], run.dq[left], run.u[left]
    q_1, dq_1, u_1 = (np.where(changed, relabel(values[right]), values[right]) for values in (run.q, run.dq, run.u))
    moved = q_1 - q_0
    q = q_0 + s * (h * dq_0 + s * (3.0 * moved - h * (2.0 * dq_0 + dq_1) + s * (h * (dq_0 + dq_1) - 2.0 * moved)))
    slope = 6.0 * s * (1.0 - s) * np.divide(moved, h, out=np.zeros_like(moved), where=h > 0.0)
    dq = slope + (1.0 - s) * (1.0 - 3.0 * s) * dq_0 + s * (3.0 * s - 2.0) * dq_1
    held = {name: getattr(run, name)[left] for name in ("phase", "stance", "stance_y", "step", "force")}
    return replace(run, t=np.asarray(times, dtype=float), q=q, dq=dq, u=(1.0 - s) * u_0 + s * u_1, **held)


def _of_space(free: FreeRobot, trajectory: SpatialRun, rate: float | None) -> WholeMotion:
    run = drawable_part(trajectory)
    if rate is not None:
        run = resample_spatial(run, even_times(run.t, rate))
    full, robot = free.robot.model, free.robot
    q = np.tile(robot.posture, (len(run.t), 1))
    v, tau = np.zeros((len(run.t), full.nv)), np.zeros((len(run.t), full.nv - BASE))
    q[:, :ROOT], v[:, :BASE] = run.q[:, :ROOT], run.v[:, :BASE]
    for i, name in enumerate(run.joint_names):
        joint = full.joints[full.getJointId(name)]
        q[:, joint.idx_q] = run.q[:, ROOT + i]
        v[:, joint.idx_v] = run.v[:, BASE + i]
        tau[:, joint.idx_v - BASE] = run.tau[:, i]
    return WholeMotion(
        robot, run.t, q, v, tau, run.contact, run.wrench, run.phase, run.stance, run.step, held=run.locked
    )
