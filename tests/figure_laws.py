"""What every figure keeps to: the width of a column, letters that can be read, none over another."""

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

COLUMN_WIDTH = 3.5  # [in] of a two-column paper
LEAST_FONT = 8.0  # [pt]


def texts_of(figure):
    """Boxes of all texts on the canvas, after drawing."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer = canvas.get_renderer()
    found = []
    for text in figure.findobj(Text):
        if text.get_text().strip() and text.get_visible() and text.get_figure(root=True) is figure:
            box = text.get_window_extent(renderer)
            if box.width > 0.0:
                found.append((text, box))
    return found


def assert_fit_for_a_column(figure):
    """Column width, 8 pt or more without scaling, no text cut off, none over another."""
    assert figure.get_size_inches()[0] <= COLUMN_WIDTH
    texts = texts_of(figure)
    ax_ticks = {id(label): ax for ax in figure.axes for label in tick_labels(ax)}
    # ticks outside the limits are made but not drawn
    shown = [(t, box) for t, box in texts if id(t) not in ax_ticks or in_view(t, ax_ticks[id(t)])]
    assert min(text.get_fontsize() for text, _ in shown) >= LEAST_FONT
    width, height = figure.get_size_inches() * figure.dpi
    for text, box in shown:
        assert box.x0 >= -1.0 and box.x1 <= width + 1.0, text.get_text()
        assert box.y0 >= -1.0 and box.y1 <= height + 1.0, text.get_text()
    for k, (one, a) in enumerate(shown):
        for other, b in shown[k + 1 :]:
            wide, high = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
            assert wide < 1.0 or high < 1.5, (one.get_text(), other.get_text())


def tick_labels(ax):
    return [text for axis in (ax.xaxis, ax.yaxis) for text in axis.findobj(Text) if text is not axis.label]


def in_view(label, ax):
    along_x = label in ax.xaxis.findobj(Text)
    place = label.get_position()[0 if along_x else 1]
    low, high = sorted(ax.get_xlim() if along_x else ax.get_ylim())
    return low <= place <= high
