"""Viser's server behind the guard: it answers the page at the printed address, and hears from it what the page says.

Viser asks nobody who he is, and has no option for it. It serves through `websockets`, whose documented options have all
that is needed: `process_request` sees every request first, `create_connection` every message, `sock` is a port that is
ours already. So while viser starts, its call of ``websockets.asyncio.server.serve`` gets these options besides its own.
A server in front of viser would not do: viser's own port would stay open to every page beside it. Should a later viser
start in another way, strangers would be served; so a stranger's questions are asked before anything is shown, and
where one is answered the studio does not start.
"""

import asyncio
import contextlib
import dataclasses
import http
import http.client
import io
import logging
import socket
import threading
from typing import Any

import viser
import websockets.asyncio.server
from websockets.asyncio.server import ServerConnection
from websockets.http11 import Request, Response

from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.studio.messages import MOST_BYTES, is_expected
from frontal_biped.viewer.guard import HEADERS, REFUSED, Guard
from frontal_biped.viewer.ports import HOST

_log = logging.getLogger(__name__)
_one_at_a_time = threading.Lock()
_PATIENCE = 10.0  # [s] for an answer to a stranger; it takes milliseconds

_UPGRADE = {
    "Upgrade": "websocket",
    "Connection": "Upgrade",
    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
    "Sec-WebSocket-Version": "13",
}


class _Connection(ServerConnection):
    """One open browser; what its page does not say is not heard."""

    async def recv(self, decode: bool | None = None) -> Any:
        """The next message of the page."""
        while True:
            raw = await super().recv(decode)
            if isinstance(raw, bytes) and is_expected(raw):
                return raw
            _log.debug("a message was dropped: %r", raw[:200])


def closed_server(guard: Guard, listening: socket.socket, label: str) -> Any:
    """A ``viser.ViserServer`` for whoever has the address of the guard.

    Args:
        guard: who may ask.
        listening: where it serves.
        label: shown above the controls.

    Raises:
        FrontalBipedError: the installed viser cannot be closed to others.
    """
    port = listening.getsockname()[1]
    with _one_at_a_time:
        genuine = websockets.asyncio.server.serve
        served = []

        def serve(handler: Any, host: Any = None, port: Any = None, **options: Any) -> Any:
            served.append(True)
            asyncio.get_running_loop().set_exception_handler(lambda _, context: _log.debug("%s", context))
            options |= {
                "process_request": _guarded(guard, options.get("process_request")),
                "create_connection": _Connection,
                "max_size": MOST_BYTES,
                "logger": _quiet(),
                "server_header": None,
            }
            return genuine(handler, sock=listening, **options)

        websockets.asyncio.server.serve = serve  # type: ignore[assignment,misc]
        try:
            with contextlib.redirect_stdout(io.StringIO()):  # its banner; the address is printed by `run_studio`
                server = viser.ViserServer(host=HOST, port=port, label=label, verbose=False)
        finally:
            websockets.asyncio.server.serve = genuine  # type: ignore[misc]
    try:
        closed = bool(served) and all(_refuses(port, headers) for headers in ({}, _UPGRADE))
    except OSError:
        closed = False
    if not closed:
        with contextlib.redirect_stdout(io.StringIO()):
            server.stop()
        raise FrontalBipedError(
            f"viser {viser.__version__} cannot be closed to other web pages; install the version that is known to be,"
            " viser 1.1.1"
        )
    return server


def _guarded(guard: Guard, answer: Any) -> Any:
    """Viser's answers to requests, for those who may ask and without the secret in the path."""

    def process_request(connection: ServerConnection, request: Request) -> Response | None:
        hosts, origins = (request.headers.get_all(name) for name in ("Host", "Origin"))
        inside = guard.inside(request.path, hosts, origins)
        if inside is None:
            response: Response | None = connection.respond(http.HTTPStatus.FORBIDDEN, REFUSED)
        else:
            response = answer(connection, dataclasses.replace(request, path=inside))
        if response is not None:
            for name, value in HEADERS.items():
                response.headers[name] = value
        return response

    return process_request


def _refuses(port: int, headers: dict[str, str]) -> bool:
    """Is a request that knows the port, but not the secret, refused?"""
    connection = http.client.HTTPConnection(HOST, port, timeout=_PATIENCE)
    try:
        connection.request("GET", "/", headers=headers)
        return connection.getresponse().status == http.HTTPStatus.FORBIDDEN
    finally:
        connection.close()


def _quiet() -> logging.Logger:
    """A log that keeps what strangers send, and the traceback of their nonsense, from the terminal."""
    logger = logging.getLogger(f"{__name__}.websockets")
    logger.propagate = False
    logger.addHandler(logging.NullHandler())
    logger.setLevel(logging.CRITICAL)
    return logger
