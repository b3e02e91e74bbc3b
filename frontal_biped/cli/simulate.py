"""`frontal-biped simulate`."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from frontal_biped.cli import double_support
from frontal_biped.cli.arguments import (
    add_gait,
    add_json,
    add_output,
    add_robot,
    add_value,
    add_verbose,
    finite_float,
    not_negative_float,
    positive_float,
    positive_int,
    whole_number,
)
from frontal_biped.cli.exit_status import SUCCESS, TASK_FAILED
from frontal_biped.cli.output import emit, report, require_output
from frontal_biped.cli.progress import Progress

if TYPE_CHECKING:
    from frontal_biped.simulation.trajectory import Trajectory

SUMMARY = "Walk a gait in the full model under the QP controller; exit status 1 if the robot falls."
EXAMPLE = "frontal-biped simulate g1 --steps 20 -o run.npz"

_ENGINES = (
    "mujoco: MuJoCo's contact, and a walker that sees sensor readings only (extra mujoco); both: that walker in MuJoCo"
    " and in ours, side by side; -o RUN.npz then writes RUN.mujoco.npz and RUN.ours.npz; default: ours"
)
_ENGINES_OF = {"ours": ("ours",), "mujoco": ("mujoco",), "both": ("mujoco", "ours")}
_STABILISERS = (
    "fixed, re-anchored, adaptive, ankle, step, step-lqr or ankle+step; default: with --continuous adaptive, otherwise"
    " the walker, which sees sensor readings only"
)
_OUTPUTS = "what drives the outputs: linearising, or clf, a control Lyapunov function"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Gait and robot, the walk, who controls it, what disturbs it, where to write."""
    add_gait(parser)
    add_robot(parser)
    add_value(parser, "--steps", "N", positive_int, "20", "steps to walk")
    rate = parser.add_mutually_exclusive_group()
    add_value(rate, "--rate", "HZ", positive_float, "1000", "control rate, zero-order hold")
    rate.add_argument("--continuous", action="store_true", help="control in continuous time instead")
    add_value(parser, "--speed-error", "E", finite_float, "0", "relative error of the first speed")
    parser.add_argument("--engine", choices=("ours", "mujoco", "both"), default="ours", help=_ENGINES)
    parser.add_argument("--stabiliser", metavar="NAME", help=_STABILISERS)
    add_value(parser, "--controller", "NAME", str, "linearising", _OUTPUTS)
    add_value(parser, "--encoder-noise", "S", not_negative_float, "0", "standard deviation, rad")
    add_value(parser, "--torque-noise", "S", not_negative_float, "0", "standard deviation, relative")
    add_value(parser, "--seed", "N", whole_number, "0", "of the noise")
    add_output(parser, "RUN.npz", "run file to write")
    add_verbose(parser)
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Walk, write the runs, print what they came to."""
    from dataclasses import replace

    from frontal_biped.analysis.cross_check import cross_check
    from frontal_biped.analysis.walk_summary import walk_summary
    from frontal_biped.cli.sources import load_filed_walker
    from frontal_biped.exceptions import SimulationError
    from frontal_biped.gait.support_gait import SupportGait
    from frontal_biped.simulation.disturbances import Disturbances
    from frontal_biped.simulation.trajectory import save_trajectory
    from frontal_biped.simulation.walking import sampled_settings, simulate

    paths = _paths(arguments.output, _ENGINES_OF[arguments.engine])
    for path in paths.values():
        require_output(path, arguments.gait, robot=arguments.robot)
    biped, gait = load_filed_walker(arguments.gait, arguments.robot)
    if isinstance(gait, SupportGait):
        return double_support.simulate(arguments, biped, gait, paths)
    period = None if arguments.continuous else 1.0 / arguments.rate
    settings = sampled_settings(gait, period, outputs=arguments.controller)
    sensed = period is not None and arguments.stabiliser is None and settings.outputs == "linearising"
    walk: dict[str, Any] = {
        "steps": arguments.steps,
        "period": period,
        "speed_error": arguments.speed_error,
        "disturbances": Disturbances(arguments.encoder_noise, arguments.torque_noise, seed=arguments.seed),
    }
    with Progress("walking: step", arguments.steps) as progress:
        if arguments.engine == "ours":
            own = simulate(
                biped,
                gait,
                **walk,
                stabiliser=arguments.stabiliser,
                controller_settings=None if sensed else settings,
                on_step=lambda done: progress.update("", done),
            )
            table, text, walked, runs = _summary(own), _text(own), not own.fell, {"ours": own}
        elif period is None:
            raise SimulationError("--continuous: a walker in MuJoCo reads its sensors at a rate; give --rate instead")
        else:
            check, by_engine = cross_check(
                biped,
                gait,
                engines=_ENGINES_OF[arguments.engine],
                on_step=lambda engine, done: progress.update(f"in {engine}", done),
                **walk,
                stabiliser=arguments.stabiliser,
                controller_settings=replace(settings, max_torque=None),
            )
            table = {**_summary(by_engine["mujoco"]), "cross_check": check.as_dict()}
            text, walked, runs = str(check), check.walked, dict(by_engine)
    written = _paths(arguments.output, tuple(runs))
    for engine, path in written.items():
        save_trajectory(runs[engine], path)
    names = [str(path) for path in written.values()]
    table["output"] = names[0] if len(names) == 1 else names or None
    summaries = {engine: walk_summary(biped, gait, run, arguments.steps) for engine, run in runs.items()}
    table |= next(iter(summaries.values())).as_dict()
    head = [f"{engine}: {summary}" if len(runs) > 1 else str(summary) for engine, summary in summaries.items()]
    emit(arguments, table, report(arguments, head, [text], names))
    return SUCCESS if walked else TASK_FAILED


def _paths(output: Path | None, engines: tuple[str, ...]) -> dict[str, Path]:
    """Where the run in each engine goes."""
    if output is None:
        return {}
    if len(engines) == 1:
        return {engines[0]: output}
    return {engine: output.with_name(f"{output.stem}.{engine}{output.suffix}") for engine in engines}


def _summary(run: "Trajectory") -> dict[str, Any]:
    states = run.post_impact_states()
    return {
        "outcome": run.outcome,
        "steps_completed": run.steps_completed,
        "duration": float(run.t[-1]),
        "worst_output_error": float(abs(run.output_error).max()),
        "worst_post_impact_error": float(abs(states - states[0]).max()),
        "largest_torque": float(abs(run.u).max()),
        "least_normal_force": float(run.force[:, 1].min()),
        "unsolved_ticks": run.settings.get("controller", {}).get("unsolved", 0),
        "settings": dict(run.settings),
    }


def _text(run: "Trajectory") -> str:
    table = _summary(run)
    return (
        f"worst output error        {table['worst_output_error']:.3e} rad\n"
        f"worst post-impact change  {table['worst_post_impact_error']:.3e} (rad, rad/s)\n"
        f"largest torque            {table['largest_torque']:.2f} N m\n"
        f"least normal force        {table['least_normal_force']:.1f} N\n"
        f"unsolved control ticks    {table['unsolved_ticks']}"
    )
