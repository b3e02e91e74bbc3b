"""A walk in space at other instants."""

from dataclasses import replace
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.simulation.space.run import SAMPLED, SpatialRun
from frontal_biped.simulation.world import neighbours, rows_before_divergence

_HELD = ("contact", "phase", "stance", "step", "speed_target", "solved", "foothold")
_ANGLES = ("sole_yaw", "yaw")
_INTERPOLATED = tuple(name for name in SAMPLED if name not in ("t", "q", *_HELD, *_ANGLES))


def resample_spatial(run: SpatialRun, times: FloatArray) -> SpatialRun:
    """The run at other instants, interpolated between samples but not across events.

    Args:
        run: the run; its two samples at one event time bound the phases.
        times: (K,) instants in the run's own time, increasing [s].

    Returns:
        The run at these instants, events unchanged.
    """
    between = neighbours(run.t, times)
    arrays: dict[str, Any] = {"t": np.asarray(times, dtype=float)}
    arrays |= {name: between.mix(getattr(run, name)) for name in _INTERPOLATED}
    arrays |= {name: between.mix(np.unwrap(getattr(run, name), axis=0)) for name in _ANGLES}
    arrays |= {name: getattr(run, name)[between.left] for name in _HELD}
    q = between.mix(np.column_stack([run.q[:, :3], same_hemisphere(run.q[:, 3:7]), run.q[:, 7:]]))
    q[:, 3:7] /= np.linalg.norm(q[:, 3:7], axis=1, keepdims=True)
    return replace(run, q=q, **arrays)


def same_hemisphere(quaternions: FloatArray) -> FloatArray:
    """Quaternions (T, 4) of the same rotations, each on the side of the one before it: free of jumps of sign."""
    flips = np.sign(np.einsum("ti,ti->t", quaternions[1:], quaternions[:-1]))
    signs = np.cumprod(np.concatenate([[1.0], np.where(flips == 0.0, 1.0, flips)]))
    return quaternions * signs[:, None]


def drawable_part(run: SpatialRun) -> SpatialRun:
    """The run as far as it can be drawn: up to where the robot has diverged, gaps filled with zeros.

    Raises:
        ValueError: the run has no sample that can be drawn.
    """
    count = rows_before_divergence(run.t, run.q)
    return replace(run, **{name: np.nan_to_num(getattr(run, name)[:count]) for name in SAMPLED})
