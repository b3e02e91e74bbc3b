"""From keys to orders: what each key of the studio's walk in space changes, and how far."""

from typing import NamedTuple

from frontal_biped.simulation.space.steered import Order


class Key(NamedTuple):
    """A key and what it does.

    Attributes:
        name: as viser names it.
        modifier: held with it; "" for none.
        label: what it does, in words.
        change: of the order, in units of `STEP`; None: stop.
    """

    name: str
    modifier: str
    label: str
    change: Order | None


STEP = Order(0.1, 0.05, 0.15)
"""By one key: forwards and to the left [m/s], turning to the left [rad/s]."""

MOST = Order(0.3, 0.1, 0.3)
"""Largest orders, either way; the walker may refuse less on a robot whose legs do not reach."""

KEYS = (
    Key("arrowup", "", "walk faster forwards", Order(1.0, 0.0, 0.0)),
    Key("arrowdown", "", "slower, then backwards", Order(-1.0, 0.0, 0.0)),
    Key("arrowleft", "", "turn to the left", Order(0.0, 0.0, 1.0)),
    Key("arrowright", "", "turn to the right", Order(0.0, 0.0, -1.0)),
    Key("arrowleft", "shift", "step to the left", Order(0.0, 1.0, 0.0)),
    Key("arrowright", "shift", "step to the right", Order(0.0, -1.0, 0.0)),
    Key("space", "", "walk on the spot", None),
)
"""Arrow keys, with shift for steps to the side; the space bar for none of all."""


def pressed(order: Order, key: Key) -> Order:
    """The order after a key: one step on, within what is asked at most."""
    if key.change is None:
        return Order()
    changed = (
        min(max(round(old / step + change) * step, -most), most)
        for old, change, step, most in zip(order, key.change, STEP, MOST, strict=True)
    )
    return Order(*changed)
