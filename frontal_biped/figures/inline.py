"""A Matplotlib figure that a notebook shows inline, without pyplot and whatever the backend."""

import io

from matplotlib.figure import Figure

DENSITY = 144
"""Dots per inch of what is shown inline; twice the usual 72, so that it is sharp on dense screens."""


class InlineFigure(Figure):
    """A figure that shows itself: a notebook asks an object for `_repr_png_`."""

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png", dpi=DENSITY, facecolor="white")
        return buffer.getvalue()
