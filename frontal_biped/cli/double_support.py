"""What design, analyze and simulate do with a gait whose double support lasts (`gait.support_gait`)."""

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from frontal_biped.cli.exit_status import SUCCESS, TASK_FAILED
from frontal_biped.cli.output import emit, report
from frontal_biped.cli.progress import Progress
from frontal_biped.exceptions import GaitFileError, SpecificationError
from frontal_biped.files.counted import counted

if TYPE_CHECKING:
    from frontal_biped.gait.specification import GaitSpecification
    from frontal_biped.gait.support_gait import SupportGait
    from frontal_biped.model.biped import FrontalBiped
    from frontal_biped.simulation.support_walk import SupportRun


def design(
    arguments: argparse.Namespace, biped: "FrontalBiped", specification: "GaitSpecification", output: Path
) -> int:
    """Design such a gait, write it, print J, its times and its certificate.

    Raises:
        SpecificationError: an option asks for what such a design does not have.
        DesignFailedError: no gait was found.
    """
    from frontal_biped.design.support_design import design_support_gait
    from frontal_biped.gait.support_certificate import certify_support_gait
    from frontal_biped.gait.support_file import save_support_gait
    from frontal_biped.gait.support_gait import SupportSpecification

    given = [
        f"--{name.replace('_', '-')}"
        for name in ("start", "attempts", "look_ahead")
        if getattr(arguments, name) not in (None, 1, False)
    ]
    if given:
        raise SpecificationError(
            f"{given[0]}: a gait with a finite double support is designed from its own starts; leave it out, or"
            " double_support"
        )
    with Progress("designing:") as progress:
        progress.update("double support, some ten seconds of processor time")
        found = design_support_gait(biped, SupportSpecification(specification))
        certificate = certify_support_gait(biped, found.gait)
    save_support_gait(found.gait, output)
    reached = (
        f"{biped.name}: J = {found.cost:.4f} N^2 m s, steps of {found.duration:.3g} s and {found.gait.width:.3g} m,"
        f" {found.double_support:.3g} s of them on both feet; not walked, simulate it; written to {output}"
    )
    table = {
        "success": True,
        "cost": found.cost,
        "step_duration": found.duration,
        "double_support": found.double_support,
        "iterations": found.iterations,
        "output": str(output),
        "certificate": certificate.as_dict(),
    }
    emit(arguments, table, report(arguments, [reached, certificate.line], [str(certificate)], []))
    return SUCCESS if certificate.holds else TASK_FAILED


def analyze(arguments: argparse.Namespace, biped: "FrontalBiped", gait: "SupportGait") -> int:
    """Print the certificate.

    Raises:
        GaitFileError: the robustness card is asked for.
    """
    from frontal_biped.gait.support_certificate import certify_support_gait

    if arguments.robustness:
        raise GaitFileError(
            f"{arguments.gait}: has a finite double support, and the robustness card is of gaits with impacts; leave it"
            " out"
        )
    certificate = certify_support_gait(biped, gait)
    head = f"{biped.name}: {certificate.line}"
    emit(arguments, certificate.as_dict(), report(arguments, [head], [f"{gait!r}\n{certificate}"], []))
    return SUCCESS if certificate.holds else TASK_FAILED


def simulate(
    arguments: argparse.Namespace, biped: "FrontalBiped", gait: "SupportGait", written: Mapping[str, Path]
) -> int:
    """Stand, set off, walk, stop and stand in each engine.

    Args:
        arguments: of the command.
        biped: the robot.
        gait: what it walks.
        written: where the run in an engine goes.

    Raises:
        GaitFileError: an option asks for what such a walk does not have.
    """
    from frontal_biped.simulation.support_walk import stand_walk_stand
    from frontal_biped.simulation.trajectory import save_trajectory

    _require_plain(arguments)
    engines = {"both": ("mujoco", "ours")}.get(arguments.engine, (arguments.engine,))
    runs: dict[str, SupportRun] = {}
    with Progress("walking: step", arguments.steps) as progress:
        for engine in engines:

            def show(done: int, engine: str = engine) -> None:
                progress.update(f"in {engine}", done)

            runs[engine] = stand_walk_stand(biped, gait, steps=arguments.steps, engine=engine, on_step=show)
    for engine, path in written.items():
        save_trajectory(runs[engine].trajectory, path)
    names = [str(path) for path in written.values()]
    tables = {engine: _summary(gait, run) for engine, run in runs.items()}
    first = tables[engines[0]]
    table = {**first, "engines": tables, "output": names[0] if len(names) == 1 else names or None}
    emit(arguments, table, report(arguments, [_line(engine, told) for engine, told in tables.items()], [], names))
    return TASK_FAILED if any(run.fell for run in runs.values()) else SUCCESS


def _require_plain(arguments: argparse.Namespace) -> None:
    """Refuse what is of gaits with impacts."""
    plain = {
        "rate": 1000.0,
        "continuous": False,
        "speed_error": 0.0,
        "stabiliser": None,
        "controller": "linearising",
        "encoder_noise": 0.0,
        "torque_noise": 0.0,
    }
    for name, value in plain.items():
        if getattr(arguments, name) != value:
            raise GaitFileError(
                f"{arguments.gait}: --{name.replace('_', '-')}: a gait with a finite double support is walked by its"
                " own walker, at 1000 Hz, undisturbed; leave it out"
            )


def _summary(gait: "SupportGait", run: "SupportRun") -> dict[str, Any]:
    """For JSON."""
    return {
        "outcome": run.outcome,
        "steps_completed": run.trajectory.steps_completed,
        "duration": float(run.trajectory.t[-1]),
        "first_speed_error": run.steps[0].speed / gait.speed - 1.0 if run.steps else None,
        "landings_to_rest": None if run.fell else run.landings_to_rest,
        "largest_torque": float(abs(run.trajectory.u).max()),
    }


def _line(engine: str, told: dict[str, Any]) -> str:
    if told["landings_to_rest"] is None:
        return f"{engine}: fell after {told['steps_completed']} steps: {told['outcome']}"
    return (
        f"{engine}: stood, set off, walked, stopped and stood: {told['steps_completed']} steps in"
        f" {told['duration']:.2f} s; first lift-off {100.0 * told['first_speed_error']:+.2f} % off the orbit's speed,"
        f" at rest {counted(told['landings_to_rest'], 'landing')} after the command"
    )
