"""A walk in space that is steered while it goes, and shown: what a joystick is to a robot.

The walk is one of `walk_in_space`, under the same walker and from sensor readings; only the commands come from outside,
at any tick, and are followed from the next step on.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import PhaseEvent
from frontal_biped.control.spatial_walker.interface import SpatialCommand, SpatialReading
from frontal_biped.control.spatial_walker.walker import SpatialWalker
from frontal_biped.exceptions import SimulationError
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.mujoco.space_engine import SpaceEngine
from frontal_biped.simulation.mujoco.spec import contact_for
from frontal_biped.simulation.settings import PERIOD
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.space.settings import SpatialSettings
from frontal_biped.simulation.space.start import start_in_space
from frontal_biped.simulation.space.walking import heading, walk_in_space

PICTURES = 30.0
"""Shown a second [1/s]."""

KEPT = 1.0
"""Samples a second of the run: nobody reads them, and a walk may be long [1/s]."""

MOST_STEPS = 100_000
"""After which a walk ends: a day of it."""


class Order(NamedTuple):
    """How to walk from the next step on.

    Attributes:
        speed: forwards [m/s].
        lateral: to the left [m/s].
        turn: to the left [rad/s].
    """

    speed: float = 0.0
    lateral: float = 0.0
    turn: float = 0.0


class Picture(NamedTuple):
    """What is seen of the robot at one instant.

    Attributes:
        t: [s].
        q: (nq,) configuration of the `FreeRobot`.
        com: (3,) centre of mass [m].
        yaw: of the pelvis [rad].
        stance: the foot it stands on.
        steps: landings so far.
        foot: (3,) x, y [m] and yaw [rad] of that foot.
        order: that it follows.
        answered: landings when that order was given, and when the first step under it began; -1: not yet.
        refused: why the last order was not taken; "" where it was.
    """

    t: float
    q: FloatArray
    com: FloatArray
    yaw: float
    stance: Stance
    steps: int
    foot: FloatArray
    order: Order
    answered: tuple[int, int]
    refused: str


def walk_steered(
    biped: FrontalBiped,
    gait: Gait,
    orders: Callable[[], Order | None],
    show: Callable[[Picture], None],
    *,
    steps: int = MOST_STEPS,
    stance: Stance = Stance.LEFT,
) -> SpatialRun:
    """Walk in MuJoCo, on the spot at first, as it is told.

    Args:
        biped: the robot.
        gait: its planar gait.
        orders: asked at every tick; a new order, or None.
        show: called with a picture, `PICTURES` times a second of the walk.
        steps: landings after which to stop.
        stance: the first stance foot.

    Returns:
        The run, sampled coarsely; it ends with a fall or after the steps.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        RobotError: a leg has not six joints.
        SimulationError: the legs do not reach the start of the gait.
    """
    free = FreeRobot(biped.robot)
    engine = SpaceEngine(free, PERIOD, None, contact_for(PERIOD, None, None))
    walker = _Steered(SpatialWalker(free, biped, gait, period=PERIOD), engine, orders, show)
    start = start_in_space(free, biped, gait.state_after_impact(), stance)
    settings = SpatialSettings(steps=steps, record_rate=KEPT)
    return walk_in_space(free, walker, start, settings, stance=stance, engine=engine)


class _Steered:
    """A walker that takes orders and has its picture taken."""

    def __init__(
        self,
        walker: SpatialWalker,
        engine: SpaceEngine,
        orders: Callable[[], Order | None],
        show: Callable[[Picture], None],
    ) -> None:
        self._walker, self._engine, self._orders, self._show = walker, engine, orders, show
        self._order, self._refused = Order(), ""
        self._given = self._answered = 0
        self._next = 0.0
        self._steps = 0

    def reset(self, stance: Stance, q: FloatArray, v: FloatArray) -> None:
        """Start right after an impact."""
        self._walker.reset(stance, q, v)

    def command(self, speed: float | None = None, lateral: float | None = None, turn: float | None = None) -> None:
        """As the walker's."""
        self._walker.command(speed, lateral, turn)

    def tick(self, reading: SpatialReading) -> SpatialCommand:
        """The walker's answer, after it has heard what is new."""
        order = self._orders()
        if order is not None:
            try:
                self._walker.command(*order)
                self._order, self._refused = order, ""
                self._given, self._answered = self._steps, -1
            except SimulationError as error:
                self._refused = str(error)
                self._walker.command(*self._order)
        answer = self._walker.tick(reading)
        if answer.event is PhaseEvent.LANDING:
            self._steps += 1
            if self._answered < 0:
                self._answered = self._steps
        if reading.time >= self._next - 1e-9:
            self._next += 1.0 / PICTURES
            self._show(self._picture(reading.time, answer.stance))
        return answer

    def _picture(self, t: float, stance: Stance) -> Picture:
        engine = self._engine
        state, sole = engine.state(), engine.sole(stance)
        foot = np.array([sole.position[0], sole.position[1], heading(sole.rotation)])
        return Picture(
            t,
            state.q.copy(),
            engine.com()[0].copy(),
            heading(engine.base_rotation),
            stance,
            self._steps,
            foot,
            self._order,
            (self._given, self._answered),
            self._refused,
        )
