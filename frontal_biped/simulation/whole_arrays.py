"""The archive of a run for programs that are not ours: ``frontal-biped export GAIT.json|RUN.npz -o whole.npz``.

A NumPy archive (NPZ) without pickles, time first; ``--rate`` chooses the samples. World: X forward, Y left, Z up,
ground z = 0.

* ``t`` [s]; ``phase`` +1 rising, -1 falling; ``stance`` +1 left, -1 right; ``step``, the index of the step
* ``pinocchio_q``, ``pinocchio_v``, ``pinocchio_tau``: for ``pin.buildModelFromUrdf(URDF, pin.JointModelFreeFlyer())``;
  ``pinocchio_joints``, the joints in the order of ``pinocchio_tau``
* ``mujoco_qpos``, ``mujoco_qvel``, ``mujoco_tau`` (qfrc_applied of the joints): for the URDF compiled by MuJoCo with a
  free joint on its root link; ``mujoco_joints`` likewise
* ``pinocchio_q_names``, ``pinocchio_v_names``, ``pinocchio_tau_names``, ``mujoco_qpos_names``, ``mujoco_qvel_names``,
  ``mujoco_tau_names``: what each column of these six arrays is, with its unit
* ``contact``: 1 where the left, the right foot stands; ``wrench``: of the ground on the left, the right sole, force and
  moment about the origin of the sole's frame, below the ankle, world axes; ``foot_names``, ``wrench_names`` name them
* ``root_link``, the link whose pose leads q; ``held_joints``, the joints at rest at the posture
* ``frontal_q``, ``frontal_dq``: the stance coordinates of the paper [rad, rad/s]
* of a planar run also ``frontal_u`` [N m]; of a walk in space also ``com``, ``com_velocity``, ``sole_position``,
  ``sole_yaw`` as in `SpatialRun`

Of a planar run the torques of joints that are held, and the wrench, follow from inverse dynamics (`whole_placing`); of
a walk in space the torques of joints that are held are not known, and 0.
"""

from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.space.whole_motion import FOOT_NAMES, WholeMotion
from frontal_biped.simulation.space.resampling import drawable_part, resample_spatial
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.whole_names import WRENCH, mujoco_names, pinocchio_names
from frontal_biped.simulation.whole_robot import whole_motion
from frontal_biped.simulation.world import drawable, even_times, resample

_OF_SPACE = ("frontal_q", "frontal_dq", "com", "com_velocity", "sole_position", "sole_yaw")


def planar_arrays(biped: FrontalBiped, trajectory: Trajectory, rate: float | None = None) -> dict[str, Any]:
    """What the archive of a planar run holds; ``rate`` [1/s], None: the samples of the run."""
    run = drawable(trajectory)
    if rate is not None:
        run = resample(run, even_times(run.t, rate))
    return whole_arrays(
        whole_motion(biped, trajectory, rate), {"frontal_q": run.q, "frontal_dq": run.dq, "frontal_u": run.u}
    )


def spatial_arrays(robot: FreeRobot, trajectory: SpatialRun, rate: float | None = None) -> dict[str, Any]:
    """What the archive of a walk in space holds; ``rate`` [1/s], None: the samples of the run."""
    run = drawable_part(trajectory)
    if rate is not None:
        run = resample_spatial(run, even_times(run.t, rate))
    return whole_arrays(whole_motion(robot, trajectory, rate), {name: getattr(run, name) for name in _OF_SPACE})


def whole_arrays(motion: WholeMotion, others: dict[str, FloatArray] | None = None) -> dict[str, Any]:
    """What an archive of a motion holds, and what else is to go into it."""
    ours, theirs = motion.pinocchio, motion.mujoco
    names = {f"pinocchio_{key}_names": np.array(value) for key, value in pinocchio_names(motion.robot).items()}
    names |= {f"mujoco_{key}_names": np.array(value) for key, value in mujoco_names(motion.robot).items()}
    return {
        "t": motion.t,
        "phase": motion.phase,
        "stance": motion.stance,
        "step": motion.step,
        "pinocchio_q": ours.q,
        "pinocchio_v": ours.v,
        "pinocchio_tau": ours.tau,
        "pinocchio_joints": np.array(ours.names),
        "mujoco_qpos": theirs.q,
        "mujoco_qvel": theirs.v,
        "mujoco_tau": theirs.tau,
        "mujoco_joints": np.array(theirs.names),
        **names,
        "contact": motion.contact,
        "wrench": motion.wrench,
        "foot_names": np.array(FOOT_NAMES),
        "wrench_names": np.array(WRENCH),
        "root_link": np.array(motion.root_link),
        "held_joints": np.array(motion.held, dtype=str),
        **(others or {}),
    }
