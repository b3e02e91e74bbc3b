"""Walk in MuJoCo: another engine, whose contact nobody here wrote, under the same walker."""

from collections.abc import Callable, Mapping
from typing import Any

from frontal_biped.arrays import FloatArray
from frontal_biped.control.walker import Walker
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.trajectory import Trajectory


def walk_in_mujoco(
    plant: FrontalBiped,
    walker: Walker,
    q0: FloatArray,
    dq0: FloatArray,
    settings: SimulationSettings | None = None,
    *,
    errors: Any = None,
    stance: Stance = Stance.LEFT,
    on_step: Callable[[int], None] | None = None,
    gait: Mapping[str, Any] | None = None,
) -> Trajectory:
    """Walk from a state right after an impact.

    Args:
        plant: the robot whose URDF and description MuJoCo's model is built from.
        walker: the controller; it may believe in another robot.
        q0: (4,) stance coordinates after the impact [rad].
        dq0: (4,) their rates [rad/s].
        settings: steps, period, recording and disturbances.
        errors: `ModelErrors` of MuJoCo's bodies.
        stance: the first stance foot.
        on_step: called with the number of completed steps.
        gait: content of the gait file, kept with the run.

    Returns:
        The run; a fall is an outcome, not an error. ``settings["measured"]`` holds foot slip and rotation, double
        support and energy.
    """
    raise NotImplementedError
