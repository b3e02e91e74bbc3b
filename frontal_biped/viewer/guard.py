"""Who may ask the small web servers of this package: a page that was opened from the printed address, and nobody else.

A server on 127.0.0.1 is within reach of every page that the user's browser shows, and of every program of the machine.
So each address holds a secret, new with every start, and whoever asks names it in the path of every request: not in a
cookie, which the browser would hand to other servers of this machine too, for cookies know no ports. The ``Host`` is
this machine by name or number: a stranger's name that was made to point here is refused. Its port is free, so that a
port that ssh forwards under another number works. An ``Origin``, where the browser sends one, is that host and port.
"""

import hmac
import re
import secrets
from collections.abc import Sequence

REFUSED = "403: open the address that the terminal shows\n"
"""All that is told to whoever may not ask."""

HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "frame-ancestors 'none'",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}
"""Of every answer: it is kept nowhere, shown in no frame, and its address told to nobody."""

_THIS_MACHINE = re.compile(r"(127\.0\.0\.1|localhost|\[::1\])(:[0-9]{1,5})?", re.IGNORECASE)


class Guard:
    """The secret of one server, and the check of what is asked of it."""

    def __init__(self) -> None:
        self._secret = secrets.token_urlsafe(24)

    def address(self, host: str, port: int) -> str:
        """What to open in a browser."""
        return f"http://{host}:{port}/{self._secret}/"

    def inside(self, target: str, hosts: Sequence[str], origins: Sequence[str]) -> str | None:
        """What a request asks for.

        Args:
            target: of the request line.
            hosts: every ``Host`` header; exactly one is right.
            origins: every ``Origin`` header; none, or one.

        Returns:
            The path below the secret, from ``/`` on, with the query; None: the request is to be refused.
        """
        if len(hosts) != 1 or not _THIS_MACHINE.fullmatch(hosts[0]):
            return None
        if [origin.lower() for origin in origins] not in ([], [f"http://{hosts[0]}".lower()]):
            return None
        path, question, query = target.partition("?")
        first, _, rest = path[1:].partition("/")
        known = hmac.compare_digest(first.encode("utf-8", "replace"), self._secret.encode())
        return f"/{rest}{question}{query}" if known and path.startswith("/") else None
