"""One figure of a run, by its name: what ``run.plot()`` shows."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from frontal_biped.exceptions import UnknownNameError
from frontal_biped.figures.space import space_figure_makers
from frontal_biped.figures.write import figure_makers
from frontal_biped.gait.file import gait_of_run
from frontal_biped.gait.told_robot import told_robot
from frontal_biped.model.catalogue import RobotLike, biped_of
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.numerics.by_name import suggestion
from frontal_biped.simulation.orbit import orbit_trajectory
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plot(run: Trajectory | SpatialRun, name: str | None = None, robot: RobotLike | None = None) -> "Figure":
    """A figure of a run, in the plane or in space.

    Args:
        run: the run.
        name: of `FIGURES`, where the run tells its gait, else of those that need none; of a walk in space of
            `SPACE_FIGURES`; None: the first.
        robot: whose run it is; None: the robot that the run names.

    Raises:
        UnknownNameError: the run has no such figure.
        RobotError: the robot is not found.
        MissingExtraError: Matplotlib is not installed.
    """
    biped = told_robot(run.gait, run.robot) if robot is None else biped_of(robot)
    gait = gait_of_run(run.gait, "the gait of the run")
    makers: Mapping[str, Callable[[], Figure]]
    if isinstance(run, SpatialRun):
        orbit = None if gait is None else orbit_trajectory(biped, gait, 1)
        makers = space_figure_makers(FreeRobot(biped.robot), run, gait, orbit)
    else:
        makers = figure_makers(biped, gait, run)
    chosen = next(iter(makers)) if name is None else name
    if chosen not in makers:
        raise UnknownNameError(f"no figure {chosen!r} of this run; {suggestion(chosen, tuple(makers))}")
    return makers[chosen]()
