"""The figures of a gait and a run; `write_figures` makes them all.

Each function takes data and returns a Matplotlib figure made with the object API; nothing is shown.
"""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from frontal_biped.files import atomic_path, write_text
from frontal_biped.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.visualisation.figure_style import figure_svg, styled
from frontal_biped.visualisation.orbit import orbit_trajectory
from frontal_biped.visualisation.state_figures import energy, phase_portrait, snapshots
from frontal_biped.visualisation.time_figures import ground_reaction, joint_angles, swing_foot_height, torques

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "FIGURES",
    "all_figures",
    "energy",
    "figure_svg",
    "ground_reaction",
    "joint_angles",
    "phase_portrait",
    "snapshots",
    "swing_foot_height",
    "torques",
    "write_figure",
    "write_figures",
]

FIGURES: dict[str, str] = {
    "joint_angles": "Joint angles, desired and simulated, over two steps.",
    "snapshots": "Two steps, seen from the front.",
    "phase_portrait": "Phase portrait of the stance ankle, the phase variable.",
    "energy": "Energy of the zero dynamics on the periodic orbit.",
    "torques": "Joint torques over two steps.",
    "ground_reaction": "Ground reaction with its friction cone, and the FRI inside the sole.",
    "swing_foot_height": "Height of the swing sole above the ground.",
}
"""Names and captions, in the order of a report."""


def all_figures(
    biped: FrontalBiped, gait: Gait | None, trajectory: Trajectory | None = None
) -> list[tuple[str, "Figure"]]:
    """Every figure that the given data allow, with its name.

    Args:
        biped: the robot.
        gait: the gait; None: there is no energy figure.
        trajectory: the run; None: the periodic orbit of the gait.

    Returns:
        (name, figure) in the order of `FIGURES`.

    Raises:
        ValueError: neither a gait nor a run is given.
        MissingExtraError: Matplotlib is not installed.
    """
    if trajectory is None:
        if gait is None:
            raise ValueError("figures need a gait or a run")
        trajectory = orbit_trajectory(biped, gait)
    run = trajectory
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
    return [(name, makers[name]()) for name in FIGURES if name in makers]


@styled
def write_figures(
    directory: Path | str, biped: FrontalBiped, gait: Gait | None, trajectory: Trajectory | None = None
) -> list[Path]:
    """Write every figure as SVG and PNG; each file appears whole or not at all.

    Args:
        directory: made if absent; files of the same names are replaced.
        biped: the robot.
        gait: the gait; None: there is no energy figure.
        trajectory: the run; None: the periodic orbit of the gait.

    Returns:
        The files written.
    """
    written = []
    for name, figure in all_figures(biped, gait, trajectory):
        written += write_figure(directory, name, figure)
    return written


@styled
def write_figure(directory: Path | str, name: str, figure: "Figure") -> list[Path]:
    """Write one figure as SVG and PNG; returns both files."""
    vector, raster = Path(directory) / f"{name}.svg", Path(directory) / f"{name}.png"
    write_text(vector, figure_svg(figure) + "\n")
    with atomic_path(raster) as temporary:
        figure.savefig(temporary, format="png", dpi=160)
    return [vector, raster]
