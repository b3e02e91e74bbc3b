"""Requests by hand, as no browser would send them."""

import re
import socket
from urllib.parse import urlsplit

UPGRADE = (
    "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
    "Sec-WebSocket-Version: 13\r\n"
)


def asked(port, text):
    """The whole answer to a request: until it is as long as it says, its server closes, or is silent for a second."""
    with socket.create_connection(("127.0.0.1", port), timeout=1.0) as client:
        client.sendall(text.encode("latin-1"))
        answer = b""
        try:
            while not _is_whole(answer) and (part := client.recv(65536)):
                answer += part
        except (TimeoutError, ConnectionResetError):
            pass
    return answer.decode("latin-1")


def _is_whole(answer):
    head, _, body = answer.partition(b"\r\n\r\n")
    length = re.search(rb"\r\ncontent-length: *([0-9]+)", head, re.IGNORECASE)
    return length is not None and len(body) >= int(length[1])


def get(url, *headers, path=None, version="1.1", method="GET"):
    """The answer to a request with these header lines, below the secret of ``url`` or with another path."""
    parts = urlsplit(url)
    lines = "".join(f"{line}\r\n" for line in (*headers, "Connection: close"))
    return asked(parts.port, f"{method} {parts.path if path is None else path} HTTP/{version}\r\n{lines}\r\n")


def refusals(url):
    """Requests of those who may not ask, by name: the answer to each."""
    parts = urlsplit(url)
    port, own = parts.port, f"Host: 127.0.0.1:{parts.port}"
    secret = parts.path.strip("/")
    wrong = ("A" if secret[0] != "A" else "B") + secret[1:]
    foreign = {
        "no secret": ((own,), "/"),
        "a wrong secret": ((own,), f"/{wrong}/"),
        "half of the secret": ((own,), f"/{secret[:16]}/"),
        "the secret and more": ((own,), f"/{secret}x/"),
        "a secret that is no text": ((own,), "/\xe9\xff/"),
        "a favicon": ((own,), "/favicon.ico"),
        "climbing out of the secret": ((own,), f"/x/../{secret}/"),
        "another host's name": ((f"Host: stranger.test:{port}",), None),
        "a name that begins like ours": ((f"Host: 127.0.0.1.stranger.test:{port}",), None),
        "every address": ((f"Host: 0.0.0.0:{port}",), None),
        "a user before the host": ((f"Host: 127.0.0.1@stranger.test:{port}",), None),
        "another origin": ((own, f"Origin: http://stranger.test:{port}"), None),
        "another port's origin": ((own, f"Origin: http://127.0.0.1:{port + 1}"), None),
        "this machine's other name": ((own, f"Origin: http://localhost:{port}"), None),
        "no origin at all": ((own, "Origin: null"), None),
        "an empty origin": ((own, "Origin:"), None),
        "two origins": ((own, f"Origin: http://127.0.0.1:{port}", "Origin: http://stranger.test"), None),
        "a secure origin": ((own, f"Origin: https://127.0.0.1:{port}"), None),
        "an absolute address": ((own,), f"http://stranger.test{parts.path}"),
        "an absolute address of ours": ((own,), f"http://127.0.0.1:{port}{parts.path}"),
    }
    return {
        f"{name}{', by web socket' if upgrade else ''}": get(
            url, *headers, *(UPGRADE.split("\r\n")[:-1] if upgrade else ()), path=path
        )
        for name, (headers, path) in foreign.items()
        for upgrade in (False, True)
    }


def malformed(url):
    """Requests that are none, by name: the answer to each."""
    parts = urlsplit(url)
    own = f"Host: 127.0.0.1:{parts.port}"
    path = parts.path
    return {
        "no host": get(url),
        "no host, as long ago": get(url, version="1.0"),
        "two hosts": get(url, own, own),
        "two different hosts": get(url, own, "Host: stranger.test"),
        "nonsense": asked(parts.port, "nonsense\r\n\r\n"),
        "bytes": asked(parts.port, "\x00\xff\x16\x03\x01\r\n\r\n"),
        "an endless header": get(url, "Host: stranger.test", "X-Long: " + "x" * 100_000),
        "many headers": get(url, "Host: stranger.test", *(f"X-{i}: x" for i in range(5000))),
        "an endless path": get(url, own, path="/" + "x" * 100_000),
        "POST": get(url, own, "Content-Length: 1", path="/", method="POST") + asked(
            parts.port, f"POST {path} HTTP/1.1\r\n{own}\r\nContent-Length: 4\r\nConnection: close\r\n\r\nsave"
        ),
        "PUT": get(url, own, "Content-Length: 0", method="PUT"),
        "DELETE": get(url, own, method="DELETE"),
        "TRACE": get(url, own, "X-Told: back", method="TRACE"),
        "CONNECT": get(url, own, path="stranger.test:443", method="CONNECT"),
        "OPTIONS": get(url, own, f"Origin: http://127.0.0.1:{parts.port + 1}", method="OPTIONS"),
    }  # fmt: skip


def status(answer):
    """Of an answer; 0 where the connection was closed without one."""
    return int(answer.split(" ", 2)[1]) if answer else 0
