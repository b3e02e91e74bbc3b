"""The figures of a gait and a run; `write_figures` makes them all.

Each function takes data and returns a Matplotlib figure made with the object API; nothing is shown.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from frontal_biped.analysis.in_space import has_joints_to_hold
from frontal_biped.exceptions import RobotError, SimulationError
from frontal_biped.figures.barrier import energy_barrier
from frontal_biped.figures.landing import free_landing_figure
from frontal_biped.figures.state import energy, phase_portrait, snapshots
from frontal_biped.figures.style import figure_svg, styled
from frontal_biped.figures.time import ground_reaction, joint_angles, swing_foot_height, torques
from frontal_biped.files.atomic import atomic_path, write_text
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.orbit import orbit_trajectory
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.world import before_divergence

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from frontal_biped.analysis.free_landing import FreeLandingReport

__all__ = [
    "FIGURES",
    "FIGURES_IN_SPACE",
    "all_figures",
    "energy",
    "energy_barrier",
    "figure_svg",
    "free_landing_figure",
    "ground_reaction",
    "joint_angles",
    "phase_portrait",
    "snapshots",
    "swing_foot_height",
    "torques",
    "write_figure",
    "write_figures",
]

FORMATS = ("svg", "pdf", "png")
"""What figures can be written as; PNG at 300 dots per inch. The first of those asked for lays a figure out."""

PNG = {"compress_level": 3}
"""Of PNG files: a sixth larger than at the usual level 6, in half of the time."""

FIGURES: dict[str, str] = {
    "joint_angles": "Joint angles, desired and simulated, over two steps.",
    "snapshots": "Two steps, seen from the front.",
    "phase_portrait": "Phase portrait of the stance ankle, the phase variable.",
    "energy": "Energy of the zero dynamics on the periodic orbit.",
    "barrier": "Will it tip over? The energy barrier, and orbits of perturbed steps before it.",
    "torques": "Joint torques over two steps.",
    "ground_reaction": "Ground reaction with its friction cone, and the FRI inside the sole.",
    "swing_foot_height": "Height of the swing sole above the ground.",
}
"""Names and captions, in the order of a report."""

FIGURES_IN_SPACE: dict[str, str] = {
    "free_landing": "Landing with every joint free: how much rotor inertia makes it the planar impact.",
}
"""Names and captions of those of a robot that has joints besides the four roll joints; they come behind the others."""


def all_figures(
    biped: FrontalBiped, gait: Gait | None, trajectory: Trajectory | None = None
) -> list[tuple[str, "Figure"]]:
    """Every figure that the given data allow, with its name.

    Args:
        biped: the robot.
        gait: the gait; None: there are no energy figures.
        trajectory: the run; None: the periodic orbit of the gait.

    Returns:
        (name, figure) in the order of `FIGURES`, then of `FIGURES_IN_SPACE`.

    Raises:
        ValueError: neither a gait nor a run is given.
        MissingExtraError: Matplotlib is not installed.
    """
    if trajectory is None:
        if gait is None:
            raise ValueError("figures need a gait or a run")
        trajectory = orbit_trajectory(biped, gait)
    makers = figure_makers(biped, gait, trajectory)
    if gait is not None:
        landing = _landing(biped, gait)
        if landing is not None:
            makers["free_landing"] = lambda: free_landing_figure(landing, biped.description.other_armature)
    return [(name, makers[name]()) for name in (*FIGURES, *FIGURES_IN_SPACE) if name in makers]


def figure_makers(biped: FrontalBiped, gait: Gait | None, run: Trajectory) -> "dict[str, Callable[[], Figure]]":
    """What makes each of `FIGURES` that the given data allow, by name.

    Args:
        biped: the robot.
        gait: the gait; None: there are no energy figures.
        run: the run; drawn until the robot diverges, if it does.
    """
    run = before_divergence(run)
    makers: dict[str, Callable[[], Figure]] = {
        "joint_angles": lambda: joint_angles(run),
        "snapshots": lambda: snapshots(biped, run),
        "phase_portrait": lambda: phase_portrait(run),
        "torques": lambda: torques(biped, run),
        "ground_reaction": lambda: ground_reaction(biped, run),
        "swing_foot_height": lambda: swing_foot_height(biped, run),
    }
    if gait is not None:
        known = gait
        makers["energy"] = lambda: energy(biped, known)
        makers["barrier"] = lambda: energy_barrier(biped, known, run)
    return makers


def _landing(biped: FrontalBiped, gait: Gait) -> "FreeLandingReport | None":
    """None where there is nothing to land, or a foot of unknown length; `analyze` says why."""
    if not has_joints_to_hold(biped):
        return None
    from frontal_biped.analysis.free_landing import free_landing  # brings the simulation of walks in space

    try:
        return free_landing(biped, gait)
    except (RobotError, SimulationError):
        return None


@styled
def write_figures(
    directory: Path | str,
    biped: FrontalBiped,
    gait: Gait | None,
    trajectory: Trajectory | None = None,
    formats: Sequence[str] = ("svg", "png"),
) -> list[Path]:
    """Write every figure; each file appears whole or not at all.

    Args:
        directory: made if absent; files of the same names are replaced.
        biped: the robot.
        gait: the gait; None: there are no energy figures.
        trajectory: the run; None: the periodic orbit of the gait.
        formats: of `FORMATS`.

    Returns:
        The files written.
    """
    written = []
    for name, figure in all_figures(biped, gait, trajectory):
        written += write_figure(directory, name, figure, formats)
    return written


@styled
def write_figure(
    directory: Path | str, name: str, figure: "Figure", formats: Sequence[str] = ("svg", "png")
) -> list[Path]:
    """Write one figure in some of `FORMATS`, laid out once for all of them; returns the files."""
    files = {kind: Path(directory) / f"{name}.{kind}" for kind in formats}
    engine = figure.get_layout_engine()
    for kind in sorted(files, key=FORMATS.index):
        _write(figure, kind, files[kind])
        figure.set_layout_engine("none")  # as it is from now on: to lay it out takes half of the time to draw it
    figure.set_layout_engine(engine)
    return list(files.values())


def _write(figure: "Figure", kind: str, file: Path) -> None:
    """By the canvas itself: it lays a figure out as it draws it, where ``savefig`` goes through all of it once more."""
    if kind == "svg":
        write_text(file, figure_svg(figure) + "\n")
        return
    with atomic_path(file) as temporary:
        if kind == "png":
            _write_png(figure, temporary)
        else:  # no date: equal figures, equal bytes
            figure.savefig(temporary, format=kind, dpi=300, metadata={"CreationDate": None})


def _write_png(figure: "Figure", path: Path) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    screen = figure.dpi
    figure.set_dpi(300.0)
    try:
        FigureCanvasAgg(figure).print_png(path, pil_kwargs=PNG)  # type: ignore[no-untyped-call]
    finally:
        figure.set_dpi(screen)
