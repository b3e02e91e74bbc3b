"""`frontal-biped analyze`."""

import argparse
from pathlib import Path

from frontal_biped.cli import double_support
from frontal_biped.cli.arguments import add_gait, add_jobs, add_json, add_robot, add_verbose
from frontal_biped.cli.exit_status import SUCCESS, TASK_FAILED
from frontal_biped.cli.output import emit, require_output
from frontal_biped.cli.progress import Progress

SUMMARY = "Is it a gait, what is tightest, what it needs of the motors; -v: all tables. Exit status 1 if not certified."
EXAMPLE = "frontal-biped analyze gait.json -v"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Gait, robustness card, robot, tables, JSON."""
    add_gait(parser)
    parser.add_argument(
        "--robustness",
        action="store_true",
        help="add the robustness card: speeds that return and pushes survived; some ten seconds of processor time",
    )
    add_jobs(parser)
    parser.add_argument(
        "--prove",
        metavar="C.json",
        type=Path,
        nargs="?",
        const=Path(),
        help="prove in ball arithmetic how many reversals there are, that the gait is one and stable, keeps C01 to C09"
        " on its whole orbit, and whence it is reached (extra proof; 40 s), and keep the certificate; default:"
        " beside the gait, its name with .proof.json",
    )
    add_robot(parser)
    add_verbose(parser)
    add_json(parser)


def certificate_path(gait: Path) -> Path:
    """Where the certificate of a gait file is kept."""
    return gait.with_name(gait.name.removesuffix(".json").removesuffix(".gait") + ".proof.json")


def run(arguments: argparse.Namespace) -> int:
    """Print the analysis; success is a certificate."""
    from frontal_biped.analysis.closed_form import analyze
    from frontal_biped.analysis.robustness import robustness_card
    from frontal_biped.analysis.sideways import analyze_sideways
    from frontal_biped.cli.sources import load_filed_walker
    from frontal_biped.cli.workers import helpers
    from frontal_biped.exceptions import GaitFileError
    from frontal_biped.gait.gait import Gait
    from frontal_biped.gait.sideways import SidewaysGait
    from frontal_biped.gait.support_gait import SupportGait

    kept = certificate_path(arguments.gait) if arguments.prove == Path() else arguments.prove
    require_output(kept, arguments.gait, robot=arguments.robot)
    biped, gait = load_filed_walker(arguments.gait, arguments.robot)
    if kept is not None and not isinstance(gait, Gait):
        raise GaitFileError(f"{arguments.gait}: --prove is of gaits of equal steps with impacts; leave it out")
    if isinstance(gait, SupportGait):
        return double_support.analyze(arguments, biped, gait)
    if isinstance(gait, SidewaysGait):
        if arguments.robustness:
            raise GaitFileError(f"{arguments.gait}: holds two steps, and the robustness card is of one; leave it out")
        found = analyze_sideways(biped, gait)
        emit(arguments, found.as_dict(), str(found) if arguments.verbose else found.summary)
        return SUCCESS if found.certified else TASK_FAILED
    contradictions: tuple[str, ...] = ()
    with Progress("analysing:") as progress:
        progress.update("orbit, reversal and certificate")
        analysis = analyze(biped, gait)
        table, text = analysis.as_dict(), str(analysis) if arguments.verbose else analysis.summary
        if arguments.robustness:
            with helpers(arguments.jobs) as executor:
                card = robustness_card(biped, gait, executor=executor, on_progress=progress.update)
            table["robustness"] = card.as_dict()
            text += f"\n\n{card}"
        if kept is not None:
            from frontal_biped.analysis.proof import prove
            from frontal_biped.analysis.statements import defects, in_brief, statements, table_text

            progress.update("proof in ball arithmetic")
            certificate = prove(biped, gait)
            certificate.save(kept)
            told = statements(analysis, certificate.proof)
            contradictions = defects(told)
            table |= {
                "proof": certificate.as_dict(kept.parent),
                "statements": [statement.as_dict() for statement in told],
                "defects": list(contradictions),
            }
            shown = table_text(told if arguments.verbose else in_brief(told))
            kept_at = f"{'certificate of the proof':26} {kept}"
            text += "\n".join(["\n", str(certificate), kept_at, "", shown, *contradictions])
    emit(arguments, table, text)
    return SUCCESS if analysis.certified and not contradictions else TASK_FAILED
