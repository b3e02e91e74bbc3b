"""Simulation of the full model in closed loop, and what a run is.

Walks in space bring controllers and engines that no planar walk needs: they are imported when first asked for.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.event_driven import simulate_walk
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.orbit import orbit_trajectory
from frontal_biped.simulation.pushes import Push
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.space.pushes import SpatialPush
from frontal_biped.simulation.space.run import SpatialRun, load_spatial_run, save_spatial_run
from frontal_biped.simulation.space.settings import SpatialSettings, SpeedChange
from frontal_biped.simulation.trajectory import Trajectory, load_trajectory, save_trajectory
from frontal_biped.simulation.walking import simulate
from frontal_biped.simulation.whole_robot import whole_motion
from frontal_biped.simulation.world import world_configurations, world_motion

if TYPE_CHECKING:
    from frontal_biped.simulation.space.walk_path import walk_path
    from frontal_biped.simulation.space.walk_spatial import walk_spatial

__all__ = [
    "Disturbances",
    "EventKind",
    "Push",
    "SimulationSettings",
    "SpatialPush",
    "SpatialRun",
    "SpatialSettings",
    "SpeedChange",
    "Trajectory",
    "load_spatial_run",
    "load_trajectory",
    "orbit_trajectory",
    "save_spatial_run",
    "save_trajectory",
    "simulate",
    "simulate_walk",
    "walk_path",
    "walk_spatial",
    "whole_motion",
    "world_configurations",
    "world_motion",
]


def __getattr__(name: str) -> Any:
    if name not in ("walk_path", "walk_spatial"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.space.{name}"), name)
    globals()[name] = value  # asked for once; and pdoc looks into the module's dictionary
    return value
