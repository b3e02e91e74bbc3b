"""What shows itself in a notebook: Jupyter asks an object for `_repr_html_`, and falls back on its ``repr``.

Pages and figures are drawn in rooms above those of what they show. Their modules are named here and imported when a
notebook asks, so that nothing below depends on a viewer, and `import frontal_biped` waits for none.
"""

import html
from collections.abc import Iterable, Sequence
from functools import cached_property
from importlib import import_module
from typing import Any

from frontal_biped.exceptions import FrontalBipedError

VIEWER = "frontal_biped.viewer.view"
"""Module whose ``view`` draws the page of an object."""

PLOTTER = "frontal_biped.figures.plot"
"""Module whose ``plot`` draws a figure of a run."""


class ShownAsPage:
    """A robot, gait or run that a notebook shows as its page; made once, when it is first shown."""

    def _repr_html_(self) -> str | None:
        """The page in a frame; None, so that the ``repr`` is shown, where its robot is not to be found."""
        try:
            return self._frame
        except FrontalBipedError:
            return None

    @cached_property
    def _frame(self) -> str:
        return str(import_module(VIEWER).view(self)._repr_html_())


class Plotted:
    """A run with figures."""

    def plot(self, name: str | None = None, robot: Any = None) -> Any:
        """A figure of the run, shown inline by a notebook: a Matplotlib figure, see `figures.plot`.

        Args:
            name: of `figures.write.FIGURES`, of a walk in space of `figures.space.SPACE_FIGURES`; default: the first.
            robot: whose run it is; default: the robot that the run names.

        Raises:
            UnknownNameError: the run has no such figure.
            RobotError: the robot is not found.
            MissingExtraError: Matplotlib is not installed.
        """
        return import_module(PLOTTER).plot(self, name, robot)


def html_table(rows: Iterable[Sequence[str]], head: Sequence[str] = ()) -> str:
    """A table of texts; line breaks and blanks in a cell are kept."""

    def row(cells: Sequence[str], tag: str) -> str:
        style = ' style="text-align:left;white-space:pre-wrap"'
        return "<tr>" + "".join(f"<{tag}{style}>{html.escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    lines = [row(head, "th")] if head else []
    return "<table>\n" + "\n".join([*lines, *(row(cells, "td") for cells in rows)]) + "\n</table>"
