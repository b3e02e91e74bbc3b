"""The whole robot in MuJoCo as a walk wants it: one control period at a time, and an eye on falls."""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.spatial_walker.interface import SpatialReading
from frontal_biped.model.space.errors import SpatialErrors
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.engine import Move
from frontal_biped.simulation.hybrid_system import LOWEST, EventKind
from frontal_biped.simulation.mujoco.space_robot import SpaceRobot
from frontal_biped.simulation.mujoco.spec import ContactSettings, substeps
from frontal_biped.simulation.mujoco.walk import CLEAR, DIVERGED, TIPPED
from frontal_biped.simulation.space.pushes import SpatialPushForces

TOPPLED = np.radians(60.0)
"""Tilt of the root link beyond which the robot has fallen [rad]."""

_LEAST_UPRIGHT = float(np.cos(TOPPLED))

TOPPLED_OVER = "the pelvis tilted by more than 60 degrees"

_LEAST_FLAT = float(np.cos(TIPPED))

_DIVERGED_SPEED = 1e4
"""No robot moves so fast [m/s, rad/s]."""


class SpaceEngine(SpaceRobot):
    """`SpaceRobot` as a walk wants it: one control period at a time, and an eye on falls.

    Args:
        free: the robot of the files.
        period: control period [s].
        errors: how MuJoCo's bodies differ from them.
        contact: contact and physics step, which divides the period.

    Raises:
        SimulationError: the physics step does not divide the period.
    """

    name = "mujoco"

    def __init__(
        self,
        free: FreeRobot,
        period: float,
        errors: SpatialErrors | None = None,
        contact: ContactSettings | None = None,
    ) -> None:
        used = contact or ContactSettings()
        self._substeps = substeps(period, used.timestep)
        super().__init__(free, errors, used)
        self.place(free.posture, np.zeros(free.model.nv))
        self._lowest = LOWEST * float(self.com()[0][2])
        # of the root link, upright at the posture
        self._up = self.base_rotation[2].copy()
        self._waiting: dict[Stance, float] = {}

    def place(self, q: FloatArray, v: FloatArray) -> None:
        """Put the robot at q (nq,), v (nv,) of its `FreeRobot`, on level ground at z = 0."""
        super().place(q, v)
        self._waiting = {}

    def read(self, t: float) -> SpatialReading:
        """True values of everything a sensor measures."""
        return SpatialReading(
            t,
            self.joint_positions,
            self.joint_velocities,
            self.base_rotation.copy(),
            self.data.qvel[3:6].copy(),
            self.contact,
        )

    def raise_ground(self, stance: Stance, height: float) -> None:
        """As soon as the foot has cleared it."""
        self._waiting[stance] = height

    def advance(self, t: float, end: float, tau: FloatArray, pushes: SpatialPushForces) -> Move:
        """One control period under commanded joint torques (n,) [N m]; of events only a fall is told."""
        for side, height in list(self._waiting.items()):
            if self.clearance(side) > max(self.ground(side), height) + CLEAR:
                self.set_ground(side, self._waiting.pop(side))
        self.run(tau, self._substeps, pushes.at(t))
        return Move(end, fell=self._fate())

    def _fate(self) -> EventKind | str | None:
        """How the robot has fallen, if it has."""
        data = self.data
        speed = float(data.qvel @ data.qvel)
        if not speed < _DIVERGED_SPEED**2:  # nan is no number below it
            return DIVERGED
        if data.subtree_com[self._root, 2] < self._lowest:
            return EventKind.COLLAPSED
        if data.xmat[self._root, 6:] @ self._up < _LEAST_UPRIGHT:
            return TOPPLED_OVER
        for side, touches in zip(Stance, self.contact, strict=True):
            if touches and self.is_edge_on(side, _LEAST_FLAT):
                return EventKind.EDGE_LANDING
        return None
