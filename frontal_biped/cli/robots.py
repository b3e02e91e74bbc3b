"""`frontal-biped robots`: what can be walked, and descriptions for what cannot yet."""

import argparse
import json
import sys
from typing import Any

from frontal_biped.cli.main import SUCCESS, TASK_FAILED
from frontal_biped.exceptions import RobotError
from frontal_biped.files.atomic import require_parent, write_text
from frontal_biped.model.catalogue import description_path, load_robot, robot_names
from frontal_biped.model.urdf.packages import EXAMPLE_ROBOT_DATA
from frontal_biped.model.urdf.proposal import propose_description, propose_posture


def list_robots() -> tuple[dict[str, Any], str]:
    """The packaged robots as a table for JSON and as text; one that cannot be loaded is listed with the reason."""
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


def describe(arguments: argparse.Namespace) -> int:
    """Print or write a proposed description; exit status 1 if something is left for the user to settle."""
    if arguments.output is not None:
        require_parent(arguments.output)
    if arguments.describe is not None:
        proposal = propose_description(arguments.describe)
    else:
        proposal = propose_posture(description_path(arguments.posture))
    packaged = f"{EXAMPLE_ROBOT_DATA}:" in proposal.text
    if arguments.output is not None and not packaged:
        folder = proposal.folder.resolve()
        if arguments.output.resolve().parent != folder:
            raise RobotError(f"{arguments.output}: the description names its URDF from {folder}; write it there")
    if arguments.output is not None:
        write_text(arguments.output, proposal.text)
    if arguments.json:
        table = {
            "description": proposal.text,
            "undecided": list(proposal.undecided),
            "output": None if arguments.output is None else str(arguments.output),
        }
        sys.stdout.write(json.dumps(table, indent=1) + "\n")
    elif arguments.output is None:
        sys.stdout.write(proposal.text)
    else:
        sys.stdout.write(f"written to {arguments.output}; design a gait with --robot {arguments.output}\n")
    for line in proposal.undecided:
        sys.stderr.write(f"frontal-biped: not decided: {line}\n")
    return TASK_FAILED if proposal.undecided else SUCCESS
