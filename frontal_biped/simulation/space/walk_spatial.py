"""Walk a planar gait in space, in one call: robot and gait in, run out."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from frontal_biped.control.joint_law import JointLaw
from frontal_biped.control.spatial_walker.interface import SpatialTickable
from frontal_biped.control.spatial_walker.law_walker import SpatialLawWalker
from frontal_biped.control.spatial_walker.walker import SpatialWalker
from frontal_biped.gait.file import gait_to_dict
from frontal_biped.gait.given import GaitLike, gait_of
from frontal_biped.model.catalogue import RobotLike, biped_of
from frontal_biped.model.space.errors import SpatialErrors
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.space.falls import spatial_fall_remedy
from frontal_biped.simulation.space.pushes import SpatialPush
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.space.settings import SpatialSettings, SpeedChange
from frontal_biped.simulation.space.start import start_in_space
from frontal_biped.simulation.space.walking import walk_in_space


def walk_spatial(
    robot: RobotLike,
    gait: GaitLike,
    *,
    speed: float = 0.0,
    lateral: float = 0.0,
    turn: float = 0.0,
    steps: int = 20,
    commands: tuple[SpeedChange, ...] = (),
    pushes: tuple[SpatialPush, ...] = (),
    disturbances: Disturbances | None = None,
    errors: SpatialErrors | None = None,
    settings: SpatialSettings | None = None,
    walker: SpatialWalker | None = None,
    controller: JointLaw | None = None,
    stance: Stance = Stance.LEFT,
    on_step: Callable[[int], None] | None = None,
    content: Mapping[str, Any] | None = None,
) -> SpatialRun:
    """Walk a gait with every joint free, in MuJoCo, under a `SpatialWalker` that sees sensor readings only.

    The walk starts right after an impact of the gait, feet side by side, on the spot; the speed is approached from the
    first step on, by what one step may change it.

    Args:
        robot: the robot, in any of its views, or by name or path.
        gait: the planar gait to walk, a design's result, or by name or path.
        speed: forwards [m/s].
        lateral: to the left [m/s].
        turn: to the left [rad/s].
        steps: landings after which to stop.
        commands: later changes of speed.
        pushes: on any link.
        disturbances: noise, delay, ground and friction; the walker knows the delay.
        errors: of MuJoCo's bodies; the walker does not know them.
        settings: of the walk, in place of steps, commands, pushes and disturbances.
        walker: in place of one made here.
        controller: your own instead: a function of (t, q, v) that returns the torque of every joint that moves, by
            name, as `joint_law` says.
        stance: the first stance foot.
        on_step: called with the number of completed steps.
        content: of a gait file, to be kept with the run; default: the gait's.

    Returns:
        The run; a fall is an outcome, not an error, and ``settings["remedy"]`` says what to change where that is
        known.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        RobotError: there is no such robot, a leg has not six joints, or a joint more than one freedom.
        SimulationError: the legs do not reach the start of the gait, or a setting that makes no walk.
        HypothesisError: the robot is no frontal biped (HR1 to HR5).
        ControllerError: your controller fails, or returns no torques; one line.
        GaitFileError: there is no such gait.
        DesignFailedError: the design found none.
    """
    biped, gait = biped_of(robot), gait_of(gait)
    free = FreeRobot(biped.robot)
    chosen = settings or SpatialSettings(
        steps=steps, disturbances=disturbances or Disturbances(), pushes=pushes, commands=commands
    )
    used: SpatialTickable = (
        SpatialLawWalker(free, controller, chosen.period)
        if controller is not None
        else walker
        or SpatialWalker(free, biped, gait, period=chosen.period, speed=speed, delay=chosen.disturbances.delay)
    )
    if lateral or turn:
        used.command(lateral=lateral, turn=turn)
    start = start_in_space(free, biped, gait.state_after_impact(), stance)
    told = gait_to_dict(gait) if content is None else content
    run = walk_in_space(free, used, start, chosen, stance=stance, errors=errors, on_step=on_step, gait=told)
    remedy = None if controller is not None else spatial_fall_remedy(biped, gait, run)
    return run if remedy is None else replace(run, settings={**run.settings, "remedy": remedy})
