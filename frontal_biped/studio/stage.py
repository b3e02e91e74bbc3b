"""The robot on screen: shapes into a viser scene, and a clock that moves them."""

import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.studio.drawing import FPS, PUSH, Clip, Drawing, Shape, Track, is_marker, wxyz_of

FIELD_OF_VIEW = np.radians(36.0)
BEFORE = 0.05
"""Markers stand this far before the robot [m]; viser cannot draw them through it."""

HELD = 1.0  # [s] a pushed walk rests on its last picture before the gait goes on
PHASES_A_SECOND = 5.0


class Stage:
    """A viser scene with one walking robot.

    Args:
        server: a ``viser.ViserServer``.
        on_phase: called with the phase in words, a few times a second.
    """

    def __init__(self, server: Any, on_phase: Callable[[str], None]) -> None:
        self._server, self._on_phase = server, on_phase
        self._lock = threading.RLock()
        self._nodes: dict[str, Any] = {}
        self._shapes: dict[str, tuple[Shape, Any]] = {}
        self._drawing: Drawing | None = None
        self._gait: Clip | None = None
        self._once: Clip | None = None
        self._frame = self._told = 0.0
        self._pictured: tuple[int, int] | None = None
        self._ended = threading.Event()
        self._speed = 1.0
        self._hidden = False
        scene = server.scene
        scene.set_up_direction("+z")
        scene.configure_environment_map("studio", environment_intensity=0.35)
        scene.configure_default_lights(cast_shadow=False)
        scene.set_background_image(_sky())
        scene.world_axes.visible = False
        self._draw(None)
        self._thread = threading.Thread(target=self._run, name="studio-clock", daemon=True)
        self._thread.start()

    def show(self, drawing: Drawing | None, gait: Clip | None, once: Clip | None) -> None:
        """Show a robot and its gait, in a loop; before that another clip, once."""
        with self._lock:
            if drawing is not self._drawing:
                self._draw(drawing)
            if gait is not self._gait or (once is not None and once is not self._once):
                self._frame = 0.0
            self._gait, self._once = gait, once
            self._pictured = None

    def play(self, speed: float) -> None:
        """Set the speed, a fraction of real time, 0 to 1."""
        if 0.0 <= speed <= 1.0:
            self._speed = speed

    def hide(self, hidden: bool) -> None:
        """Leave the scene to another one, or take it back."""
        with self._lock:
            self._hidden, self._pictured = hidden, None
            with self._server.atomic():
                for name, node in self._nodes.items():
                    if "/" not in name:
                        node.visible = not hidden and name != PUSH
            if not hidden:
                self._look()

    def close(self) -> None:
        """Stop the clock."""
        self._ended.set()
        self._thread.join(2.0)

    # ------------------------------------------------------------------ drawing
    def _draw(self, drawing: Drawing | None) -> None:
        for node in [*(handle for _, handle in self._shapes.values()), *self._nodes.values()]:
            node.remove()
        self._nodes, self._shapes, self._drawing = {}, {}, drawing
        scene = self._server.scene
        if drawing is None:
            self._nodes["loading"] = scene.add_label("/loading", "loading the robot", position=(0.0, 0.0, 0.5))
            return
        with self._server.atomic():
            for shape in drawing.shapes:
                self._add_parents(shape.node)
                position, scale = shape.pose[:3, 3], (1.0, 1.0, 1.0)
                if shape.node.endswith("/rim"):
                    # the page draws it below its marker; here it is a disc behind it
                    position, scale = position - [0.02, 0.0, 0.0], (0.05, 1.0, 1.0)
                handle = scene.add_mesh_simple(
                    f"/{shape.node}",
                    shape.vertices,
                    shape.faces,
                    color=shape.colour,
                    opacity=None if shape.opacity >= 1.0 else shape.opacity,
                    flat_shading=shape.flat,
                    side="double",
                    cast_shadow=False,
                    receive_shadow=not shape.marker,
                    position=position,
                    scale=scale,
                    wxyz=wxyz_of(shape.pose),
                )
                self._shapes[shape.node] = (shape, handle)
        camera = self._server.initial_camera
        camera.position, camera.look_at = drawing.camera["position"], drawing.camera["target"]
        camera.fov = float(FIELD_OF_VIEW)
        self._look()

    def _look(self) -> None:
        if self._drawing is None or self._hidden:
            return
        place, target = self._drawing.camera["position"], self._drawing.camera["target"]
        for client in self._server.get_clients().values():
            client.camera.position, client.camera.look_at = place, target

    def _add_parents(self, node: str) -> None:
        parts = node.split("/")
        for count in range(1, len(parts)):
            name = "/".join(parts[:count])
            if name not in self._nodes:
                ahead = self._drawing.depth + BEFORE if count == 1 and is_marker(name) and self._drawing else 0.0
                self._nodes[name] = self._server.scene.add_frame(
                    f"/{name}", show_axes=False, position=(ahead, 0.0, 0.0), visible=name != PUSH and not self._hidden
                )

    # ------------------------------------------------------------------ motion
    def _run(self) -> None:
        before = time.monotonic()
        while not self._ended.wait(1.0 / FPS):
            now = time.monotonic()
            with self._lock:
                self._frame += (now - before) * FPS * self._speed
                if self._server.get_clients():
                    self._tick(now)
            before = now

    def _tick(self, now: float) -> None:
        clip, frame = self._gait or (self._drawing and self._drawing.standing), int(self._frame)
        if self._once is not None and frame < self._once.frames + HELD * FPS:
            clip = self._once
        if clip is None or self._drawing is None or self._hidden:
            return
        index = min(frame, clip.frames - 1) if clip is self._once else frame % clip.frames
        if (id(clip), index) == self._pictured:
            return
        self._pictured = (id(clip), index)
        with self._server.atomic():
            for name, track in clip.tracks.items():
                if name in self._nodes:
                    self._move(name, track, index)
        if now - self._told > 1.0 / PHASES_A_SECOND:
            self._told = now
            self._on_phase(clip.phase[min(index, len(clip.phase) - 1)])

    def _move(self, name: str, track: Track, index: int) -> None:
        node = self._nodes[name]
        if track.position is not None:
            position = np.array(track.position[index], dtype=float)
            if is_marker(name) and "/" not in name:
                assert self._drawing is not None
                position[0] += self._drawing.depth + BEFORE
            node.position = position
        if track.wxyz is not None:
            node.wxyz = track.wxyz[index]
        if track.visible is not None:
            node.visible = bool(track.visible[index])
        if track.scale is not None:
            for child, (shape, handle) in self._shapes.items():
                if child.startswith(name + "/"):
                    _scale(shape, handle, np.asarray(track.scale[index], dtype=float))


def _scale(shape: Shape, handle: Any, scale: FloatArray) -> None:
    """Stretch a shape along the axes of its parent; shapes are turned by right angles only."""
    handle.position = shape.pose[:3, 3] * scale
    handle.scale = tuple(float(s) for s in np.abs(shape.pose[:3, :3]).T @ scale)


def _sky() -> "np.ndarray[Any, np.dtype[np.uint8]]":
    """(256, 2, 3) the page's background, light above and lighter below."""
    top, bottom = np.array([0.80, 0.87, 0.94]), np.array([0.97, 0.98, 0.99])
    down = np.linspace(0.0, 1.0, 256)[:, None]
    rows = (1.0 - down) * top + down * bottom
    return np.repeat(np.round(255.0 * rows)[:, None, :], 2, axis=1).astype(np.uint8)
