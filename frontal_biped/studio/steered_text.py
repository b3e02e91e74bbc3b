"""The walk in space as HTML: what was asked, what the robot does, and the way from above."""

import html
from collections import deque
from dataclasses import dataclass, field

import numpy as np

from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.space.steered import Order, Picture
from frontal_biped.studio.status import BAD, BUSY, GOOD, PLAIN, box, panel_text

SIDE = 300.0
"""Of the map [px]."""

LEAST_SHOWN = 1.5
"""Half of the least width of the map [m]."""

REMEMBERED = 400
"""Footsteps and places of the way on the map."""

LEFT, RIGHT = "#0072b2", "#d55e00"


@dataclass
class Way:
    """Where the robot has been.

    Attributes:
        feet: side, x, y [m] and yaw [rad] of the footsteps.
        places: (2,) of the centre of mass at every footstep [m].
        steps: landings when the last footstep was taken note of.
    """

    feet: deque[tuple[Stance, float, float, float]] = field(default_factory=lambda: deque(maxlen=REMEMBERED))
    places: deque[tuple[float, float]] = field(default_factory=lambda: deque(maxlen=REMEMBERED))
    steps: int = -1

    def add(self, picture: Picture) -> bool:
        """Take note of a picture; True if a foot has landed in it."""
        if picture.steps == self.steps:
            return False
        self.steps = picture.steps
        x, y, yaw = (float(number) for number in picture.foot)
        self.feet.append((picture.stance, x, y, yaw))
        self.places.append((float(picture.com[0]), float(picture.com[1])))
        return True


def order_text(order: Order) -> str:
    """An order in words."""
    parts = []
    if order.speed:
        parts.append(f"{'forwards' if order.speed > 0.0 else 'backwards'} at {abs(order.speed):.1f} m/s")
    if order.lateral:
        parts.append(f"to the {'left' if order.lateral > 0.0 else 'right'} at {100.0 * abs(order.lateral):.0f} cm/s")
    if order.turn:
        side = "left" if order.turn > 0.0 else "right"
        parts.append(f"turning {side} by {np.degrees(abs(order.turn)):.0f} degrees a second")
    return ", ".join(parts) or "on the spot"


def walk_text(news: str, picture: Picture | None, order: Order, way: Way) -> str:
    """State of the walk in space.

    Args:
        news: what is being prepared, or how it ended; "" while it walks.
        picture: the newest; None before the first.
        order: the last that was given.
        way: where the robot has been.
    """
    if picture is None:
        return panel_text(box(BUSY, "preparing", news) if news else "")
    if news:
        head = box(BAD, "the walk has ended", news)
    elif picture.refused:
        head = box(BAD, "not taken", picture.refused)
    elif order != picture.order or picture.answered[1] < 0:
        head = box(BUSY, order_text(order), "from the next step on")
    else:
        given, answered = picture.answered
        since = f"the order of step {given + 1} is walked since step {answered + 1}" if answered > given else "as asked"
        head = box(GOOD, order_text(order), since)
    foot = picture.stance.value
    line = f"step {picture.steps + 1}, on the {html.escape(foot)} foot, {picture.t:.1f} s"
    return panel_text(f'{head}<div style="color:{PLAIN}">{line}</div>{_map(way, picture)}')


def _map(way: Way, picture: Picture) -> str:
    """The way from above: x upwards, y to the left; feet as bars, the robot as an arrow."""
    points = np.array([[foot[1], foot[2]] for foot in way.feet])
    low, high = points.min(axis=0), points.max(axis=0)
    middle = 0.5 * (low + high)
    half = max(LEAST_SHOWN, 0.6 * float(np.max(high - low)))
    scale = 0.5 * SIDE / half

    def at(x: float, y: float) -> tuple[float, float]:
        return 0.5 * SIDE - scale * (y - middle[1]), 0.5 * SIDE - scale * (x - middle[0])

    lines = []
    for number in range(int(np.ceil(middle[0] - half)), int(np.floor(middle[0] + half)) + 1):
        h = at(number, 0.0)[1]
        lines.append(f'<path d="M0 {h:.1f}H{SIDE:g}"/>')
    for number in range(int(np.ceil(middle[1] - half)), int(np.floor(middle[1] + half)) + 1):
        v = at(0.0, number)[0]
        lines.append(f'<path d="M{v:.1f} 0V{SIDE:g}"/>')
    feet = []
    for side, x, y, yaw in way.feet:
        h, v = at(x, y)
        colour = LEFT if side is Stance.LEFT else RIGHT
        feet.append(
            f'<rect x="-3" y="-7" width="6" height="14" rx="2" fill="{colour}" fill-opacity=".55"'
            f' transform="translate({h:.1f} {v:.1f}) rotate({-np.degrees(yaw):.1f})"/>'
        )
    h, v = at(float(picture.com[0]), float(picture.com[1]))
    arrow = (
        f'<path d="M0 -13L7 7L0 3L-7 7Z" fill="currentColor" transform="translate({h:.1f} {v:.1f})'
        f' rotate({-np.degrees(picture.yaw):.1f})"/>'
    )
    path = " ".join(f"{a:.1f},{b:.1f}" for a, b in (at(*place) for place in way.places))
    grid = f'<g stroke="currentColor" stroke-opacity=".18">{"".join(lines)}</g>'
    trace = f'<polyline points="{path}" fill="none" stroke="currentColor" stroke-opacity=".5"/>'
    return (
        f'<svg width="{SIDE:g}" height="{SIDE:g}" style="border:1px solid #8884;margin-top:.4em" role="img"'
        f' aria-label="the way from above">{grid}{trace}{"".join(feet)}{arrow}</svg>'
        f'<div style="color:{PLAIN}">from above; a square is 1 m; <span style="color:{LEFT}">left</span> and'
        f' <span style="color:{RIGHT}">right</span> foot</div>'
    )
