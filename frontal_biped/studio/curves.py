"""The gait in curves, as HTML for the studio's panel: joint angles over the step, and the phase portrait."""

from collections.abc import Sequence

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.chain import JOINTS
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.world import phase_spans
from frontal_biped.virtual_constraints.phase import StepPhase

WIDTH, HEIGHT = 370.0, 150.0
"""Of a plot [px]."""

_LEFT, _RIGHT, _TOP, _BOTTOM = 46.0, 10.0, 8.0, 32.0
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#aa4499")  # readable on white and on black
_DASHED = "6 3"

Line = tuple[FloatArray, FloatArray, str, str]
"""x (n,), y (n,), colour, dashes; "" is drawn through."""


def gait_curves(orbit: Trajectory) -> str:
    """Two plots of the first step of a periodic orbit.

    Args:
        orbit: of `orbit_trajectory`.

    Returns:
        HTML that needs nothing else; it takes the colour of the text about it.
    """
    step = orbit.first_steps(1)
    spans = phase_spans(step)
    t, angles = step.t - step.t[0], np.degrees(step.q)
    over_time = [(t, angles[:, i], colour, "") for i, colour in enumerate(_COLOURS)]
    plane = [
        (step.q[span.samples, 0], step.dq[span.samples, 0], _COLOURS[0], "" if rising else _DASHED)
        for span in spans
        for rising in [span.phase is StepPhase.RISING]
    ]
    keys = " ".join(f'<span style="color:{c}">&#9644; {name}</span>' for name, c in zip(JOINTS, _COLOURS, strict=True))
    reversal = spans[1].start - float(step.t[0]) if len(spans) > 1 else None
    return (
        f'<div style="font-size:.85em;padding:0 .9em"><div>{keys}</div>'
        f"{_plot(over_time, 'time [s]', 'angle [degrees]', reversal)}"
        "<div>phase portrait: rising drawn through, falling dashed</div>"
        f"{_plot(plane, 'stance ankle angle β [rad]', 'dβ/dt [rad/s]', None)}</div>"
    )


def _plot(lines: Sequence[Line], xlabel: str, ylabel: str, mark: float | None) -> str:
    """SVG of lines with two labelled ticks to an axis, and a dotted line at a place of the horizontal axis."""
    x, y = (np.concatenate([line[k] for line in lines]) for k in (0, 1))
    (left, right), (low, high) = ((float(values.min()), float(values.max())) for values in (x, y))
    across = (WIDTH - _LEFT - _RIGHT) / max(right - left, 1e-9)
    up = (HEIGHT - _TOP - _BOTTOM) / max(high - low, 1e-9)
    bottom = HEIGHT - _BOTTOM

    def place(values: FloatArray, heights: FloatArray) -> str:
        points = zip(_LEFT + (values - left) * across, bottom - (heights - low) * up, strict=True)
        return " ".join(f"{a:.1f},{b:.1f}" for a, b in points)

    def word(text: str, at: tuple[float, float], anchor: str, more: str = "") -> str:
        return f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" text-anchor="{anchor}" fill="currentColor" {more}>{text}</text>'

    parts = [
        f'<path d="M{_LEFT},{_TOP}V{bottom}H{WIDTH - _RIGHT}" fill="none" stroke="currentColor" opacity=".5"/>',
        word(_number(left), (_LEFT, bottom + 13.0), "start"),
        word(_number(right), (WIDTH - _RIGHT, bottom + 13.0), "end"),
        word(_number(low), (_LEFT - 4.0, bottom), "end"),
        word(_number(high), (_LEFT - 4.0, _TOP + 8.0), "end"),
        word(xlabel, (0.5 * (_LEFT + WIDTH - _RIGHT), HEIGHT - 6.0), "middle"),
        word(ylabel, (0.0, 0.0), "middle", f'transform="translate(11,{0.5 * (_TOP + bottom)}) rotate(-90)"'),
    ]
    if low < 0.0 < high:
        parts.append(_rule(f"M{_LEFT},{bottom + low * up:.1f}H{WIDTH - _RIGHT}"))
    if mark is not None:
        parts.append(_rule(f"M{_LEFT + (mark - left) * across:.1f},{_TOP}V{bottom}"))
    for values, heights, colour, dashes in lines:
        parts.append(
            f'<polyline points="{place(values, heights)}" fill="none" stroke="{colour}" stroke-width="1.8"'
            f' stroke-dasharray="{dashes}"/>'
        )
    return f'<svg viewBox="0 0 {WIDTH:g} {HEIGHT:g}" style="width:100%;font-size:11px">{"".join(parts)}</svg>'


def _rule(path: str) -> str:
    return f'<path d="{path}" fill="none" stroke="currentColor" stroke-dasharray="2 3" opacity=".6"/>'


def _number(value: float) -> str:
    return f"{value:.3g}".replace("-", "−")
