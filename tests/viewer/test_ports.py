"""A port is the one that was asked for, or is refused in one line."""

import errno
import os
import socket

import pytest

from frontal_biped.cli import main
from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.viewer import LiveViewer
from frontal_biped.viewer.ports import listening_socket


@pytest.fixture
def taken():
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen()
        yield server.getsockname()[1]


def test_the_port_is_the_one_asked_for_or_the_first_free_one(taken):
    listening, port = listening_socket(0, taken, "")
    with listening:
        assert taken < port < taken + 100 and listening.getsockname() == ("127.0.0.1", port)
    listening, same = listening_socket(port, 1, "")
    with listening:
        assert same == port


def test_a_taken_port_is_told_with_the_remedy(taken):
    with pytest.raises(FrontalBipedError, match=f"^port {taken} is in use; take another$"):
        listening_socket(taken, 1, "take another")


@pytest.mark.parametrize("port", [-1, 65536, 80000, 99999])
def test_there_are_ports_up_to_65535(port):
    """80000 would be served as 80000 - 65536, and told as 80000."""
    with pytest.raises(
        FrontalBipedError, match=rf"^port {port} is not from 1 to 65535, nor 0 .* free one; name another"
    ):
        LiveViewer(port=port)


def test_a_port_of_the_system_is_told_as_one(monkeypatch):
    class OfAnOrdinaryUser(socket.socket):  # whom some systems, and all of them root, let serve on any port
        def bind(self, address):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr("frontal_biped.viewer.ports.socket.socket", OfAnOrdinaryUser)
    with pytest.raises(FrontalBipedError, match=r"^port 80 is for the system's own servers, below 1024; "):
        LiveViewer(port=80)


def test_a_port_that_is_not_permitted_is_not_called_taken(monkeypatch):
    def refuse(self, address):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(socket.socket, "bind", refuse)
    with pytest.raises(FrontalBipedError, match=r"^port 80 is for the system's own servers, below 1024; remedy$"):
        listening_socket(80, 1, "remedy")


@pytest.mark.parametrize("command", [["view", "frontal_biped.gait.json"], ["studio"]])
@pytest.mark.parametrize("port", ["80000", "99999", "65536", "-1", "1.5", "x", "", "9" * 5000, "٣٣"])
def test_the_command_line_takes_ports_only(command, port, capsys):
    assert main([*command, "--no-open", f"--port={port}"]) == 2
    error = capsys.readouterr().err
    assert (
        error.count("\n") == 1
        and len(error) < 300
        and "is not a port from 1 to 65535, or 0 for the first free one" in error
    )
