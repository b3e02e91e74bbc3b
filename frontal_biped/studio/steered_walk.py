"""The walk in space of the studio: begun and ended by buttons, steered by keys."""

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

from frontal_biped.gait.gait import Gait
from frontal_biped.simulation.space.steered import Order, Picture
from frontal_biped.studio.chase import Chase
from frontal_biped.studio.driver import Driver
from frontal_biped.studio.status import panel_text
from frontal_biped.studio.steered_text import Way, walk_text
from frontal_biped.studio.steering import KEYS, Key, pressed

TOLD_A_SECOND = 5.0


class SteeredWalk:
    """A walk in space, its scene and its folder of the panel.

    Args:
        server: a ``viser.ViserServer``.
        robot: its name, asked when a walk begins.
        gait: the gait on screen, asked then.
        folder: where what is made for a robot is kept.
        hide: told whether the gait on screen is to make room.

    Attributes:
        order: the last that was given.
        picture: the newest; None without one.
        news: what is being prepared, or how the walk ended.
    """

    def __init__(
        self,
        server: Any,
        robot: Callable[[], str],
        gait: Callable[[], Gait | None],
        folder: Path,
        hide: Callable[[bool], None],
    ) -> None:
        self._robot, self._gait, self._folder, self._hide = robot, gait, folder, hide
        self._lock = threading.RLock()
        self._chase = Chase(server)
        self._driver: Driver | None = None
        self._told = 0.0
        self.order, self.news = Order(), ""
        self.picture: Picture | None = None
        self._way = Way()
        gui = server.gui
        with gui.add_folder("walk in space", order=2.7):
            self._button = gui.add_button("Walk", hint="the whole robot, in MuJoCo, from its sensors; takes a moment")
            self._text = gui.add_html(_HELP)
        self._button.on_click(lambda _: self.end() if self.walks else self.begin())
        for key in KEYS:
            command = gui.add_command(key.label, hotkey=key.name, modifier=key.modifier or None)
            command.on_trigger(lambda _, key=key: self.press(key))

    @property
    def walks(self) -> bool:
        """Is there a walk on screen?"""
        return self._driver is not None

    def begin(self) -> None:
        """Walk on the spot, until a key says otherwise."""
        with self._lock:
            self.end()
            self.order, self.picture, self.news, self._way = Order(), None, "starting", Way()
            number = object()
            self._now = number
            self._driver = Driver(
                self._robot(), self._gait(), self._folder, lambda kind, content: self._hear(number, kind, content)
            )
            self._button.label = "Back to the gait"
            self._tell()

    def press(self, key: Key) -> None:
        """A key of `KEYS`; without a walk it means nothing."""
        with self._lock:
            if self._driver is not None and self.picture is not None and not self.news:
                self.order = pressed(self.order, key)
                self._driver.steer(self.order)
                self._tell()

    def end(self) -> None:
        """Back to the gait on screen."""
        with self._lock:
            driver, self._driver = self._driver, None
            self._now = None
            if driver is None:
                return
            driver.close()
            self._chase.end()
            self._hide(False)
            self._button.label = "Walk"
            self._text.content = _HELP

    # ------------------------------------------------------------------ what the process says
    def _hear(self, number: object, kind: str, content: Any) -> None:
        with self._lock:
            if number is not self._now:
                return
            if kind == "picture":
                self.picture, self.news = content, ""
                self._chase.show(content)
                if self._way.add(content) or content.t - self._told > 1.0 / TOLD_A_SECOND or content.t < self._told:
                    self._told = content.t
                    self._tell()
                return
            if kind == "ready":
                self._hide(True)
                self._chase.begin(content)
            else:
                self.news = content
            self._tell()

    def _tell(self) -> None:
        if self._driver is not None:
            self._text.content = walk_text(self.news, self.picture, self.order, self._way)


_HELP = panel_text(
    "Arrow keys: up and down change the speed, left and right turn; with shift they step to the side; the space bar"
    " brings it back onto the spot. The robot answers from its next step on."
)
