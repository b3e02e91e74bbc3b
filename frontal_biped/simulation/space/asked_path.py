"""The way that a walk along a path was asked to take, as its run file has it."""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.trajectory import FARTHEST


def asked_corners(run: SpatialRun) -> FloatArray:
    """(n, 2) start and corners of the way on the ground, n at least 2 [m]; (0, 2) of a run that tells none.

    Settings of a run file are not checked when it is read: what is no list of places tells none.
    """
    none = np.zeros((0, 2))
    told = run.settings.get("path")
    corners = told.get("corners") if isinstance(told, dict) else None
    try:
        places = np.array(corners, dtype=float)
    except (TypeError, ValueError):
        return none
    if places.ndim != 2 or places.shape[1] != 3 or not (np.abs(places) <= FARTHEST).all():
        return none
    way = np.concatenate([np.zeros((1, 2)), places[:, :2]])
    moved = np.append(True, np.linalg.norm(np.diff(way, axis=0), axis=1) > 0.0)
    return way[moved] if moved.sum() > 1 else none
