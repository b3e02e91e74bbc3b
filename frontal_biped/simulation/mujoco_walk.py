"""Walk in MuJoCo: another engine, whose contact nobody here wrote, under the same walker."""

from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.phase_machine import PhaseEvent
from frontal_biped.control.walker import Reading, Walker
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.frontal_chain import UPRIGHT
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.mujoco_model import (
    BASE_JOINTS,
    LINKS,
    ContactSettings,
    body_ids,
    floor_of,
    import_mujoco,
    mujoco_model,
    sole_of,
)
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.trajectory import SAMPLED, Trajectory
from frontal_biped.virtual_constraints.phase import StepPhase
