"""`frontal-biped walk`: the whole robot in space, from whatever there is of it, on the spot or along a path."""

import argparse
import sys
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Any

from frontal_biped.cli.arguments import (
    add_json,
    add_output,
    add_page,
    add_value,
    add_verbose,
    finite_float,
    folder,
    not_negative_float,
    positive_float,
    positive_int,
    whole_number,
)
from frontal_biped.cli.exit_status import SUCCESS, TASK_FAILED
from frontal_biped.cli.output import emit, report, require_output
from frontal_biped.cli.progress import Progress
from frontal_biped.files.counted import counted

if TYPE_CHECKING:
    from frontal_biped.simulation.space.pushes import SpatialPush
    from frontal_biped.simulation.space.run import SpatialRun

SUMMARY = "Walk with every joint free, in MuJoCo, under the frontal law; exit status 1 if the robot falls."
EXAMPLE = "frontal-biped walk talos_full --speed 0.2 --steps 10 --html walk.html -o walk.npz"

_ROBOT = (
    "name or description of a robot, or a bare URDF: what is missing, a description, bent knees, a gait, is made and"
    " kept beside the run"
)
_PUSH = (
    "impulse forwards and to the left (N s), and when it begins (s; left out: half-way through the fifth step); 0.1 s"
    " long, on the root link; as often as wanted"
)
_PATH = (
    "instead of N steps: stand, walk along a path, stand again; commands 'stand T', 'forward X', 'back X', 'left X',"
    " 'right X' (m), 'turn A' (degrees, to the left) and 'stop', with ; between them, a walk with 'at V' if it is to be"
    " slower or faster (m/s, degrees/s)"
)
PUSHED_FOR = 0.1
"""Duration of a push [s]."""

PUSHED_IN_STEP = 4.5
"""When a push begins that does not say, in steps."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Robot and gait, how it walks, what disturbs it, where to write."""
    parser.add_argument("robot", metavar="ROBOT", help=_ROBOT)
    parser.add_argument("--gait", metavar="GAIT.json", type=Path, help="default: the stored one, or one designed")
    add_value(parser, "--speed", "V", finite_float, "0", "mean speed forwards, m/s; below 0 backwards")
    add_value(parser, "--lateral", "V", finite_float, "0", "to the left, m/s")
    add_value(parser, "--turn", "RATE", finite_float, "0", "to the left, rad/s")
    add_value(parser, "--steps", "N", positive_int, "20", "steps to walk")
    parser.add_argument("--path", metavar="WORDS", help=_PATH)
    parser.add_argument("--push", metavar="X,Y[,T]", action="append", type=_push, default=[], help=_PUSH)
    add_value(parser, "--encoder-noise", "S", not_negative_float, "0", "standard deviation, rad")
    add_value(parser, "--imu-noise", "S", not_negative_float, "0", "of the pelvis' orientation, rad")
    add_value(parser, "--gyro-noise", "S", not_negative_float, "0", "of its rates, rad/s")
    add_value(parser, "--torque-noise", "S", not_negative_float, "0", "standard deviation, relative")
    add_value(parser, "--delay", "S", not_negative_float, "0", "from a reading to its torques, s; whole milliseconds")
    add_value(parser, "--ground", "H", not_negative_float, "0", "footholds within plus and minus this, m")
    add_value(parser, "--friction", "MU", positive_float, "0.8", "of the ground")
    add_value(parser, "--seed", "N", whole_number, "0", "of everything random")
    add_page(parser, "write the walk as one offline page")
    parser.add_argument("--figures", metavar="DIR", type=folder, help="write its figures into a folder")
    add_output(parser, "RUN.npz", "run file to write")
    add_verbose(parser)
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Make what is missing, walk, write what was asked for, print what it came to."""
    from frontal_biped.design.preparation import prepare_to_walk
    from frontal_biped.files.atomic import require_folder
    from frontal_biped.gait.file import gait_to_dict
    from frontal_biped.simulation.disturbances import Disturbances
    from frontal_biped.simulation.space.run import save_spatial_run
    from frontal_biped.simulation.space.walk_path import require_path, walk_path
    from frontal_biped.simulation.space.walk_spatial import walk_spatial

    if arguments.path is not None:
        require_path(arguments.path, {key: getattr(arguments, key) for key in ("speed", "lateral", "turn")})
    require_output(arguments.output, arguments.gait, robot=arguments.robot)
    require_output(arguments.html, arguments.gait, arguments.output, robot=arguments.robot)
    if arguments.figures is not None:
        require_folder(arguments.figures)
    kept = next((path.parent for path in (arguments.output, arguments.html) if path is not None), Path())
    ready = prepare_to_walk(arguments.robot, kept, arguments.gait, _tell)
    step = ready.gait.orbit.step_duration
    disturbances = Disturbances(
        encoder_noise=arguments.encoder_noise,
        torque_noise=arguments.torque_noise,
        imu_noise=arguments.imu_noise,
        gyro_noise=arguments.gyro_noise,
        delay=arguments.delay,
        ground_height=arguments.ground,
        friction=arguments.friction,
        seed=arguments.seed,
    )
    common: dict[str, Any] = {
        "pushes": tuple(_pushed(push, step) for push in arguments.push),
        "disturbances": disturbances,
        "content": gait_to_dict(ready.gait),
    }
    if arguments.path is not None:
        with Progress(f"{ready.biped.name} walking: step") as progress:
            walk = walk_path(
                ready.biped,
                ready.gait,
                arguments.path,
                on_step=lambda done: progress.update(f"{done}"),
                **common,
            )
    else:
        with Progress(f"{ready.biped.name} walking: step", arguments.steps) as progress:
            walk = walk_spatial(
                ready.biped,
                ready.gait,
                speed=arguments.speed,
                lateral=arguments.lateral,
                turn=arguments.turn,
                steps=arguments.steps,
                on_step=lambda done: progress.update("", done),
                **common,
            )
    written = [str(path) for path in ready.made]
    if arguments.output is not None:
        save_spatial_run(walk, arguments.output)
        written.append(str(arguments.output))
    if arguments.html is not None or arguments.figures is not None:
        written += _shown(arguments, ready.biped, ready.gait, walk)
    remedy = walk.settings.get("remedy")
    table = {**_summary(walk, arguments.speed), **_of_path(walk), "remedy": remedy, "written": written}
    asked = walk.steps_completed if arguments.path is not None and not walk.fell else arguments.steps
    emit(arguments, table, report(arguments, _head(walk, asked, remedy), [_text(table)], written))
    return TASK_FAILED if walk.fell else SUCCESS


def _shown(arguments: argparse.Namespace, biped: Any, gait: Any, walk: "SpatialRun") -> list[str]:
    from frontal_biped.figures.space import write_space_figures
    from frontal_biped.files.atomic import write_text
    from frontal_biped.model.space.free_robot import FreeRobot
    from frontal_biped.simulation.orbit import orbit_trajectory
    from frontal_biped.viewer.page import exported_page
    from frontal_biped.viewer.space_page import space_show

    free, orbit = FreeRobot(biped.robot), orbit_trajectory(biped, gait, 1)
    written = []
    if arguments.html is not None:
        with Progress("drawing the page"):
            write_text(arguments.html, exported_page(space_show(free, walk, orbit)))
        written.append(str(arguments.html))
    if arguments.figures is not None:
        with Progress("drawing the figures"):
            written += [str(path) for path in write_space_figures(arguments.figures, free, walk, gait, orbit)]
    return written


def _tell(line: str) -> None:
    sys.stderr.write(f"frontal-biped: {line}\n")


def _push(text: str) -> tuple[float, float, float | None]:
    parts = text.split(",")
    if len(parts) not in (2, 3):
        raise argparse.ArgumentTypeError(f"{text!r} is no push; write X,Y or X,Y,T, for example 0,10 or 5,-5,3.2")
    numbers = [finite_float(part) for part in parts]
    if len(numbers) == 3:
        return numbers[0], numbers[1], not_negative_float(parts[2])
    return numbers[0], numbers[1], None


def _pushed(push: tuple[float, float, float | None], step: float) -> "SpatialPush":
    from frontal_biped.simulation.space.pushes import SpatialPush

    x, y, start = push
    return SpatialPush(PUSHED_IN_STEP * step if start is None else start, PUSHED_FOR, (x, y, 0.0))


def _summary(run: "SpatialRun", speed: float) -> dict[str, Any]:
    measured = run.settings.get("measured", {})
    duration = float(run.t[-1])
    half = len(run.t) // 2
    walked = float(run.com[-1, 0] - run.com[0, 0])
    late = float(run.com[-1, 0] - run.com[half, 0]) / max(float(run.t[-1] - run.t[half]), 1e-9)
    return {
        "robot": run.robot,
        "outcome": run.outcome,
        "steps_completed": run.steps_completed,
        "duration": duration,
        "distance": walked,
        "sideways": float(run.com[-1, 1] - run.com[0, 1]),
        "commanded_speed": speed,
        "speed_of_second_half": late,
        "yaw_drift": float(run.yaw[-1] - run.yaw[0]),
        "torque_share": measured.get("torque_share"),
        "speed_share": measured.get("speed_share"),
        "self_collision": measured.get("self_collision"),
        "controller": run.settings.get("controller"),
    }


def _of_path(run: "SpatialRun") -> dict[str, Any]:
    """What came of a path; nothing where there was none."""
    from frontal_biped.simulation.space.walk_path import missed

    told = run.settings.get("path")
    if told is None:
        return {}
    ended, odometry = missed(run), missed(run, "odometry")
    return {
        "path": told,
        "missed": ended.distance,
        "missed_angle": ended.angle,
        "missed_by_odometry": odometry.distance,
        "missed_angle_by_odometry": odometry.angle,
    }


def _head(run: "SpatialRun", asked: int, remedy: str | None) -> list[str]:
    """What was reached, what is tightest, what it needed of the motors."""
    measured = run.settings.get("measured", {})
    fate = "walked" if not run.fell else f"FELL ({run.outcome}) after"
    way = round(float(run.com[-1, 0] - run.com[0, 0]), 2) + 0.0  # no minus zero
    steps = counted(run.steps_completed, "step")
    reached = f"{run.robot}: {fate} {steps} of {asked}, {way:.2f} m in {float(run.t[-1]):.2f} s"
    if "path" in run.settings:
        reached = f"{run.robot}: {fate} {steps} along the path in {float(run.t[-1]):.2f} s, {_end(run)}"
    shares = [(what, measured[key]) for key, what in _MOTORS if measured.get(key)]
    told = [f"{what} of {share['joint']} {100.0 * share['largest']:.0f} % of its limit" for what, share in shares]
    if not told:
        return [reached]
    tightest = max(range(len(shares)), key=lambda i: shares[i][1]["largest"])
    advice = "" if remedy is None else f"; {remedy}"
    return [f"{reached}{advice}", f"tightest  {told[tightest]}", f"motors    {'; '.join(told)}"]


def _end(run: "SpatialRun") -> str:
    """Where a path ended."""
    from frontal_biped.simulation.space.walk_path import missed

    told = [
        f"{1e3 * miss.distance:.0f} mm and {degrees(abs(miss.angle)):.2f} degrees"
        for miss in (missed(run), missed(run, "odometry"))
    ]
    return f"{told[0]} from its end, by odometry {told[1]}"


_MOTORS = (("torque_share", "torque"), ("speed_share", "speed"))


def _text(table: dict[str, Any]) -> str:
    lines = [
        f"speed of the second half  {table['speed_of_second_half']:.3f} m/s, commanded {table['commanded_speed']:g}",
        f"sideways, yaw             {1e3 * table['sideways']:.1f} mm, {table['yaw_drift']:.2e} rad",
    ]
    collision = table["self_collision"]
    if collision:
        lines.append(f"instants at which links touch  {collision['touching']} of {collision['instants']}")
    return "\n".join(lines)
