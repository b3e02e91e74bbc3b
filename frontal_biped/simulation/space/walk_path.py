"""Walk along a path in space, from a stand to a stand, in one call: robot, gait and words in, run out."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from frontal_biped.control.path.follower import FollowerSettings, PathFollower
from frontal_biped.control.path.language import PathError, parse_path
from frontal_biped.control.path.pose import Pose, unwrapped
from frontal_biped.control.spatial_walker.path_walker import PathWalker
from frontal_biped.control.spatial_walker.standing import StandingSettings
from frontal_biped.control.whole_body.settings import WholeBodySettings
from frontal_biped.gait.file import gait_to_dict
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.given import GaitLike, gait_of
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import RobotLike, biped_of
from frontal_biped.model.space.errors import SpatialErrors
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.settings import PERIOD
from frontal_biped.simulation.space.falls import spatial_fall_remedy
from frontal_biped.simulation.space.pushes import SpatialPush
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.space.settings import SpatialSettings
from frontal_biped.simulation.space.start import standing_in_space
from frontal_biped.simulation.space.walking import walk_in_space

MOST_STEPS = 2000
"""Landings after which a path is given up, arrived or not."""


def walk_path(
    robot: RobotLike,
    gait: GaitLike,
    path: str,
    *,
    follower: FollowerSettings | None = None,
    standing: StandingSettings | None = None,
    pushes: tuple[SpatialPush, ...] = (),
    disturbances: Disturbances | None = None,
    errors: SpatialErrors | None = None,
    settings: SpatialSettings | None = None,
    on_step: Callable[[int], None] | None = None,
    content: Mapping[str, Any] | None = None,
) -> SpatialRun:
    """Stand, walk along a path and stand again, every joint free, in MuJoCo, under a `PathWalker`.

    Args:
        robot: the robot, in any of its views, or by name or path.
        gait: the planar gait to walk, a design's result, or by name or path.
        path: its words, see `control.path.language`: "stand 1; forward 2 m; left 1 m; turn 90; stop".
        follower: how fast it is followed, and how near.
        standing: how the robot stands, starts and stops.
        pushes: on any link.
        disturbances: noise, delay, ground and friction; the walker knows the delay.
        errors: of MuJoCo's bodies; the walker does not know them.
        settings: of the walk, in place of pushes and disturbances; its steps are those after which it is given up.
        on_step: called with the number of completed steps.
        content: of a gait file, to be kept with the run; default: the gait's.

    Returns:
        The run; a fall is an outcome, not an error. ``settings["path"]`` holds the words, where the robot was to end,
        where it believes to have ended by its own steps, and where it has.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        PathError: the words make no path.
        RobotError: there is no such robot, a leg has not six joints, or a joint more than one freedom.
        SimulationError: the legs do not reach the stand, or a setting that makes no walk.
        HypothesisError: the robot is no frontal biped (HR1 to HR5).
        GaitFileError: there is no such gait.
    """
    parse_path(path)  # before anything else is done
    biped, gait = biped_of(robot), gait_of(gait)
    free = FreeRobot(biped.robot)
    chosen = settings or SpatialSettings(steps=MOST_STEPS, disturbances=disturbances or Disturbances(), pushes=pushes)
    walker = path_walker(
        free,
        biped,
        gait,
        path,
        follower=follower,
        standing=standing,
        period=chosen.period,
        delay=chosen.disturbances.delay,
    )
    start = standing_in_space(free, biped, gait)
    told = gait_to_dict(gait) if content is None else content
    run = walk_in_space(free, walker, start, chosen, errors=errors, on_step=on_step, gait=told)
    run = with_path(run, walker, path)
    remedy = spatial_fall_remedy(biped, gait, run)
    return run if remedy is None else replace(run, settings={**run.settings, "remedy": remedy})


def path_walker(
    free: FreeRobot,
    biped: FrontalBiped,
    gait: Gait,
    words: str,
    *,
    follower: FollowerSettings | None = None,
    standing: StandingSettings | None = None,
    period: float = PERIOD,
    delay: float = 0.0,
    settings: WholeBodySettings | None = None,
) -> PathWalker:
    """The walker of a path.

    Args:
        free: the robot as the walker believes it to be.
        biped: the same in the plane.
        gait: what to walk.
        words: of the path.
        follower: how fast it is followed, and how near.
        standing: how the robot stands, starts and stops.
        period: time between readings [s].
        delay: from a reading to its torques [s].
        settings: of the whole-body program.

    Raises:
        PathError: the words make no path.
        SimulationError: the delay is no multiple of the period, or the centre of mass turns back along a phase.
        RobotError: a leg has not six joints.
    """
    end = gait.falling.motion(np.array([gait.falling.beta_end])).q[0]
    width = float(biped.joint_positions(end)[-1, 0])
    way = PathFollower(parse_path(words), gait.step(biped).duration, width, follower)
    return PathWalker(free, biped, gait, follower=way, standing=standing, period=period, delay=delay, settings=settings)


def with_path(run: SpatialRun, walker: PathWalker, words: str) -> SpatialRun:
    """A run that knows what came of its path (``settings["path"]``)."""
    kept = {
        "words": words,
        "asked": list(walker.follower.legs[-1].target),
        "corners": [list(leg.target) for leg in walker.follower.legs],
        "odometry": list(walker.odometry),
        "ended": list(ending(run)),
        "arrived": walker.finished,
    }
    return replace(run, settings={**run.settings, "path": kept})


def require_path(words: str, speeds: Mapping[str, float]) -> None:
    """Raise PathError, in one line, for words that make no path, or speeds that go beside them.

    Args:
        words: of a path.
        speeds: by the name of their option; a path says its own.
    """
    parse_path(words)
    for name, value in speeds.items():
        if value:
            raise PathError(
                f"{name} = {value:g} beside a path: write it there, as in 'forward 2 m at 0.2'; leave it out"
            )


def ending(run: SpatialRun) -> Pose:
    """Where a run ends: the middle between both soles, and the mean of where they look."""
    middle = run.sole_position[-1].mean(axis=0)
    yaw = float(run.yaw[-1])
    left, right = (unwrapped(float(angle), yaw) for angle in run.sole_yaw[-1])
    return Pose(float(middle[0]), float(middle[1]), 0.5 * (left + right))


class Miss(NamedTuple):
    """How far one pose is from another.

    Attributes:
        distance: [m].
        angle: [rad].
    """

    distance: float
    angle: float


def missed(run: SpatialRun, what: str = "ended") -> Miss:
    """How far a walk along a path ended from where it was asked to.

    Args:
        run: made by `walk_path`.
        what: "ended", in truth; or "odometry", as the robot believes.
    """
    told = run.settings["path"]
    apart = Pose(*told["asked"]).seen(Pose(*told[what]))
    return Miss(float(np.hypot(apart.x, apart.y)), apart.yaw)
