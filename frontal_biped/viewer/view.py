"""`view`: the page of a robot, a gait or a run, inline in a notebook, or saved as a file."""

import html
from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Any

from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.files.atomic import write_text
from frontal_biped.files.kinds import RUN, SPACE_RUN, archive_format
from frontal_biped.gait.file import gait_of_run, gait_to_dict
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.given import Designed, gait_of
from frontal_biped.gait.told_robot import told_robot
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import RobotLike, biped_of, is_robot, whole_of
from frontal_biped.model.robot import Robot
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.simulation.orbit import VIEWED_STEPS, orbit_trajectory
from frontal_biped.simulation.space.run import SpatialRun, load_spatial_run
from frontal_biped.simulation.trajectory import Trajectory, load_trajectory
from frontal_biped.viewer.joints_page import joints_page
from frontal_biped.viewer.page import exported_page, planar_show
from frontal_biped.viewer.scene import cast
from frontal_biped.viewer.space_page import space_show

HEIGHT = 640
"""Of the frame in a notebook [px]."""

Viewed = RobotLike | Gait | Designed | Trajectory | SpatialRun
"""What `view` takes."""


class View:
    """A page that opens offline in any browser: a notebook shows it inline, `save` writes it.

    Args:
        title: of what is shown.
        draw: makes the page's text; asked once, when it is needed.
    """

    def __init__(self, title: str, draw: Callable[[], str]) -> None:
        self.title, self._draw = title, draw

    @cached_property
    def html(self) -> str:
        """The text of the page, 1 to 4 MB."""
        return self._draw()

    def save(self, path: Path | str) -> Path:
        """Write the page; the file appears whole or not at all.

        Returns:
            The file.
        """
        write_text(Path(path), self.html)
        return Path(path)

    def _repr_html_(self) -> str:
        # a frame of its own, which is nobody's origin: page and notebook cannot touch each other
        return (
            f'<iframe srcdoc="{html.escape(self.html)}" sandbox="allow-scripts" title="{html.escape(self.title)}"'
            f' style="width:100%;height:{HEIGHT}px;border:0"></iframe>'
        )

    def __repr__(self) -> str:
        return f"View of {self.title}; save('page.html') writes the page"


def view(
    what: Viewed,
    robot: RobotLike | None = None,
    *,
    beside: Viewed | None = None,
    overlay: bool = False,
    ghost: bool = False,
) -> View:
    """The page of a robot, a gait, a run in the plane or a walk in space.

    Args:
        what: a robot in any of its views, a gait, a design's result, a run; or a name or path: of a robot, as ``g1``,
            or of a gait or run file. A gait is shown by its periodic orbit.
        robot: whose gait or run it is; default: the one that it names, as its files have it.
        beside: a second gait or run in the plane, of the same robot where one is given.
        overlay: the second one translucent over the first.
        ghost: in the plane, the desired posture as well, translucent.

    Returns:
        The page; nothing is drawn before it is shown or saved.

    Raises:
        FrontalBipedError: it is none of these, or its robot is not to be found or not the one of the gait; one line.
    """
    thing = _loaded(what)
    if isinstance(thing, Trajectory | Gait):
        first = _planar(thing, robot)
        if overlay and beside is None:
            raise FrontalBipedError("overlay: lays a second run over the first; name one with beside")
        second = None
        if beside is not None:
            other = _loaded(beside)
            if not isinstance(other, Trajectory | Gait):
                raise FrontalBipedError(
                    f"beside = {type(other).__name__}: not a gait or a run in the plane; give one of these"
                )
            second = _planar(other, robot)
        title = first[0].name if second is None else f"{first[0].name} and {second[0].name}"
        return View(title, lambda: _planar_page(title, first, second, ghost, overlay))
    if beside is not None or overlay or ghost:
        raise FrontalBipedError(f"a {type(thing).__name__} is shown alone; leave out beside, overlay and ghost")
    if isinstance(thing, SpatialRun):
        return _spatial(thing, robot)
    whole = whole_of(thing)
    return View(whole.name, lambda: joints_page(thing if isinstance(thing, FreeRobot) else FreeRobot(whole)))


def _loaded(what: Any) -> Robot | FrontalBiped | FreeRobot | Gait | Trajectory | SpatialRun:
    if isinstance(what, Robot | FrontalBiped | FreeRobot | Trajectory | SpatialRun):
        return what
    if isinstance(what, str | Path):
        path = Path(what)
        if is_robot(path):
            return whole_of(what)
        kind = archive_format(path)
        if kind == SPACE_RUN:
            return load_spatial_run(path)
        if kind == RUN or path.suffix == ".npz":
            return load_trajectory(path)
    return gait_of(what)


def _planar(thing: Trajectory | Gait, robot: RobotLike | None) -> tuple[FrontalBiped, Trajectory]:
    """The robot and its run; of a gait the periodic orbit."""
    if isinstance(thing, Trajectory):
        return (told_robot(thing.gait, thing.robot) if robot is None else biped_of(robot)), thing
    biped = biped_of(robot) if robot is not None else told_robot(gait_to_dict(thing), thing.robot.name)
    return biped, orbit_trajectory(biped, thing, VIEWED_STEPS)


def _planar_page(
    title: str,
    first: tuple[FrontalBiped, Trajectory],
    second: tuple[FrontalBiped, Trajectory] | None,
    ghost: bool,
    overlay: bool,
) -> str:
    return exported_page(planar_show(title, cast(*first, ghost=ghost, beside=second, overlay=overlay)))


def _spatial(run: SpatialRun, robot: RobotLike | None) -> View:
    biped = told_robot(run.gait, run.robot) if robot is None else biped_of(robot)
    free = FreeRobot(biped.robot)
    if free.joint_names != run.joint_names:
        raise FrontalBipedError(
            f"the walk has {len(run.joint_names)} joints, {free.name} moves {len(free.joint_names)}, or in another"
            " order; give its robot: view(run, robot)"
        )
    gait = gait_of_run(run.gait, "the gait of the run")

    def page() -> str:
        return exported_page(space_show(free, run, None if gait is None else orbit_trajectory(biped, gait, 1)))

    return View(free.name, page)
