"""Walk in MuJoCo: another engine, whose contact nobody here wrote, under the same walker.

MuJoCo computes contact, friction and impact; the disturbances are those of our own simulator. The run is a `Trajectory`
like any other, so page, figures and expectations work on it.
"""

from dataclasses import replace
from math import isfinite
from typing import Unpack

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Reading, Tickable
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.perturbation import ModelErrors
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.engine import Move, first_foothold
from frontal_biped.simulation.hybrid_system import LOWEST, EventKind
from frontal_biped.simulation.mujoco.robot import MujocoRobot
from frontal_biped.simulation.mujoco.spec import ContactSettings, contact_for, substeps
from frontal_biped.simulation.pushes import PushForces
from frontal_biped.simulation.sensed import WalkOptions, walk_in
from frontal_biped.simulation.settings import PERIOD, SimulationSettings
from frontal_biped.simulation.trajectory import Trajectory

TIPPED = 0.5
"""Rotation of a loaded foot beyond which the robot has fallen over it [rad]."""

CLEAR = 5e-4
"""Clearance above old and new ground at which the floor under a swing foot changes its height [m]."""

BOTH = tuple(Stance)
"""The feet in the order of the contact flags."""

DIVERGED = "MuJoCo's state is no longer finite"


def walk_in_mujoco(
    biped: FrontalBiped,
    walker: Tickable,
    start: State,
    settings: SimulationSettings | None = None,
    *,
    errors: ModelErrors | None = None,
    contact: ContactSettings | None = None,
    **options: Unpack[WalkOptions],
) -> Trajectory:
    """`walk_in` MuJoCo, whose model is built from the robot's URDF and description.

    Args:
        biped: the robot.
        walker: answers readings; it may believe in another robot.
        start: state after the impact.
        settings: steps, period, recording and disturbances.
        errors: of MuJoCo's bodies.
        contact: contact and physics step; the disturbances' friction takes precedence.
        options: first foot, progress, gait: see `WalkOptions`.

    Returns:
        The run; a fall is an outcome, not an error.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        SimulationError: the physics step does not divide the period.
    """
    chosen = settings or SimulationSettings()
    period = chosen.period or PERIOD
    used = contact_for(period, contact, chosen.disturbances.friction)
    engine = MujocoEngine(biped, errors, used, period)
    run = walk_in(engine, biped, walker, start, chosen, errors, **options)
    return replace(run, settings={**run.settings, "contact": used._asdict()})


class MujocoEngine(MujocoRobot):
    """`MujocoRobot` as the loop wants it: one control period at a time, and an eye on falls."""

    name = "mujoco"

    def __init__(
        self, biped: FrontalBiped, errors: ModelErrors | None, contact: ContactSettings, period: float
    ) -> None:
        super().__init__(biped, errors, contact)
        self._substeps = substeps(period, contact.timestep)
        self._lowest = LOWEST * self.upright_height
        self._waiting: dict[Stance, float] = {}

    def place(self, stance: Stance, state: State) -> None:
        """Stand on a foot right after an impact; the feet are level about y = 0."""
        self.stand(stance, state, first_foothold(self.biped, stance, state.q))

    def read(self, t: float) -> Reading:
        """True values of everything a sensor measures."""
        q, dq = self._qpos, self._qvel
        roll, rate = q.item(self._roll_q), dq.item(self._roll_v)
        return Reading(t, q.take(self._q_at), dq.take(self._v_at), roll, rate, self.contact)

    def raise_ground(self, stance: Stance, height: float) -> None:
        """As soon as the foot has cleared it."""
        self._waiting[stance] = height

    def advance(self, t: float, end: float, tau: FloatArray, pushes: PushForces) -> Move:
        """One control period under joint torques (4,) [N m]; of events only a fall is told."""
        for side, height in list(self._waiting.items()) if self._waiting else ():
            if self.clearance(side) > max(self.ground(side), height) + CLEAR:
                self.set_ground(side, self._waiting.pop(side))
        self.run(tau, self._substeps, pushes.at(t) if pushes.any else [])
        return Move(end, fell=self._fate())

    def _fate(self) -> EventKind | str | None:
        """How the robot has fallen, if it has."""
        if not isfinite(sum(self._qpos.tolist())):
            return DIVERGED
        if self._center_of_mass.item(2) < self._lowest:
            return EventKind.COLLAPSED
        for side, touches in zip(BOTH, self.contact, strict=True):
            if touches and abs(self.foot_rotation(side)) > TIPPED:
                return EventKind.TIPPED_OUTWARDS if self.com_offset(side) < 0.0 else EventKind.EDGE_LANDING
        return None
