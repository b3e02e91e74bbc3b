"""How the figures look: sizes, colours that survive colour blindness and greyscale, shaded phases, SVG for a page.

Figures are made with the object API; no pyplot, no window, no global state.
"""

import io
import re
from collections.abc import Callable, Sequence
from functools import wraps
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.files.extras import missing_extra
from frontal_biped.simulation.world import Phased, phase_spans
from frontal_biped.virtual_constraints.phase import StepPhase

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMN = 3.5
"""Width of a figure [in]: one column of a paper, without scaling."""

TICKS = 5
"""Intervals of an axis at most: more labels than that crowd a column."""

# Okabe and Ito's palette: told apart by colour-blind readers, and of different lightness
BLUE, VERMILION, GREEN, PURPLE, SKY, ORANGE, BLACK = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#AA4499",
    "#56B4E9",
    "#E69F00",
    "#222222",
)
PALE = "#8FC1E6"
"""Of a wide line that another is drawn over; light in greyscale too."""
DARK = {
    "#ffffff": "#1b2128",
    "#000000": "#d3dae1",
    "#222222": "#e6ebf0",
    "#52606d": "#a5b1bd",
    "#6b7480": "#a5b1bd",
    "#dde2e8": "#39434e",
    "#c9ced6": "#4c5763",
    "#e3ecf6": "#263442",
    "#8fc1e6": "#3f6d90",
    "#0072b2": "#5cb8ee",
    "#d55e00": "#ff9450",
    "#009e73": "#3fcf9f",
    "#aa4499": "#ea8bd8",
}
"""What a colour of a figure becomes on a dark page; the ones left out are bright enough for both."""

JOINT_STYLES = ((BLUE, "-"), (VERMILION, "--"), (GREEN, "-."), (PURPLE, ":"))

_STYLE: Any = {
    "font.size": 8.0,
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "axes.labelsize": 8.0,
    "axes.titlesize": 8.5,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "legend.fontsize": 8.0,
    "legend.frameon": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#DDE2E8",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.4,
    "svg.fonttype": "path",  # looks the same wherever it is opened
    "savefig.facecolor": "white",
}

_P = ParamSpec("_P")
_R = TypeVar("_R")


def styled(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Run a plotting function under this style; without Matplotlib, say which extra brings it."""

    @wraps(function)
    def run(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        try:
            from matplotlib import rc_context
        except ImportError:
            raise missing_extra("figures need Matplotlib", "plot") from None
        with rc_context(_STYLE):
            return function(*args, **kwargs)

    return run


@styled
def require_matplotlib() -> None:
    """Import what figures need of Matplotlib.

    Raises:
        MissingExtraError: it is not installed.
    """
    import matplotlib.backends.backend_agg
    import matplotlib.backends.backend_svg
    import matplotlib.figure  # noqa: F401


def new_figure(name: str, height: float, width: float = COLUMN) -> "Figure":
    """An empty figure of the given size [in]; its name seeds the ids of its SVG."""
    from frontal_biped.figures.inline import InlineFigure

    figure = InlineFigure(figsize=(width, height), layout="constrained")
    figure.set_label(name)
    return figure


def panels(name: str, rows: int, height: float) -> tuple["Figure", list["Axes"]]:
    """A figure of panels on top of each other with one horizontal axis."""
    figure = new_figure(name, height)
    axes = list(figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0])
    for ax in axes:
        ax.locator_params(nbins=TICKS)
    return figure, axes


def own_or_new(ax: "Axes | None", name: str, height: float) -> tuple["Figure", "Axes"]:
    """The given axes and their figure, or new ones."""
    if ax is None:
        figure, (ax,) = panels(name, 1, height)
        return figure, ax
    found = ax.get_figure(root=True)
    assert found is not None
    return found, ax


def shade_phases(axes: Sequence["Axes"], trajectory: Phased) -> None:
    """Shade the rising phases, name phase and stance foot above the first panel; time runs from the first sample."""
    start = float(trajectory.t[0])
    spans = phase_spans(trajectory)
    for span in spans:
        left, right = span.start - start, span.end - start
        for ax in axes:
            if span.phase is StepPhase.RISING:
                ax.axvspan(left, right, color="#E3ECF6", linewidth=0.0, zorder=0)
                if span.step > spans[0].step:
                    ax.axvline(left, color=BLACK, linewidth=0.8, zorder=1)
        if len(spans) <= 4:
            axes[0].text(
                0.5 * (left + right),
                1.02,
                f"{span.phase.value}\n{span.stance.value} foot",
                transform=axes[0].get_xaxis_transform(),
                ha="center",
                va="bottom",
                fontsize=8.0,
                color="#52606D",
                linespacing=1.0,
            )
    for ax in axes:
        ax.set_xlim(0.0, max(float(trajectory.t[-1]) - start, 1e-6))
    axes[-1].set_xlabel("time [s]")


def by_phase(trajectory: Phased, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Time from the first sample and values (T, ...) with a gap after each phase, so that no line bridges an event."""
    spans = [span.samples for span in phase_spans(trajectory)]
    return with_gaps(trajectory.t - trajectory.t[0], spans), with_gaps(values, spans)


def with_gaps(values: FloatArray, pieces: Sequence[slice]) -> FloatArray:
    """Pieces of values (T, ...) in one array, a gap after each: one line draws them."""
    gap = np.full((1, *values.shape[1:]), np.nan)
    return np.concatenate([part for piece in pieces for part in (values[piece], gap)])


BETA_LABEL = r"stance ankle angle $\beta$ [rad]"
ENERGY_UNIT = "[kg² m⁴/s²]"
ZETA_LABEL = r"$\zeta=\sigma_{\mathrm{FRI}}^2/2$" + "\n" + ENERGY_UNIT

PHASE_LABELS = 0.34
"""Height of the two lines that `shade_phases` writes above its first panel [in]."""


def legend_above(ax: "Axes", columns: int, lift: float = 0.0) -> None:
    """Legend outside the data, above the axes; lift clears text that stands there [in]."""
    figure = ax.get_figure(root=True)
    assert figure is not None
    from matplotlib.transforms import ScaledTranslation

    raised = ax.transAxes + ScaledTranslation(0.0, lift, figure.dpi_scale_trans)
    ax.legend(
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        bbox_transform=raised,
        ncols=columns,
        borderaxespad=0.3,
        handlelength=2.2,
        handletextpad=0.5,
        columnspacing=1.0,
        labelspacing=0.25,
    )


@styled
def figure_svg(figure: "Figure") -> str:
    """SVG element of a figure for a page: no XML prologue, and ids that clash with no other figure's."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    name = re.sub(r"\W", "_", str(figure.get_label())) or "figure"
    buffer = io.StringIO()
    with rc_context({"svg.hashsalt": name, "svg.id": name}):
        # the canvas itself lays a figure out as it draws it, where `savefig` goes through all of it once more before
        FigureCanvasSVG(figure).print_svg(buffer, metadata={"Date": None, "Creator": None})  # type: ignore[no-untyped-call]
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    # Matplotlib numbers its groups alike in every figure (figure_1, axes_1, ...): give them the figure's name
    text = re.sub(r'\bid="([^"]+)"', rf'id="{name}-\1"', text)
    text = re.sub(r"url\(#([^)]+)\)", rf"url(#{name}-\1)", text)
    return re.sub(r'href="#([^"]+)"', rf'href="#{name}-\1"', text)
