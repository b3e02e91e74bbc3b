"""Walks of the whole robot in space: what disturbs it, the loop that walks it, and the run that is recorded."""

from frontal_biped.simulation.space.pushes import SpatialPush
from frontal_biped.simulation.space.run import SpatialRun, load_spatial_run, save_spatial_run
from frontal_biped.simulation.space.settings import SpatialSettings, SpeedChange
from frontal_biped.simulation.space.walk_spatial import walk_spatial

__all__ = [
    "SpatialPush",
    "SpatialRun",
    "SpatialSettings",
    "SpeedChange",
    "load_spatial_run",
    "save_spatial_run",
    "walk_spatial",
]
