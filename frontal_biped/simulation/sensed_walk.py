"""Walk in the event-driven simulator under a walker that sees sensor readings only."""

from collections.abc import Callable, Mapping
from typing import Any

from frontal_biped.arrays import FloatArray
from frontal_biped.control.walker import Walker
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.trajectory import Trajectory


def walk_sensed(
    plant: FrontalBiped,
    walker: Walker,
    q0: FloatArray,
    dq0: FloatArray,
    settings: SimulationSettings | None = None,
    *,
    stance: Stance = Stance.LEFT,
    on_step: Callable[[int], None] | None = None,
    gait: Mapping[str, Any] | None = None,
) -> Trajectory:
    """Walk from a state right after an impact; as `walk_in_mujoco`, with rigid impacts and ``plant`` as it is."""
    raise NotImplementedError
