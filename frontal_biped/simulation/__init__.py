"""Simulation of the full model in closed loop."""

from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.pushes import Push
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.simulate import simulate_walk
from frontal_biped.simulation.trajectory import Trajectory, load_trajectory, save_trajectory

__all__ = [
    "Disturbances",
    "EventKind",
    "Push",
    "SimulationSettings",
    "Trajectory",
    "load_trajectory",
    "save_trajectory",
    "simulate_walk",
]
