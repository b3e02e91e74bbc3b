"""What a browser may say to the studio: where its camera is, the value of a control, and a key that means something.

Viser's server does what any message of its protocol asks: it sets whatever property of a control is named, takes in
files, and opens a tunnel that shows the studio to the world. None of that belongs to the studio's page.
"""

import math
from typing import Literal

import msgspec

MOST_BYTES = 65_536
"""Of one message; a page's have a few hundred."""

_Three = tuple[float, float, float]


class Camera(msgspec.Struct, tag="ViewerCameraMessage", forbid_unknown_fields=True):
    """The place of the camera, as viser names it."""

    wxyz: tuple[float, float, float, float]
    position: _Three
    fov: float
    near: float
    far: float
    image_height: int
    image_width: int
    look_at: _Three
    up_direction: _Three


class Update(msgspec.Struct, tag="GuiUpdateMessage", forbid_unknown_fields=True):
    """A control at a new value: a number, both ends of a range, a line of a list, or a button pressed."""

    uuid: str
    updates: dict[Literal["value"], float | bool | str | tuple[float, float]]


class Trigger(msgspec.Struct, tag="CommandTriggerMessage", forbid_unknown_fields=True):
    """A key that the page has a command for."""

    uuid: str


_decoder = msgspec.msgpack.Decoder(Camera | Update | Trigger)


def is_expected(raw: bytes) -> bool:
    """Is it a message that the studio's page sends, every number in it finite?"""
    if len(raw) > MOST_BYTES:
        return False
    try:
        message = _decoder.decode(raw)
    except (msgspec.MsgspecError, ValueError, RecursionError):
        return False
    values = message.updates.values() if isinstance(message, Update) else msgspec.structs.astuple(message)
    numbers = (part for value in values for part in (value if isinstance(value, tuple) else (value,)))
    return all(math.isfinite(number) for number in numbers if isinstance(number, float | int))
