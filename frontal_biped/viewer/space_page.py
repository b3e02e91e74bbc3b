"""The page of a walk in space: the whole robot from any side, and its frontal phase portrait running along."""

from typing import Any

from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.simulation.space.resampling import drawable_part
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.viewer.page import Show, exported_page
from frontal_biped.viewer.space_data import space_page_data
from frontal_biped.viewer.space_motion import spatial_pushes
from frontal_biped.viewer.space_scene import draw_space_scene


def space_page(
    robot: FreeRobot,
    run: SpatialRun,
    orbit: Trajectory | None = None,
    title: str | None = None,
    fps: float = 30.0,
    *,
    plots: bool = True,
    theme: str = "auto",
) -> str:
    """One HTML page with the walking robot, its time line, and plots that follow it.

    The page needs no network and opens from a file. It shows the run in a loop and in real time.

    Args:
        robot: the robot.
        run: its walk, at least one sample.
        orbit: the periodic orbit of the gait in closed form (`orbit_trajectory`), drawn below the phase portrait.
        title: of the page; None: the robot's name.
        fps: frames of the motion a second; the page interpolates between them.
        plots: with plots below the robot; the phase portrait is there without.
        theme: "auto" (what the browser prefers), "light" or "dark".

    Returns:
        The page's text, 2 to 4 MB with the meshes of a robot, and 0.01 MB for every second walked.
    """
    return exported_page(space_show(robot, run, orbit, title, fps, plots=plots, theme=theme))


def space_show(
    robot: FreeRobot,
    run: SpatialRun,
    orbit: Trajectory | None = None,
    title: str | None = None,
    fps: float = 30.0,
    *,
    plots: bool = True,
    theme: str = "auto",
) -> Show:
    """What `space_page` shows, for `serve` as well."""
    seen = drawable_part(run)
    pushes = spatial_pushes(robot, seen)
    about = space_page_data(robot, seen, orbit, fps=fps, plots=plots, theme=theme)

    def draw(visualizer: Any) -> None:
        draw_space_scene(visualizer, robot, seen, len(pushes))

    return Show(title or robot.name, about, draw)
