"""`frontal-biped design`."""

import argparse
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from frontal_biped.cli import double_support
from frontal_biped.cli.arguments import (
    add_json,
    add_output,
    add_robot,
    add_value,
    add_verbose,
    not_negative_float,
    positive_int,
)
from frontal_biped.cli.exit_status import SUCCESS, TASK_FAILED
from frontal_biped.cli.output import emit, free_path, report, require_output
from frontal_biped.cli.progress import Progress
from frontal_biped.exceptions import SpecificationError
from frontal_biped.files.counted import counted

if TYPE_CHECKING:
    from frontal_biped.design.optimise import DesignResult
    from frontal_biped.design.sideways import SidewaysResult
    from frontal_biped.gait.sideways import AnyGait
    from frontal_biped.model.biped import FrontalBiped

SUMMARY = "Design a gait: minimise J under C01 to C09."
EXAMPLE = "frontal-biped design --robot frontal_biped --spec robust -o gait.json"

_OUTPUT = (
    "gait file to write; default: gait.json beside the robot's description, of a packaged robot here, or where that is"
    " taken gait-2.json, gait-3.json, ..."
)

_QUICK = (
    "leave out the walk: otherwise a gait must walk 20 steps with torques held for 1 ms, in our simulator and where it"
    " is installed in MuJoCo, and is designed anew with tighter bounds where it does not"
)


_LOOK_AHEAD = (
    "keep with the gait what looking ahead answers at every speed, so that a controller looks it up within its"
    " millisecond; a minute or two of processor time"
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Robot, specification, where to start, where to write."""
    add_robot(parser, "frontal_biped")
    parser.add_argument(
        "--spec", metavar="S", help="gait specification (.toml), or `robust`; default: what suits the robot"
    )
    parser.add_argument("--start", metavar="G.json", type=Path, help="gait to start from; default: a swayed stand")
    starts = "designs from as many starts, random but the first; the cheapest gait is kept"
    add_value(parser, "--attempts", "N", positive_int, "1", starts)
    parser.add_argument("--quick", action="store_true", help=_QUICK)
    add_value(parser, "--budget", "SHARE", not_negative_float, "0.25", "of J that may be given away so that it walks")
    parser.add_argument("--look-ahead", action="store_true", help=_LOOK_AHEAD)
    add_output(parser, "G.json", _OUTPUT)
    add_verbose(parser)
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Design a gait, write it, print its constraints."""
    from frontal_biped.design.walk_trial import STEPS
    from frontal_biped.design.walking_gait import design_gait
    from frontal_biped.gait.file import load_any_gait, save_gait
    from frontal_biped.gait.shipped import load_specification
    from frontal_biped.gait.specification import default_specification
    from frontal_biped.model.catalogue import load_robot

    require_output(arguments.output, arguments.spec, arguments.start, robot=arguments.robot)
    biped = load_robot(arguments.robot)
    specification = default_specification(biped) if arguments.spec is None else load_specification(arguments.spec)
    output = arguments.output or free_path(_place(biped) / "gait.json")
    require_output(output)
    if specification.double_support is not None:
        return double_support.design(arguments, biped, specification, output)
    if arguments.look_ahead and specification.travel is not None:
        raise SpecificationError("--look-ahead: is of gaits of equal steps; leave it out, or travel")
    with Progress("designing:") as progress:

        def show(iteration: int, cost: float, violation: float) -> None:
            progress.update(f"iteration {iteration}, J = {cost:.3f} N^2 m s, violation {violation:.1e}")

        start = None if arguments.start is None else load_any_gait(arguments.start)
        result = design_gait(
            biped,
            specification,
            quick=arguments.quick,
            start=start,
            attempts=arguments.attempts,
            budget=arguments.budget,
            on_progress=show,
            on_step=lambda engine, done: progress.update(f"walking in {engine}, step {done} of {STEPS}"),
            tell=progress.say,
        )
    if result.gait is None:
        sys.stderr.write(f"frontal-biped: no gait: {biped.name}: {result.message}\n")
        if arguments.json:
            emit(arguments, _table(biped, result, None), "")
        return TASK_FAILED
    save_gait(_looked_ahead(biped, result.gait) if arguments.look_ahead else result.gait, output)
    emit(arguments, *_report(arguments, biped, result, output))
    return SUCCESS


def _looked_ahead(biped: "FrontalBiped", gait: "AnyGait") -> "AnyGait":
    """The gait with its table."""
    from frontal_biped.control.stabilisers.tabulation import tabulated
    from frontal_biped.gait.gait import Gait

    assert isinstance(gait, Gait)  # it was asked without travel
    with Progress("looking ahead:") as progress:
        return tabulated(biped, gait, on_speed=lambda ratio: progress.update(f"{100.0 * (ratio - 1.0):+.1f} % speed"))


def _place(biped: "FrontalBiped") -> Path:
    """Folder of a gait that is not told where."""
    from frontal_biped.model.catalogue import is_packaged

    return Path() if is_packaged(biped.path) else biped.path.parent


def _report(
    arguments: argparse.Namespace, biped: "FrontalBiped", result: "DesignResult | SidewaysResult", output: Path
) -> tuple[dict[str, object], str]:
    """For JSON, and as text; what the gait needs is told as `analyze` tells it."""
    from frontal_biped.analysis.closed_form import analyze
    from frontal_biped.gait.gait import Gait
    from frontal_biped.gait.sideways import steps_in_turn

    gait = result.gait
    assert gait is not None
    steps = " and ".join(
        f"{step.orbit.step_duration:.3g} s and {step.step_width:.3g} m" for step in steps_in_turn(gait)
    )
    reached = f"{biped.name}: {result.message}; steps of {steps}; written to {output}"
    needs = analyze(biped, gait, certify=False, in_space=False).needs if isinstance(gait, Gait) else ""
    share = 100.0 * biped.asymmetry.mass_matrix
    legs = f"\nlegs averaged; they differ by {share:.2g} % of the mass matrix" if biped.asymmetry.differences else ""
    work = f"{counted(result.iterations, 'iteration')}, {counted(result.evaluations, 'evaluation')}"
    effort = f"{work}, {result.seconds:.2f} s"
    table = _table(biped, result, output)
    return table, report(
        arguments, [line for line in (reached, needs) if line], [f"{result.report}\n\n{effort}{legs}"], []
    )


def _table(biped: "FrontalBiped", result: "DesignResult | SidewaysResult", output: Path | None) -> dict[str, object]:
    """For JSON, with a gait or without."""
    return {
        "success": result.success,
        "message": result.message,
        "iterations": result.iterations,
        "evaluations": result.evaluations,
        "seconds": result.seconds,
        "walk": None if result.walk is None else result.walk.as_dict(),
        "tightened": [asdict(change) for change in getattr(result, "tightened", ())],
        "output": None if output is None else str(output),
        "asymmetry": biped.asymmetry.as_dict(),
        "constraints": None if result.report is None else result.report.as_dict(),
    }
