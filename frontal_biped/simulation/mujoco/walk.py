"""Walk in MuJoCo: another engine, whose contact nobody here wrote, under the same walker.

MuJoCo computes contact, friction and impact; the disturbances are those of our own simulator. The run is a `Trajectory`
like any other, so page, figures and expectations work on it.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Tickable
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.perturbation import ModelErrors
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.loop import PERIOD, SensedLoop
from frontal_biped.simulation.mujoco.model import TIMESTEP, ContactSettings
from frontal_biped.simulation.mujoco.robot import MujocoRobot
from frontal_biped.simulation.pushes import PushForces
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.trajectory import Trajectory

LOWEST = 0.6
"""Height of the centre of mass, relative to upright, below which the robot has fallen."""

TIPPED = 0.5
"""Rotation of a loaded foot beyond which the robot has fallen over it [rad]."""

CLEAR = 5e-4
"""Clearance above old and new ground at which the floor under a swing foot changes its height [m]."""

DIVERGED = "MuJoCo's state is no longer finite"


def walk_in_mujoco(
    plant: FrontalBiped,
    walker: Tickable,
    q0: FloatArray,
    dq0: FloatArray,
    settings: SimulationSettings | None = None,
    *,
    errors: ModelErrors | None = None,
    stance: Stance = Stance.LEFT,
    on_step: Callable[[int], None] | None = None,
    gait: Mapping[str, Any] | None = None,
    contact: ContactSettings | None = None,
) -> Trajectory:
    """Walk from a state right after an impact.

    Args:
        plant: the robot whose URDF and description MuJoCo's model is built from.
        walker: answers readings; it may believe in another robot.
        q0: (4,) stance coordinates after the impact [rad].
        dq0: (4,) their rates [rad/s].
        settings: steps, period (default 1 ms), recording and disturbances.
        errors: of MuJoCo's bodies.
        stance: the first stance foot.
        on_step: called with the number of completed steps.
        gait: content of the gait file, kept with the run.
        contact: contact and physics step; the disturbances' friction takes precedence.

    Returns:
        The run; a fall is an outcome, not an error. ``settings["measured"]`` holds the means and the largest values
        over the steps of what `sensed_loop.Measured` lists: foot slip and rotation, double support, work, effort.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        SimulationError: the physics step does not divide the period.
    """
    chosen = settings or SimulationSettings()
    period = chosen.period or PERIOD
    used = contact or ContactSettings(timestep=period / max(1, round(period / TIMESTEP)))
    if chosen.disturbances.friction is not None:
        used = used._replace(friction=chosen.disturbances.friction)
    engine = _MujocoEngine(plant, errors, used, period)
    run = SensedLoop(engine, plant, walker, chosen, errors).run(q0, dq0, stance, on_step, gait)
    run.settings["contact"] = used._asdict()  # type: ignore[index]
    return run


class _MujocoEngine(MujocoRobot):
    """`MujocoRobot` as the loop wants it: one control period at a time, and an eye on falls."""

    name = "mujoco"

    def __init__(
        self, biped: FrontalBiped, errors: ModelErrors | None, contact: ContactSettings, period: float
    ) -> None:
        super().__init__(biped, errors, contact)
        self._substeps = round(period / contact.timestep)
        if self._substeps < 1 or abs(self._substeps * contact.timestep - period) > 1e-9:
            raise SimulationError(
                f"a physics step of {contact.timestep:g} s does not divide the period of {period:g} s;"
                f" give {period / max(1, round(period / TIMESTEP)):g} s"
            )
        self._lowest = LOWEST * self.upright_height
        self._waiting: dict[Stance, float] = {}

    def read(self) -> tuple[FloatArray, FloatArray, float, float, tuple[bool, bool]]:
        return self.joint_positions, self.joint_velocities, self.base_roll, self.base_roll_rate, self.contact

    def raise_ground(self, stance: Stance, height: float) -> None:
        """As soon as the foot has cleared it."""
        self._waiting[stance] = height

    def advance(self, t: float, tau: FloatArray, pushes: PushForces) -> EventKind | str | None:
        for side, height in list(self._waiting.items()):
            if self.clearance(side) > max(self.ground(side), height) + CLEAR:
                self.set_ground(side, self._waiting.pop(side))
        self.run(tau, self._substeps, pushes.at(t))
        if not np.isfinite(self.data.qpos).all():
            return DIVERGED
        if self.height < self._lowest:
            return EventKind.COLLAPSED
        left, right = self.contact
        for side, touches in ((Stance.LEFT, left), (Stance.RIGHT, right)):
            if touches and abs(self.foot_position(side)[1]) > TIPPED:
                return EventKind.TIPPED_OUTWARDS if self.com_offset(side) < 0.0 else EventKind.EDGE_LANDING
        return None
