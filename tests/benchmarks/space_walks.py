"""What the benchmarks of walks in space share: a robot with its gait, short walks of it, and what they come to."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from frontal_biped import load_gait, load_robot
from frontal_biped.control.spatial_walker.interface import SpatialTickable
from frontal_biped.control.spatial_walker.walker import SpatialWalker
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.simulation.space.pushes import SpatialPush
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.space.settings import SpatialSettings
from frontal_biped.simulation.space.start import SpatialState, start_in_space
from frontal_biped.simulation.space.steps import StepTable, step_table
from frontal_biped.simulation.space.walking import walk_in_space


@dataclass(frozen=True)
class Subject:
    """A robot and its stored gait.

    Attributes:
        name: of the robot.
    """

    name: str

    @cached_property
    def biped(self) -> FrontalBiped:
        """From the front."""
        return load_robot(self.name)

    @cached_property
    def free(self) -> FreeRobot:
        """On a free base."""
        return FreeRobot(self.biped.robot)

    @cached_property
    def gait(self) -> Gait:
        """Of the file beside the description."""
        return load_gait(self.biped.path.with_name(f"{self.name}.gait.json"))

    @cached_property
    def duration(self) -> float:
        """T of the gait, in closed form [s]."""
        return float(self.gait.step(self.biped).duration)

    @cached_property
    def mid_fall(self) -> float:
        """beta half-way down [rad]."""
        beta = self.gait.step(self.biped).falling.beta
        return 0.5 * float(beta[0] + beta[-1])

    @cached_property
    def mid_fall_speed(self) -> float:
        """Dbeta there on the orbit [rad/s]."""
        falling = self.gait.step(self.biped).falling
        return float(np.interp(self.mid_fall, falling.beta[::-1], falling.dbeta[::-1]))

    @cached_property
    def start(self) -> SpatialState:
        """Right after an impact of the gait."""
        return start_in_space(self.free, self.biped, self.gait.state_after_impact())

    def walker(self, speed: float = 0.0, **settings: object) -> SpatialWalker:
        """The package's own controller."""
        return SpatialWalker(self.free, self.biped, self.gait, speed=speed, **settings)

    def walk(self, walker: SpatialTickable, steps: int, pushes: tuple[SpatialPush, ...] = ()) -> SpatialRun:
        """A walk from the start of the gait, in MuJoCo, from exact sensors."""
        return walk_in_space(self.free, walker, self.start, SpatialSettings(steps=steps, pushes=pushes))

    def table(self, run: SpatialRun) -> StepTable:
        """Of the run's whole steps."""
        return step_table(run, self.mid_fall)


def torque_squared(run: SpatialRun, since: float) -> tuple[float, float]:
    """Integral of |tau|^2 over a walk after a time [s], per second [N^2 m^2] and per metre [N^2 m s]."""
    late = run.t >= since
    t, power = run.t[late], np.sum(run.tau[late] ** 2, axis=1)
    work = float(np.trapezoid(power, t))
    way = float(np.linalg.norm(run.com[late][-1, :2] - run.com[late][0, :2]))
    return work / float(t[-1] - t[0]), work / way if way > 0.05 else float("nan")
