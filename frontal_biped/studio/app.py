"""Start the studio, and end it cleanly: Ctrl+C, SIGTERM, or a closed terminal; no process stays, the port is free."""

import contextlib
import io
import signal
import sys
import threading
import webbrowser
from collections.abc import Iterator
from pathlib import Path

from frontal_biped.files.extras import missing_extra
from frontal_biped.files.signals import SIGNALS
from frontal_biped.studio.workbench import State, Workbench
from frontal_biped.viewer.guard import Guard
from frontal_biped.viewer.ports import HOST, listening_socket

FIRST_PORT = 8080


class Studio:
    """A running studio; use it as a context manager, or call `close`.

    Args:
        robot: as for `load_robot`.
        port: 0: the first free one from 8080 on.
        folder: where gaits and pages are saved.

    Attributes:
        url: what to open in a browser; it holds a secret, see `Guard`.
        walk: in space, steered by keys.

    Raises:
        MissingExtraError: viser is not installed.
        FrontalBipedError: the robot cannot be loaded, the port is not to be had, or the installed viser cannot be
            closed to strangers.
    """

    def __init__(self, robot: str, port: int = 0, folder: Path = Path()) -> None:
        try:
            import viser  # noqa: F401
        except ImportError:
            raise missing_extra("the studio needs viser", "viser") from None
        from frontal_biped.studio.closed_server import closed_server
        from frontal_biped.studio.panel import Panel
        from frontal_biped.studio.stage import Stage
        from frontal_biped.studio.steered_walk import SteeredWalk

        listening, chosen = listening_socket(port, FIRST_PORT, "name another one with --port")
        guard = Guard()
        self.url = guard.address(HOST, chosen)
        with contextlib.ExitStack() as undone:
            undone.callback(listening.close)
            self.workbench = Workbench(robot, folder)
            undone.callback(self.workbench.close)
            self.server = closed_server(guard, listening, "frontal_biped studio")
            undone.pop_all()
        self._panel = Panel(self.server, self.workbench)
        self._stage = Stage(self.server, self._panel.show_phase)
        self._panel.speed.on_update(lambda _: self._stage.play(float(self._panel.speed.value)))
        bench = self.workbench
        self.walk = SteeredWalk(
            self.server, lambda: bench.state.robot, lambda: bench.state.gait, folder, self._stage.hide
        )
        bench.on_change = self._show
        self.workbench.begin()

    def speed(self, value: float) -> None:
        """Play at a fraction of real time; 0 stands still."""
        self._panel.speed.value = value

    def close(self) -> None:
        """Stop serving, end the workers, free the port."""
        self.workbench.on_change = lambda _: None
        self.walk.end()
        self._stage.close()
        self.workbench.close()
        with contextlib.redirect_stdout(io.StringIO()):
            self.server.stop()

    def __enter__(self) -> "Studio":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _show(self, state: State) -> None:
        with self.server.atomic():
            self._panel.show(state)
        self._stage.show(state.drawing, state.clip if state.drawing is not None else None, state.push_clip)


def run_studio(robot: str, port: int = 0, open_browser: bool = True, folder: Path = Path()) -> None:
    """Serve the studio until Ctrl+C or SIGTERM.

    Args:
        robot: as for `load_robot`.
        port: 0: the first free one from 8080 on.
        open_browser: open a browser, where there is a display.
        folder: where gaits and pages are saved.

    Raises:
        OSError: the folder cannot be written to.
    """
    from frontal_biped.files.atomic import require_folder
    from frontal_biped.viewer.live import has_display

    require_folder(folder)
    with _ending() as ended, Studio(robot, port, folder) as studio:
        sys.stdout.write(f"Studio at {studio.url} (Ctrl+C to quit)\n")
        sys.stdout.flush()
        if open_browser and has_display():
            webbrowser.open(studio.url, new=2)
        # in slices, so that Ctrl+C is served on every platform
        while not ended.wait(0.2):
            pass


@contextlib.contextmanager
def _ending() -> Iterator[threading.Event]:
    """An event that Ctrl+C, SIGTERM and SIGHUP set, so that the way out is one and the same."""
    ended = threading.Event()
    before = {number: signal.signal(number, lambda *_: ended.set()) for number in SIGNALS}
    try:
        yield ended
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
