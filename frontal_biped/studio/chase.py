"""A walk in space on screen, seen from behind: the camera keeps its distance, and the ground comes towards it.

The robot stands in the middle of the scene, and what it walks on is moved instead, so the browser's camera needs to
know nothing of the way. It turns with the robot, so that the arrow keys mean on the keyboard what they mean on screen.
"""

import threading
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.space.steered import Picture
from frontal_biped.studio.drawing import wxyz_of
from frontal_biped.studio.space_drawing import SpaceDrawing, Turn

WAY = "/way"
"""Node of all that stands still on the ground."""

SHOWN = 24
"""Footsteps that stay on screen."""

FOLLOWS = 0.05
"""Share by which camera and middle follow the robot from picture to picture: they do not sway with it [-]."""

REACH, METRE = 12, 1.0
"""Lines on the ground as far as so many metres from the middle, and their distance [m]."""

BEHIND, ABOVE, LOOKS = 3.6, 2.1, 0.9
"""Of the camera: behind the robot and above the ground, and the height that it looks at, over the posture's height."""

LEFT, RIGHT = (0, 114, 178), (213, 94, 0)
"""Colours of the footsteps of either foot."""


class Chase:
    """The scene of a walk in space.

    Args:
        server: a ``viser.ViserServer``.
    """

    def __init__(self, server: Any) -> None:
        self._server = server
        self._lock = threading.RLock()
        self._nodes: dict[str, Any] = {}
        self._drawing: SpaceDrawing | None = None
        self._steps: list[Any] = []
        self._landed = -1
        self._middle = np.zeros(2)
        self._yaw = 0.0

    def begin(self, drawing: SpaceDrawing) -> None:
        """Draw the robot at its posture; what was drawn before goes."""
        with self._lock:
            self.end()
            self._drawing, self._landed = drawing, -1
            self._middle, self._yaw = np.zeros(2), 0.0
            with self._server.atomic():
                self._draw_ground()
                self._draw_robot(drawing)
            self._look()

    def show(self, picture: Picture) -> None:
        """Move the robot, the way and the camera."""
        with self._lock:
            if self._drawing is None:
                return
            self._middle += FOLLOWS * (picture.com[:2] - self._middle)
            self._yaw += FOLLOWS * ((picture.yaw - self._yaw + np.pi) % (2.0 * np.pi) - np.pi)
            with self._server.atomic():
                self._place(self._drawing, picture.q)
                self._nodes[WAY].position = (-self._middle[0], -self._middle[1], 0.0)
                grid = self._middle - METRE * np.round(self._middle / METRE)
                self._nodes["/grid"].position = (-grid[0], -grid[1], 0.0)
                if picture.steps != self._landed:
                    self._landed = picture.steps
                    self._add_step(picture)
            self._look()

    def end(self) -> None:
        """Take everything off the screen."""
        with self._lock:
            for node in [*self._steps, *reversed(self._nodes.values())]:
                node.remove()
            self._nodes, self._steps, self._drawing = {}, [], None

    # ------------------------------------------------------------------ drawing
    def _draw_ground(self) -> None:
        scene = self._server.scene
        self._nodes[WAY] = scene.add_frame(WAY, show_axes=False)
        size = 2.0 * REACH
        self._nodes["/grid"] = scene.add_grid(
            "/grid",
            size,
            size,
            plane="xy",
            cell_size=METRE,
            section_size=0.0,
            cell_color=(150, 156, 166),
            shadow_opacity=0.0,
        )

    def _draw_robot(self, drawing: SpaceDrawing) -> None:
        for shape in drawing.shapes:
            self._add_parents(shape.node)
            self._nodes[shape.node] = self._server.scene.add_mesh_simple(
                f"/{shape.node}",
                shape.vertices,
                shape.faces,
                color=shape.colour,
                opacity=None if shape.opacity >= 1.0 else shape.opacity,
                flat_shading=shape.flat,
                side="double",
                cast_shadow=False,
                receive_shadow=False,
                position=shape.pose[:3, 3],
                wxyz=wxyz_of(shape.pose),
            )
        for turn in drawing.turns:
            self._add_parents(f"{turn.node}/")
        self._place(drawing, drawing.posture)

    def _add_parents(self, node: str) -> None:
        assert self._drawing is not None
        parts = node.split("/")
        for count in range(1, len(parts)):
            name = "/".join(parts[:count])
            if name not in self._nodes:
                pose = self._drawing.placements.get(name, np.eye(4))
                self._nodes[name] = self._server.scene.add_frame(
                    f"/{name}", show_axes=False, position=pose[:3, 3], wxyz=wxyz_of(pose)
                )

    def _add_step(self, picture: Picture) -> None:
        """The foot that has landed leaves its outline."""
        assert self._drawing is not None
        left = picture.stance is Stance.LEFT
        x, y, yaw = picture.foot
        corners = self._drawing.soles[0 if left else 1]
        vertices = np.column_stack([corners, np.full(4, 0.003)])
        handle = self._server.scene.add_mesh_simple(
            f"{WAY}/step{picture.steps}",
            vertices,
            np.array([[0, 1, 2], [0, 2, 3]]),
            color=LEFT if left else RIGHT,
            opacity=0.45,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
            position=(x, y, 0.0),
            wxyz=(np.cos(0.5 * yaw), 0.0, 0.0, np.sin(0.5 * yaw)),
        )
        self._steps.append(handle)
        if len(self._steps) > SHOWN:
            self._steps.pop(0).remove()

    # ------------------------------------------------------------------ motion
    def _place(self, drawing: SpaceDrawing, q: FloatArray) -> None:
        root = self._nodes[drawing.root]
        root.position = (q[0] - self._middle[0], q[1] - self._middle[1], q[2])
        root.wxyz = (q[6], q[3], q[4], q[5])
        for turn in drawing.turns:
            self._turn(turn, float(q[turn.place]))

    def _turn(self, turn: Turn, value: float) -> None:
        node = self._nodes[turn.node]
        if turn.slides:
            node.position = value * turn.axis
        else:
            half = 0.5 * value
            node.wxyz = np.concatenate([[np.cos(half)], np.sin(half) * turn.axis])

    def _look(self) -> None:
        assert self._drawing is not None
        height = float(self._drawing.posture[2])
        back = -BEHIND * height * np.array([np.cos(self._yaw), np.sin(self._yaw)])
        for client in self._server.get_clients().values():
            with client.atomic():
                client.camera.position = (back[0], back[1], ABOVE * height)
                client.camera.look_at = (0.0, 0.0, LOOKS * height)
