"""Live view: a small web server in this process that speaks MeshCat's protocol to the browser.

MeshCat's own server is a second process behind a ZeroMQ socket: it outlives a killed parent, keeps its port, and any
call after its death waits for ever. Here the server is a thread. It ends with the process, whatever ends that. What it
shows is for the page at the printed address alone, see `guard`.
"""

import asyncio
import contextlib
import os
import signal
import sys
import threading
import webbrowser
from collections.abc import Iterator
from types import FrameType, TracebackType
from typing import Any, Self

from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.viewer.guard import HEADERS, REFUSED, Guard
from frontal_biped.viewer.page import SceneRecorder, Show, planar_show, viewer_page
from frontal_biped.viewer.ports import HOST, listening_socket
from frontal_biped.viewer.scene import cast

FIRST_PORT = 7000
_ASKED_BYTES = 16_384  # of a request; browsers need a thousand, and have nothing to send besides
_IDLE = 60.0  # [s] that a connection may take to ask
_PATIENCE = 10.0  # [s] for the server thread to start or stop; it takes milliseconds


class LiveViewer(SceneRecorder):
    """A MeshCat window with its own web server; use it as a context manager, or call `close`.

    ``meshcat.Visualizer(window=viewer)`` draws into it; every open browser follows.

    Attributes:
        url: what to open in a browser; it holds a secret, see `Guard`.
        port: where it is served.
    """

    def __init__(
        self,
        title: str = "Frontal-plane walking",
        about: dict[str, Any] | None = None,
        port: int = 0,
        page: str | None = None,
    ) -> None:
        """Start serving.

        Args:
            title: of the page.
            about: see `page_data`.
            port: 0: the first free one from 7000 on.
            page: text of a page that needs no more than itself; None: the one around what is drawn.

        Raises:
            FrontalBipedError: no port is free, or the one that was asked for is not to be had.
        """
        super().__init__()
        self._page = viewer_page(title, [], about or {}, socket=True) if page is None else page
        self._lock = threading.Lock()
        self._clients: set[Any] = set()
        self._stop: asyncio.Event | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._socket, self.port = listening_socket(port, FIRST_PORT, "name another one, or export a page instead")
        self._guard = Guard()
        self.url = self._guard.address(HOST, self.port)
        self._ready = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._serve()), name="live-viewer", daemon=True)
        self._thread.start()
        if not self._ready.wait(_PATIENCE):
            raise FrontalBipedError(f"the viewer's server did not start at {self.url}")

    def send(self, command: Any) -> None:
        """Keep a command for browsers to come, and pass it to those that are open."""
        import umsgpack

        with self._lock:
            super().send(command)
        loop = self._loop
        if loop is not None and not loop.is_closed():
            packed = umsgpack.packb(command.lower())
            with contextlib.suppress(RuntimeError):  # the loop closed in between
                loop.call_soon_threadsafe(self._broadcast, packed)

    def packed(self) -> list[bytes]:
        """The commands as the viewer reads them."""
        with self._lock:
            return super().packed()

    def close(self) -> None:
        """Stop serving and free the port; a second call does nothing."""
        loop, stop = self._loop, self._stop
        self._loop = None
        if loop is not None and stop is not None:
            with contextlib.suppress(RuntimeError):
                loop.call_soon_threadsafe(stop.set)
        if self._thread is not threading.current_thread():
            self._thread.join(_PATIENCE)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _broadcast(self, packed: bytes) -> None:
        for client in list(self._clients):
            client.tell(packed)

    async def _serve(self) -> None:
        from tornado import httpserver, web, websocket
        from tornado.routing import Matcher, Rule

        viewer = self

        class Plain(web.RequestHandler):
            """Headers of every answer, and refusals that say nothing else."""

            def set_default_headers(self) -> None:
                self.clear_header("Server")
                for name, value in HEADERS.items():
                    self.set_header(name, value)

            def write_error(self, status_code: int, **_: Any) -> None:
                self.set_header("Content-Type", "text/plain; charset=utf-8")
                self.finish(REFUSED if status_code == 403 else f"{status_code}\n")

        class Refused(Plain):
            """For whoever may not ask, and for what is not there."""

            def prepare(self) -> None:
                raise web.HTTPError(403)

        class Page(Plain):
            """The page around the scene."""

            def get(self) -> None:
                self.finish(viewer._page)

        class Socket(websocket.WebSocketHandler):
            """One open browser."""

            def open(self, *_: str) -> None:
                for packed in viewer.packed():
                    self.tell(packed)
                viewer._clients.add(self)

            def on_message(self, message: str | bytes) -> None:
                """Browsers have nothing to say."""

            def on_close(self) -> None:
                viewer._clients.discard(self)

            def tell(self, packed: bytes) -> None:
                with contextlib.suppress(websocket.WebSocketClosedError):
                    _forget(self.write_message(packed, binary=True))

        class Asks(Matcher):
            """For the page, or for its web socket, by who may ask."""

            def __init__(self, socket: bool) -> None:
                self._socket = socket

            def match(self, request: Any) -> dict[str, Any] | None:
                hosts, origins = (request.headers.get_list(name) for name in ("Host", "Origin"))
                inside = viewer._guard.inside(request.uri, hosts, origins)
                upgrade = str(request.headers.get("Upgrade", "")).lower() == "websocket"
                return {} if inside is not None and inside[:2] in ("/", "/?") and upgrade is self._socket else None

        application = web.Application(
            [Rule(Asks(socket=True), Socket), Rule(Asks(socket=False), Page)],
            default_handler_class=Refused,
            log_function=lambda _: None,
            websocket_max_message_size=_ASKED_BYTES,
        )
        server = httpserver.HTTPServer(
            application,
            max_header_size=_ASKED_BYTES,
            max_body_size=_ASKED_BYTES,
            idle_connection_timeout=_IDLE,
            body_timeout=_IDLE,
        )
        server.add_sockets([self._socket])
        self._loop, self._stop = asyncio.get_running_loop(), asyncio.Event()
        self._ready.set()
        await self._stop.wait()
        server.stop()
        for client in list(self._clients):
            client.close()
        with contextlib.suppress(asyncio.TimeoutError):
            await asyncio.wait_for(server.close_all_connections(), 2.0)


def view_live(
    biped: FrontalBiped,
    trajectory: Trajectory,
    open_browser: bool = True,
    wait: bool = True,
    title: str | None = None,
    port: int = 0,
    *,
    ghost: bool = False,
    beside: tuple[FrontalBiped, Trajectory] | None = None,
    overlay: bool = False,
) -> LiveViewer:
    """Show a run in the browser.

    Prints the address. With ``wait`` it returns after Ctrl+C or SIGTERM, the server stopped; otherwise the caller
    closes the viewer, or leaves it to the end of the process.

    Args:
        biped: the robot.
        trajectory: the run.
        open_browser: try to open a browser; never without a display, nor in continuous integration.
        wait: stay until interrupted.
        title: of the page; None: the robot's name.
        port: 0: the first free one from 7000 on.
        ghost: show the desired posture as well, see `animation_page`.
        beside: a second robot and its run.
        overlay: the second run over the first instead of beside it.

    Returns:
        The viewer, closed already with ``wait``.
    """
    actors = cast(biped, trajectory, ghost=ghost, beside=beside, overlay=overlay)
    return serve(planar_show(title or biped.name, actors), open_browser, wait, port)


def serve(show: Show, open_browser: bool = True, wait: bool = True, port: int = 0) -> LiveViewer:
    """Serve a page until it is interrupted, or without ``wait`` until the viewer is closed; see `view_live`."""
    import meshcat

    viewer = LiveViewer(show.title, show.about, port)
    try:
        show.draw(meshcat.Visualizer(window=viewer))
    except BaseException:
        viewer.close()
        raise
    return _keep(viewer, open_browser, wait)


def serve_page(page: str, open_browser: bool = True, wait: bool = True, port: int = 0) -> LiveViewer:
    """Serve a page that needs no more than itself, as `serve` does."""
    return _keep(LiveViewer(port=port, page=page), open_browser, wait)


def _keep(viewer: LiveViewer, open_browser: bool, wait: bool) -> LiveViewer:
    try:
        if wait:
            # the address is told while SIGTERM is listened to: who reads it may end the viewer at once
            with _until_interrupted() as ended:
                _announce(viewer.url, " (Ctrl+C to quit)", open_browser)
                # in slices, so that Ctrl+C is served on every platform
                while not ended.wait(0.2):
                    pass
        else:
            _announce(viewer.url, "", open_browser)
    except BaseException:
        viewer.close()
        raise
    if wait:
        viewer.close()
    return viewer


def _announce(url: str, ending: str, open_browser: bool) -> None:
    sys.stdout.write(f"Viewer at {url}{ending}\n")
    sys.stdout.flush()
    if open_browser and has_display():
        webbrowser.open(url, new=2)


@contextlib.contextmanager
def _until_interrupted() -> Iterator[threading.Event]:
    with _sigterm_sets(threading.Event()) as ended, contextlib.suppress(KeyboardInterrupt):
        yield ended


@contextlib.contextmanager
def _sigterm_sets(event: threading.Event) -> Iterator[threading.Event]:
    if threading.current_thread() is not threading.main_thread():
        # only the main thread may handle signals; elsewhere SIGTERM ends the process, and the server with it
        yield event
        return

    def on_sigterm(_: int, __: FrameType | None) -> None:
        event.set()

    before = signal.signal(signal.SIGTERM, on_sigterm)
    try:
        yield event
    finally:
        signal.signal(signal.SIGTERM, before)


def has_display() -> bool:
    """Can a browser be opened here? Never in continuous integration."""
    if os.environ.get("CI"):
        return False
    return sys.platform in ("darwin", "win32") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _forget(sent: "asyncio.Future[None]") -> None:
    """A browser that closes while it is told something is no error."""
    asyncio.ensure_future(sent).add_done_callback(lambda done: done.cancelled() or done.exception())
