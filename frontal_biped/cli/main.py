"""Entry point of `frontal-biped`: the parser, and errors in one line."""

import argparse
import os
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.version import __version__

SUCCESS, TASK_FAILED, USAGE = 0, 1, 2


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command line.

    Args:
        argv: arguments after the program's name; default: those of the process.

    Returns:
        0 on success, 1 if the task failed (no gait found, not certified, the robot fell), 2 on bad input.
    """
    parser = _parser()
    try:
        arguments = parser.parse_args(argv)
    except SystemExit as stop:  # argparse: --help, --version, or a usage error it has printed
        return int(stop.code or 0)
    if arguments.command is None:
        parser.print_help()
        return USAGE
    if arguments.debug:
        return int(arguments.run(arguments))
    try:
        return int(arguments.run(arguments))
    except FrontalBipedError as error:
        return _complain(str(error))
    except OSError as error:
        return _complain(f"{error.filename or 'file system'}: {error.strerror or error}; choose another path")
    except KeyboardInterrupt:
        return _complain("interrupted; nothing was left half-written")
    except BrokenPipeError:
        # the reader of our output has gone; leave quietly, as other tools do
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return TASK_FAILED


def _complain(message: str) -> int:
    sys.stderr.write(f"frontal-biped: error: {' '.join(message.split())}\n")
    return USAGE


class _Version(argparse.Action):
    """`--version` with the versions of the solvers, looked up only when asked for."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from frontal_biped.files.provenance import software_versions

        versions = software_versions()
        sys.stdout.write("".join(f"{name} {version}\n" for name, version in versions.items()))
        parser.exit()


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="frontal-biped",
        description=f"Frontal-plane bipedal hybrid zero dynamics, version {__version__}.",
        epilog="example: frontal-biped demo --out demo",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print versions and exit")
    common = argparse.ArgumentParser(add_help=False)
    common.add_argument("--debug", action="store_true", help="show the traceback of an error")
    parser.set_defaults(debug=False)
    commands = parser.add_subparsers(dest="command", metavar="COMMAND")

    def add(name: str, summary: str, example: str) -> argparse.ArgumentParser:
        return commands.add_parser(
            name, help=summary, description=summary, epilog=f"example: {example}", parents=[common]
        )

    def add_json(command: argparse._ActionsContainer) -> None:
        command.add_argument("--json", action="store_true", help="print the report as JSON")

    def add_robot(command: argparse.ArgumentParser, default: str | None) -> None:
        meaning = "a name from `robots`, or a description (.toml) or URDF file"
        shown = f"default: {default}" if default else "default: the robot the gait names"
        command.add_argument("--robot", metavar="R", default=default, help=f"{meaning}; {shown}")

    demo = add(
        "demo",
        "Design, certify, simulate, and make page and figures for the Table I robot.",
        "frontal-biped demo --out demo",
    )
    demo.add_argument("--out", metavar="DIR", type=Path, default=Path("demo"), help="folder to write; default: demo")
    add_robot(demo, "frontal_biped")
    add_json(demo)
    demo.set_defaults(run=_Run("demo"))

    design = add(
        "design",
        "Design a gait: minimise J under C01 to C09.",
        "frontal-biped design --robot frontal_biped --spec spec.toml -o gait.json",
    )
    add_robot(design, "frontal_biped")
    design.add_argument(
        "--spec", metavar="S", help="gait specification (.toml), or `robust`; default: what suits the robot"
    )
    design.add_argument("--start", metavar="G.json", type=Path, help="gait to start from; default: a swayed stand")
    design.add_argument(
        "--attempts",
        metavar="N",
        type=_positive_int,
        default=1,
        help="designs from as many starts, random but the first; the cheapest gait is kept; default: 1",
    )
    design.add_argument("-o", "--output", metavar="G.json", type=Path, help="gait file to write")
    add_json(design)
    design.set_defaults(run=_Run("design"))

    library = add(
        "library",
        "Design a gait for every point of a grid of specifications; run it again to resume one that was interrupted.",
        "frontal-biped library sweep.toml -o gaits --jobs 2",
    )
    library.add_argument("sweep", metavar="SWEEP.toml", type=Path, help="robots, shared keys and axes of the grid")
    library.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="folder of the library")
    where = library.add_mutually_exclusive_group()
    where.add_argument("--jobs", metavar="N", type=_positive_int, default=1, help="worker processes; default: 1")
    where.add_argument("--dask", metavar="ADDRESS", help="address of a Dask scheduler instead, tcp://host:8786")
    add_json(library)
    library.set_defaults(run=_Run("library"))

    analyze = add(
        "analyze",
        "Closed-form orbit, reversal, certificate, and C01 to C09 with margins; exit status 1 if not certified.",
        "frontal-biped analyze gait.json",
    )
    analyze.add_argument("gait", metavar="G.json", type=Path, help="gait file")
    analyze.add_argument(
        "--robustness",
        action="store_true",
        help="add the robustness card: speeds that return and pushes survived; about two minutes of processor time",
    )
    analyze.add_argument(
        "--jobs",
        metavar="N",
        type=_positive_int,
        default=len(os.sched_getaffinity(0)),
        help="worker processes for the robustness card; default: the processors there are",
    )
    add_robot(analyze, None)
    add_json(analyze)
    analyze.set_defaults(run=_Run("analyze"))

    simulate = add(
        "simulate",
        "Walk a gait in the full model under the QP controller; exit status 1 if the robot falls.",
        "frontal-biped simulate gait.json --steps 20 -o run.npz",
    )
    simulate.add_argument("gait", metavar="G.json", type=Path, help="gait file")
    add_robot(simulate, None)
    simulate.add_argument("--steps", metavar="N", type=_positive_int, default=20, help="steps to walk; default: 20")
    rate = simulate.add_mutually_exclusive_group()
    rate.add_argument(
        "--rate",
        metavar="HZ",
        type=_positive_float,
        default=1000.0,
        help="control rate, zero-order hold; default: 1000",
    )
    rate.add_argument("--continuous", action="store_true", help="control in continuous time instead")
    simulate.add_argument(
        "--speed-error",
        metavar="E",
        type=_finite_float,
        default=0.0,
        help="relative error of the first speed; default: 0",
    )
    simulate.add_argument(
        "--engine",
        choices=("ours", "mujoco", "both"),
        default="ours",
        help="mujoco: MuJoCo's contact, and a walker that sees sensor readings only (extra mujoco); both: that walker"
        " in MuJoCo and in ours, side by side; -o RUN.npz then writes RUN.mujoco.npz and RUN.ours.npz; default: ours",
    )
    simulate.add_argument(
        "--stabiliser",
        metavar="NAME",
        help="fixed, adaptive, ankle, step, step-lqr or ankle+step; default: adaptive, in MuJoCo with the energy law",
    )
    simulate.add_argument(
        "--controller",
        metavar="NAME",
        default="linearising",
        help="what drives the outputs: linearising, or clf, a control Lyapunov function; default: linearising",
    )
    for name, unit in (("encoder", "rad"), ("torque", "relative")):
        simulate.add_argument(
            f"--{name}-noise",
            metavar="S",
            type=_not_negative_float,
            default=0.0,
            help=f"standard deviation, {unit}; default: 0",
        )
    simulate.add_argument("--seed", metavar="N", type=_whole_number, default=0, help="of the noise; default: 0")
    simulate.add_argument("-o", "--output", metavar="RUN.npz", type=Path, help="run file to write")
    add_json(simulate)
    simulate.set_defaults(run=_Run("simulate"))

    trial = add(
        "trial",
        "Run scenarios: disturbed walks with expectations; exit status 1 if one does not hold.",
        "frontal-biped trial examples/scenarios/push.scenario.toml --repeat 20 --seed 1 --jobs 2 --save runs",
    )
    trial.add_argument("scenarios", metavar="SCENARIO.toml", type=Path, nargs="+", help="scenario files")
    trial.add_argument("--repeat", metavar="N", type=_positive_int, help="trials of each; default: what its file says")
    trial.add_argument("--seed", metavar="S", type=_whole_number, help="of all trials; default: what each file says")
    trial.add_argument("--only", metavar="K", type=_whole_number, help="only trial K, from 0, of each scenario")
    trial.add_argument("--jobs", metavar="N", type=_positive_int, default=1, help="worker processes; default: 1")
    trial.add_argument("--junit", metavar="FILE", type=Path, help="write JUnit XML")
    trial.add_argument("--save", metavar="DIR", type=Path, help="keep a run file of every trial, for `view` and `plot`")
    shown = trial.add_mutually_exclusive_group()
    shown.add_argument("--markdown", action="store_true", help="print the table as Markdown")
    add_json(shown)
    trial.set_defaults(run=_Run("trial", "trial"))

    view = add(
        "view",
        "Watch a gait or a run in the browser: live, or as one self-contained page.",
        "frontal-biped view gait.json --html page.html",
    )
    view.add_argument("source", metavar="G.json|RUN.npz", type=Path, help="gait or run file")
    view.add_argument("beside", metavar="SECOND", type=Path, nargs="?", help="a second one, shown beside the first")
    add_robot(view, None)
    view.add_argument("--ghost", action="store_true", help="the desired posture as well, translucent")
    view.add_argument("--overlay", action="store_true", help="the second run translucent over the first, not beside it")
    view.add_argument("--html", metavar="PAGE.html", type=Path, help="write one offline page instead of a live view")
    view.add_argument("--no-open", action="store_true", help="do not open a browser, only print the address")
    view.add_argument(
        "--port", metavar="N", type=_whole_number, default=0, help="of the live view; default: the first free one"
    )
    view.set_defaults(run=_Run("view", "view"))

    export = add(
        "export",
        "A run as CSV of joint angles, velocities, torques and FRI, as GIF, PNG or page, by the ending of -o; of a gait"
        " its periodic orbit. GIF and PNG need the extra `browser`.",
        "frontal-biped export run.npz -o run.csv --rate 200",
    )
    export.add_argument("source", metavar="G.json|RUN.npz", type=Path, help="gait or run file")
    add_robot(export, None)
    export.add_argument("-o", "--output", metavar="FILE", type=Path, required=True, help=".csv, .gif, .png or .html")
    export.add_argument("--steps", metavar="N", type=_positive_int, help="default: all of a run, two of a gait")
    export.add_argument(
        "--coordinates",
        choices=("urdf", "stance", "both"),
        default="urdf",
        help="CSV: the URDF's joints by name, the paper's stance coordinates, or both; default: urdf",
    )
    export.add_argument(
        "--rate", metavar="HZ", type=_positive_float, help="CSV: rows per second; default: the samples of the run"
    )
    export.add_argument(
        "--time", metavar="T", type=_not_negative_float, default=0.0, help="PNG: time of the run, s; default: 0"
    )
    export.add_argument("--fps", metavar="F", type=_positive_float, default=20.0, help="GIF: default: 20")
    export.add_argument("--size", metavar="WxH", type=_size, help="pixels; default: 1280x800, of a GIF 640x480")
    export.add_argument("--dark", action="store_true", help="light on dark")
    export.set_defaults(run=_Run("export", "export"))

    plot = add("plot", "Write the paper's figures and more.", "frontal-biped plot run.npz -o figures")
    plot.add_argument("source", metavar="G.json|RUN.npz", type=Path, help="gait or run file")
    add_robot(plot, None)
    plot.add_argument(
        "-o", "--output", metavar="DIR", type=Path, default=Path("figures"), help="folder; default: figures"
    )
    plot.add_argument(
        "--format",
        metavar="F,F",
        type=_figure_formats,
        default=("svg", "png"),
        help="svg, pdf, png, or several with commas; default: svg,png",
    )
    plot.set_defaults(run=_Run("plot"))

    studio = add(
        "studio",
        "Set the specification with sliders in the browser, watch the gait designed anew, push the robot.",
        "frontal-biped studio --robot talos_full",
    )
    add_robot(studio, "frontal_biped")
    studio.add_argument(
        "--port", metavar="P", type=_positive_int, default=0, help="port; default: the first free one from 8080 on"
    )
    studio.add_argument("--no-open", action="store_true", help="do not open a browser, only print the address")
    studio.set_defaults(run=_Run("studio", "studio"))

    robots = add(
        "robots",
        "What can be walked; or propose a description for a URDF, or a posture for a description.",
        "frontal-biped robots --describe my.urdf -o my.toml",
    )
    task = robots.add_mutually_exclusive_group()
    task.add_argument(
        "--describe", metavar="R.urdf", type=Path, help="propose a description by looking at the joints of a URDF"
    )
    task.add_argument(
        "--posture",
        metavar="R.toml",
        help="print a description with a posture at which roll axes are parallel, feet flat and the robot balanced",
    )
    robots.add_argument("-o", "--output", metavar="R.toml", type=Path, help="description to write; default: print it")
    add_json(robots)
    robots.set_defaults(run=_Run("robots"))
    return parser


class _Run:
    """The command of a name; its module, and Pinocchio with it, is imported when it runs, so --help stays fast."""

    def __init__(self, name: str, module: str = "commands") -> None:
        self.name, self.module = name, module

    def __call__(self, arguments: argparse.Namespace) -> int:
        commands = import_module(f"frontal_biped.cli.{self.module}")
        function = getattr(commands, f"run_{self.name}")
        return int(function(arguments))


def _positive_int(text: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = 0
    if value <= 0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a positive whole number")
    return value


def _figure_formats(text: str) -> tuple[str, ...]:
    formats = tuple(part.strip().lower() for part in text.split(","))
    wrong = [part for part in formats if part not in ("svg", "pdf", "png")]
    if wrong:
        raise argparse.ArgumentTypeError(f"{wrong[0]!r} is none of svg, pdf, png")
    return formats


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal() and min(int(width), int(height)) >= 100):
        raise argparse.ArgumentTypeError(f"{text!r} is not a size like 1280x800, 100 pixels or more")
    return int(width), int(height)


def _positive_float(text: str) -> float:
    value = _finite_float(text)
    if value <= 0.0:
        raise argparse.ArgumentTypeError(f"{text!r} is not positive")
    return value


def _finite_float(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) < float("inf"):
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number")
    return value


def _not_negative_float(text: str) -> float:
    value = _finite_float(text)
    if value < 0.0:
        raise argparse.ArgumentTypeError(f"{text!r} is negative")
    return value


def _whole_number(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number")
    return int(text)
