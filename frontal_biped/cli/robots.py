"""`frontal-biped robots`: what can be walked, and descriptions for what cannot yet."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from frontal_biped.cli.arguments import add_json, positive_float
from frontal_biped.cli.exit_status import SUCCESS, TASK_FAILED
from frontal_biped.cli.output import emit, require_output
from frontal_biped.exceptions import RobotError

if TYPE_CHECKING:
    from frontal_biped.model.urdf.draft import Proposal

SUMMARY = "What can be walked; or propose a description for a URDF, or a posture for a description."
EXAMPLE = "frontal-biped robots --describe my.urdf -o my.toml"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What to propose, where to write."""
    task = parser.add_mutually_exclusive_group()
    task.add_argument(
        "--describe", metavar="R.urdf", type=Path, help="propose a description by looking at the joints of a URDF"
    )
    task.add_argument(
        "--posture",
        metavar="R.toml",
        help="print a description with a posture at which roll axes are parallel, feet flat and the robot balanced",
    )
    task.add_argument(
        "--bend",
        metavar="R.toml",
        help="print a description whose knees are bent far enough for steps, to walk in space",
    )
    parser.add_argument(
        "--step-length",
        metavar="M",
        type=positive_float,
        help="with --bend: distance of the feet, m; default: 0.3 of the length of a leg",
    )
    parser.add_argument("-o", "--output", metavar="R.toml", type=Path, help="description to write; default: print it")
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """List the robots, or propose."""
    if any(task is not None for task in (arguments.describe, arguments.posture, arguments.bend)):
        return _propose(arguments)
    emit(arguments, *_list())
    return SUCCESS


def _list() -> tuple[dict[str, Any], str]:
    """The packaged robots as a table for JSON and as text; one that cannot be loaded is listed with the reason."""
    from frontal_biped.model.catalogue import load_robot, robot_names

    rows: list[dict[str, Any]] = []
    lines = []
    for name in robot_names():
        try:
            biped = load_robot(name)
        except RobotError as error:
            rows.append({"name": name, "error": str(error)})
            lines.append(f"{name:26} not available: {error}")
            continue
        outer, inner = biped.sole
        row = {
            "name": name,
            "mass": biped.mass,
            "leg_length": biped.leg_length,
            "hip_width": biped.hip_width,
            "sole": [outer, inner],
            "ankle_height": biped.ankle_height,
            "ankle_torque": float(biped.max_torque[0]),
            "hip_torque": float(biped.max_torque[1]),
            "asymmetry": biped.asymmetry.as_dict(),
            "description": biped.path.name,
        }
        rows.append(row)
        lines.append(
            f"{name:26} {row['mass']:8.2f} {row['leg_length']:7.3f} {row['hip_width']:7.3f}"
            f" {outer:+8.3f}..{inner:+.3f} {row['ankle_height']:8.3f} {row['ankle_torque']:8.1f}"
            f" {row['hip_torque']:8.1f} {100.0 * biped.asymmetry.mass_matrix:10.2g}"
        )
    head = (
        f"{'name':26} {'mass':>8} {'leg':>7} {'hips':>7} {'sole':>16} {'ankle at':>8} {'ankle':>8} {'hip':>8}"
        f" {'asymmetry':>10}"
    )
    units = f"{'':26} {'kg':>8} {'m':>7} {'m':>7} {'m':>16} {'m':>8} {'N m':>8} {'N m':>8} {'% of D':>10}"
    return {"robots": rows}, "\n".join([head, units, *lines])


def _require_description(existing: Path) -> None:
    """Refuse to write over a file that is no description.

    Raises:
        RobotError: it is none.
    """
    from frontal_biped.files.toml import load_toml
    from frontal_biped.model.urdf.description import KEYS

    try:
        table = load_toml(existing, RobotError)
    except RobotError:
        table = {}
    if not {"urdf", "joints"} <= set(table) <= set(KEYS):
        raise RobotError(f"{existing}: is there and is no robot description; it would be lost, choose another path")


def _propose(arguments: argparse.Namespace) -> int:
    """Print or write a proposed description; exit status 1 if something is left for the user to settle."""
    from frontal_biped.files.atomic import write_text
    from frontal_biped.model.catalogue import description_path
    from frontal_biped.model.urdf.bent_proposal import propose_bent_posture
    from frontal_biped.model.urdf.packages import EXAMPLE_ROBOT_DATA
    from frontal_biped.model.urdf.proposal import propose_description, propose_posture

    output: Path | None = arguments.output
    require_output(output, arguments.describe, robot=arguments.posture or arguments.bend)
    if output is not None and output.exists():
        _require_description(output)
    if arguments.describe is not None:
        proposal = propose_description(arguments.describe)
    elif arguments.bend is not None:
        proposal = propose_bent_posture(description_path(arguments.bend), arguments.step_length)
    else:
        proposal = propose_posture(description_path(arguments.posture))
    if output is not None:
        folder = proposal.folder.resolve()
        packaged = f"{EXAMPLE_ROBOT_DATA}:" in proposal.text
        if not packaged and output.resolve().parent != folder:
            raise RobotError(f"{output}: the description names its URDF from {folder}; write it there")
        write_text(output, proposal.text)
    table = {
        "description": proposal.text,
        "found": list(proposal.found),
        "undecided": list(proposal.undecided),
        "changed": list(proposal.changed),
        "output": None if output is None else str(output),
    }
    told = _told(proposal, output)
    if output is None or arguments.json:  # the first for people, the other for a file or a program
        emit(arguments, table, proposal.text.removesuffix("\n"))
        sys.stderr.write(f"{told}\n")
    else:
        emit(arguments, table, told)
    return TASK_FAILED if proposal.undecided else SUCCESS


def _told(proposal: "Proposal", output: Path | None) -> str:
    """What was found, what is not decided, what to do next."""
    name = "the description" if output is None else str(output)
    then = f"frontal-biped design --robot {'R.toml' if output is None else output}"
    if output is None:
        then = f"write it beside its URDF with -o R.toml, then {then}"
    if proposal.undecided:
        then = f"settle in {name} what is not decided, then {then}"
    blocks = [
        ("found", proposal.found),
        ("changed", proposal.changed),
        ("not decided", proposal.undecided or ("nothing",)),
        ("next", (then,)),
    ]
    lines = [] if output is None else [f"written to {output}"]
    for head, block in blocks:
        lines += [f"{f'{head}:' if i == 0 else '':13}{line}" for i, line in enumerate(block)]
    return "\n".join(lines)
