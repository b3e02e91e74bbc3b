"""A port of this machine to serve on."""

import errno
import socket

from frontal_biped.exceptions import FrontalBipedError

HOST = "127.0.0.1"  # this machine only; from another one, forward the port with ssh
PORTS = 100
"""How many are tried where none is asked for."""

LARGEST_PORT = 65535


def listening_socket(port: int, first: int, remedy: str) -> tuple[socket.socket, int]:
    """A socket that listens, and its port.

    Args:
        port: the one to take; 0: the first free one.
        first: where to begin to look for a free one.
        remedy: the end of every complaint.

    Raises:
        FrontalBipedError: there is no such port, it is taken, or it is not for this user.
    """
    if not 0 <= port <= LARGEST_PORT:
        raise FrontalBipedError(f"port {port} is not from 1 to {LARGEST_PORT}, nor 0 for the first free one; {remedy}")
    for candidate in [port] if port else range(first, first + PORTS):
        listening = socket.socket()
        try:
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listening.bind((HOST, candidate))
            listening.listen(128)
        except OSError as error:
            listening.close()
            if port and error.errno in (errno.EACCES, errno.EPERM):
                raise FrontalBipedError(f"port {port} is for the system's own servers, below 1024; {remedy}") from None
            continue
        listening.setblocking(False)
        return listening, candidate
    asked = f"port {port} is in use" if port else f"no port from {first} to {first + PORTS - 1} is free"
    raise FrontalBipedError(f"{asked}; {remedy}")
