"""What moves on a page: channels of numbers over time, and drivers that say what each of them moves.

``how`` a driver moves its node is one of: "pose" (position and quaternion), "turn" and "slide" (about and along
``axis``), "place" (position), "point" (y axis along a vector, stretched to its length), "lay" (x, y, yaw), "stretch"
(scale of z), "arc" (scale of x and y, y mirrored where negative), "shown".
"""

import base64
from collections.abc import Sequence
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray

MOST_FRAMES = 10_000
"""Of the motion on a page; of a longer walk there are fewer a second."""

ROOT_POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")
"""Channels of the root's pose."""


class Channels:
    """Channels and drivers as they are collected."""

    def __init__(self) -> None:
        self.channels: dict[str, FloatArray] = {}
        self.drivers: list[dict[str, Any]] = []

    def drive(self, node: Sequence[str], how: str, **values: FloatArray) -> None:
        """A driver with channels of its own."""
        self.channels.update(values)
        self.drivers.append({"node": list(node), "how": how, "from": list(values)})

    def drive_vector(self, node: Sequence[str], how: str, name: str, values: FloatArray) -> None:
        """A driver with three channels of its own, values (K, 3)."""
        self.drive(node, how, **{f"{name}_{axis}": values[:, i] for i, axis in enumerate("xyz")})

    def table(self) -> dict[str, Any]:
        """What the page reads; the channel "t" says when.

        Returns:
            "count", "breaks" (none), "channels" and "drivers".
        """
        return {
            "count": len(self.channels["t"]),
            "breaks": [],
            "channels": {name: packed(values) for name, values in self.channels.items()},
            "drivers": self.drivers,
        }


def frame_rate(duration: float, fps: float) -> float:
    """Frames a second [1/s]: as wished, or as many as `MOST_FRAMES` are over a duration [s]."""
    return min(fps, MOST_FRAMES / max(duration, 1e-9))


def held(values: FloatArray, active: "np.ndarray[Any, np.dtype[np.bool_]]") -> FloatArray:
    """Values (T, ...) where active, else the latest active ones, or the first where there were none yet."""
    if not active.any():
        return np.zeros_like(values)
    latest = np.maximum.accumulate(np.where(active, np.arange(len(active)), -1))
    return values[np.where(latest < 0, int(np.argmax(active)), latest)]


def packed(values: FloatArray) -> str:
    """Numbers as little-endian float32 in base64."""
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode("ascii")
