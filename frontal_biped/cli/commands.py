"""The commands: load, call one function, print."""

import argparse
import json
import sys
from collections.abc import Mapping
from concurrent.futures import Executor
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from frontal_biped.analysis.closed_form import analyze
from frontal_biped.analysis.cross_check import cross_check
from frontal_biped.analysis.robustness import robustness_card
from frontal_biped.cli.main import SUCCESS, TASK_FAILED
from frontal_biped.cli.progress import Progress
from frontal_biped.cli.view import VIEWED_STEPS, watched
from frontal_biped.control.settings import ControllerSettings
from frontal_biped.demo.demo import make_demo
from frontal_biped.design.optimise import design_gait
from frontal_biped.exceptions import FrontalBipedError, GaitFileError, SimulationError
from frontal_biped.files.atomic import require_folder, require_parent
from frontal_biped.gait.file import gait_from_dict, load_gait, save_gait
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.shipped import load_specification
from frontal_biped.gait.specification import default_specification
from frontal_biped.library.build import build_library
from frontal_biped.library.executors import dask_executor, worker_processes
from frontal_biped.library.sweep import read_sweep
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import load_robot
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.trajectory import Trajectory, load_trajectory, save_trajectory
from frontal_biped.simulation.walking import sampled_settings, simulate


def run_demo(arguments: argparse.Namespace) -> int:
    """`frontal-biped demo`."""
    biped = load_robot(arguments.robot)
    with Progress("demo:") as progress:
        report = make_demo(biped, arguments.out, on_progress=progress.update)
    _emit(arguments, report.as_dict(), str(report))
    return SUCCESS if report.success else TASK_FAILED


def run_design(arguments: argparse.Namespace) -> int:
    """`frontal-biped design`."""
    biped = load_robot(arguments.robot)
    specification = default_specification(biped) if arguments.spec is None else load_specification(arguments.spec)
    if arguments.output is not None:
        require_parent(arguments.output)
    with Progress("designing:") as progress:

        def show(iteration: int, cost: float, violation: float) -> None:
            progress.update(f"iteration {iteration}, J = {cost:.3f} N^2 m s, violation {violation:.1e}")

        start = None if arguments.start is None else load_gait(arguments.start)
        result = design_gait(biped, specification, start=start, attempts=arguments.attempts, on_progress=show)
    if result.gait is None:
        sys.stderr.write(f"frontal-biped: no gait: {biped.name}: {result.message}\n")
        return TASK_FAILED
    if arguments.output is not None:
        save_gait(result.gait, arguments.output)
    saved = f"written to {arguments.output}" if arguments.output is not None else "not saved; add -o gait.json"
    table = {
        "success": result.success,
        "message": result.message,
        "iterations": result.iterations,
        "evaluations": result.evaluations,
        "seconds": result.seconds,
        "output": None if arguments.output is None else str(arguments.output),
        "asymmetry": biped.asymmetry.as_dict(),
        "constraints": None if result.report is None else result.report.as_dict(),
    }
    effort = f"{result.iterations} iterations, {result.evaluations} evaluations, {result.seconds:.2f} s"
    share = 100.0 * biped.asymmetry.mass_matrix
    legs = f"\nlegs averaged; they differ by {share:.2g} % of the mass matrix" if biped.asymmetry.differences else ""
    _emit(arguments, table, f"{result.report}\n\n{biped.name}: {result.message}{legs}\n{effort}; {saved}")
    return SUCCESS


def run_library(arguments: argparse.Namespace) -> int:
    """`frontal-biped library`."""
    sweep = read_sweep(arguments.sweep)
    require_folder(arguments.output)
    points = len(sweep.points())
    with Progress("designing: gait", points) as progress, _executor(arguments) as executor:
        before: list[int] = []

        def show(done: int, total: int, seconds: float) -> None:
            before.append(done)
            rate = (done - before[0]) / seconds if seconds > 0.0 else 0.0
            left = f"{rate:.2f} a second, about {(total - done) / rate:.0f} s to go" if rate > 0.0 else ""
            progress.update(left, done)

        report = build_library(sweep, arguments.output, executor, show)
    table = {**asdict(report), "index": str(report.index), "gaits_per_second": report.gaits_per_second}
    earlier = f", {report.found} of them by an earlier run" if report.found else ""
    _emit(
        arguments,
        table,
        f"{report.points} points{earlier}: {report.gaits} gaits, {report.failures} without one\n"
        f"{report.seconds:.1f} s, {report.gaits_per_second:.2f} points a second; table in {report.index}",
    )
    return SUCCESS


def _executor(arguments: argparse.Namespace) -> AbstractContextManager[Executor | None]:
    if arguments.dask is not None:
        return dask_executor(arguments.dask)
    return worker_processes(arguments.jobs) if arguments.jobs > 1 else nullcontext()


def run_analyze(arguments: argparse.Namespace) -> int:
    """`frontal-biped analyze`."""
    gait = load_gait(arguments.gait)
    biped = _robot_of(gait, arguments)
    with Progress("analysing:") as progress:
        progress.update("orbit, reversal and certificate")
        analysis = analyze(biped, gait)
        card = None
        if arguments.robustness:
            with worker_processes(arguments.jobs) if arguments.jobs > 1 else nullcontext() as executor:
                card = robustness_card(biped, gait, executor=executor, on_progress=progress.update)
    table, text = analysis.as_dict(), str(analysis)
    if card is not None:
        table["robustness"] = card.as_dict()
        text += f"\n\n{card}"
    _emit(arguments, table, text)
    return SUCCESS if analysis.certified else TASK_FAILED


def run_simulate(arguments: argparse.Namespace) -> int:
    """`frontal-biped simulate`."""
    gait = load_gait(arguments.gait)
    biped = _robot_of(gait, arguments)
    if arguments.output is not None:
        require_parent(arguments.output)
    period = None if arguments.continuous else 1.0 / arguments.rate
    disturbances = Disturbances(arguments.encoder_noise, arguments.torque_noise, seed=arguments.seed)
    settings = sampled_settings(gait, period, outputs=arguments.controller)
    if arguments.engine == "ours":
        stabiliser = arguments.stabiliser or "adaptive"
        run = _walk(biped, gait, arguments.steps, period, arguments.speed_error, stabiliser, disturbances, settings)
        table, text, walked, runs = _run_summary(run), _run_text(run), not run.fell, {arguments.output: run}
    elif period is None:
        raise SimulationError("--continuous: a walker in MuJoCo reads its sensors at a rate; give --rate instead")
    else:
        engines = ("mujoco", "ours") if arguments.engine == "both" else ("mujoco",)
        with Progress("walking: step", arguments.steps) as progress:
            check, by_engine = cross_check(
                biped,
                gait,
                engines=engines,
                on_step=lambda engine, done: progress.update(f"in {engine}", done),
                steps=arguments.steps,
                period=period,
                speed_error=arguments.speed_error,
                stabiliser=arguments.stabiliser,
                disturbances=disturbances,
                controller_settings=replace(settings, max_torque=None),
            )
        text, walked = str(check), check.walked
        table = {**_run_summary(by_engine["mujoco"]), "cross_check": check.as_dict()}
        paths = dict.fromkeys(engines, arguments.output)
        if arguments.output is not None and len(engines) > 1:
            stem, suffix = arguments.output.stem, arguments.output.suffix
            paths = {engine: arguments.output.with_name(f"{stem}.{engine}{suffix}") for engine in engines}
        runs = {paths[engine]: run for engine, run in by_engine.items()}
    written = [path for path in runs if path is not None]
    for path in written:
        save_trajectory(runs[path], path)
    table["output"] = str(written[0]) if len(written) == 1 else [str(path) for path in written] or None
    _emit(arguments, table, text)
    return SUCCESS if walked else TASK_FAILED


def run_plot(arguments: argparse.Namespace) -> int:
    """`frontal-biped plot`."""
    from frontal_biped.figures.write import write_figures

    biped, gait, run = _load_source(arguments, walk=True)
    for path in write_figures(arguments.output, biped, gait, run, arguments.format):
        sys.stdout.write(f"{path}\n")
    return SUCCESS


def run_robots(arguments: argparse.Namespace) -> int:
    """`frontal-biped robots`."""
    from frontal_biped.cli.robots import describe, list_robots

    if arguments.describe is not None or arguments.posture is not None:
        return describe(arguments)
    table, text = list_robots()
    _emit(arguments, table, text)
    return SUCCESS


# ---------------------------------------------------------------------- helpers
def _emit(arguments: argparse.Namespace, table: Mapping[str, Any], text: str) -> None:
    if arguments.json:
        sys.stdout.write(json.dumps(table, indent=1) + "\n")
    else:
        sys.stdout.write(text + "\n")


def _robot_of(gait: Gait, arguments: argparse.Namespace) -> FrontalBiped:
    """The robot asked for, or the one the gait names; says so when it is not the one the gait was designed for."""
    try:
        biped = load_robot(arguments.robot or gait.robot.name)
    except FrontalBipedError as error:
        if arguments.robot:
            raise
        raise GaitFileError(f"the gait's robot cannot be loaded: {error}; name it with --robot") from None
    if biped.fingerprint != gait.robot.fingerprint:
        sys.stderr.write(
            f"frontal-biped: warning: the gait was designed for {gait.robot.name!r} with another URDF or description"
            f" than {biped.path.name}\n"
        )
    return biped


def _walk(
    biped: FrontalBiped,
    gait: Gait,
    steps: int,
    period: float | None,
    speed_error: float = 0.0,
    stabiliser: str = "adaptive",
    disturbances: Disturbances | None = None,
    controller_settings: ControllerSettings | None = None,
) -> Trajectory:
    with Progress("walking: step", steps) as progress:
        return simulate(
            biped,
            gait,
            steps=steps,
            period=period,
            speed_error=speed_error,
            stabiliser=stabiliser,
            disturbances=disturbances,
            controller_settings=controller_settings,
            on_step=lambda done: progress.update("", done),
        )


def _load_source(arguments: argparse.Namespace, walk: bool) -> tuple[FrontalBiped, Gait | None, Trajectory | None]:
    """Robot, gait and run of a gait or run file; a gait is walked first, a run may lack its gait."""
    source: Path = arguments.source
    if source.suffix == ".npz":
        run = load_trajectory(source)
        if "format" not in run.gait:
            return watched(source, arguments.robot)[0], None, run
        gait = _gait_of(run, source)
        return _robot_of(gait, arguments), gait, run
    gait = load_gait(source)
    biped = _robot_of(gait, arguments)
    return biped, gait, _walk(biped, gait, VIEWED_STEPS, period=1e-3) if walk else None


def _gait_of(run: Trajectory, source: Path) -> Gait:
    """The gait kept with a run."""
    return gait_from_dict(dict(run.gait), f"{source}: gait")


def _run_summary(run: Trajectory) -> dict[str, Any]:
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


def _run_text(run: Trajectory) -> str:
    table = _run_summary(run)
    fate = "walked" if not run.fell else f"FELL ({run.outcome}) after"
    return (
        f"{run.robot}: {fate} {run.steps_completed} steps in {table['duration']:.2f} s\n"
        f"worst output error        {table['worst_output_error']:.3e} rad\n"
        f"worst post-impact change  {table['worst_post_impact_error']:.3e} (rad, rad/s)\n"
        f"largest torque            {table['largest_torque']:.2f} N m\n"
        f"least normal force        {table['least_normal_force']:.1f} N\n"
        f"unsolved control ticks    {table['unsolved_ticks']}"
    )
