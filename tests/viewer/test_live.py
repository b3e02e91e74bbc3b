"""The live viewer starts, serves, and is gone afterwards: no process, no port."""

import os
import re
import signal
import socket
import struct
import subprocess
import sys
import time
import urllib.request
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.simulation import save_trajectory
from frontal_biped.viewer import LiveViewer, view_live

SCRIPT = """
from frontal_biped.gait import load_gait
from frontal_biped.model import load_robot
from frontal_biped.simulation import orbit_trajectory
from frontal_biped.viewer import view_live
robot = load_robot("frontal_biped")
view_live(robot, orbit_trajectory(robot, load_gait({gait!r})), open_browser=False)
"""


def is_free(port):
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
        except OSError:
            return False
        return True


def children(pid):
    found = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = status.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(fields[1]) == pid:
            found.append(int(status.parent.name))
    return found


def fetch(url):
    with urllib.request.urlopen(url, timeout=5) as answer:
        return answer.read().decode()


def test_serves_the_page_and_frees_the_port(biped, orbit, capsys):
    viewer = view_live(biped, orbit, open_browser=False, wait=False)
    try:
        assert viewer.url in capsys.readouterr().out
        page = fetch(viewer.url)
        assert '<div id="scene">' in page
        assert len(viewer.packed()) > 40
        assert not is_free(viewer.port)
    finally:
        viewer.close()
    assert is_free(viewer.port)
    viewer.close()  # a second time does nothing


def test_two_viewers_take_two_ports():
    with LiveViewer() as one, LiveViewer() as two:
        assert one.port != two.port
        with pytest.raises(FrontalBipedError, match=f"port {one.port} is in use"):
            LiveViewer(port=one.port)


def test_drawing_after_the_end_does_not_hang(biped, orbit):
    import meshcat

    with LiveViewer() as viewer:
        visualizer = meshcat.Visualizer(window=viewer)
    visualizer["late"].set_property("visible", False)


def test_opens_no_browser_in_continuous_integration(biped, orbit, monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", lambda *args, **kwargs: opened.append(args))
    monkeypatch.setenv("CI", "1")
    view_live(biped, orbit, wait=False).close()
    assert opened == []
    monkeypatch.delenv("CI")
    monkeypatch.setenv("DISPLAY", ":0")
    view_live(biped, orbit, wait=False).close()
    assert len(opened) == 1


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="counts processes in /proc")
@pytest.mark.parametrize("ending", [signal.SIGTERM, signal.SIGINT, signal.SIGKILL], ids=lambda s: s.name)
def test_no_orphan_after_a_signal(ending):
    code = SCRIPT.format(gait=str(Path(__file__).parents[1] / "data" / "gait.json"))
    viewer = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=os.environ
    )
    try:
        line = viewer.stdout.readline()
        url = next(word for word in line.split() if word.startswith("http"))
        assert '<div id="scene">' in fetch(url)
        assert children(viewer.pid) == []
        time.sleep(0.3)  # it has begun to wait
        viewer.send_signal(ending)
        _, errors = viewer.communicate(timeout=10)
    finally:
        viewer.kill()
        viewer.communicate()
    assert errors == ""
    assert viewer.returncode == (-signal.SIGKILL if ending is signal.SIGKILL else 0)
    assert is_free(urlsplit(url).port)


# ---------------------------------------------------------------------- the command, as a user runs it
ENDS_WITHIN = 10.0  # [s], on a busy machine; it takes a fraction of one


@pytest.fixture(scope="module")
def run_file(orbit, tmp_path_factory):
    path = tmp_path_factory.mktemp("live") / "run.npz"
    save_trajectory(orbit, path)
    return path


def free_port():
    """One far from 7000, which viewers of other tests take as soon as it is free."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@contextmanager
def viewing(run_file, port=None):
    """`frontal-biped view` in a process of its own, and its address; killed at the end if it still runs."""
    chosen = str(port or free_port())
    command = [sys.executable, "-m", "frontal_biped", "view", str(run_file), "--no-open", "--port", chosen]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        line = process.stdout.readline()
        assert "Ctrl+C" in line, process.stderr.read()
        yield process, next(word for word in line.split() if word.startswith("http"))
    finally:
        process.kill()
        process.communicate()


def ends(process, signum):
    process.send_signal(signum)
    _, errors = process.communicate(timeout=ENDS_WITHIN)
    assert errors == ""
    return process.returncode


def connect(url):
    """A browser's web socket by hand, as far as its first message."""
    port = urlsplit(url).port
    client = socket.create_connection(("127.0.0.1", port), timeout=5)
    client.sendall(
        f"GET {urlsplit(url).path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
    )
    assert b"101" in client.recv(64)
    return client, port


def vanish(client):
    """Gone without a goodbye: the connection is reset."""
    client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    client.close()


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="counts processes in /proc")
@pytest.mark.parametrize("ending", [signal.SIGTERM, signal.SIGINT, signal.SIGKILL], ids=lambda s: s.name)
def test_browsers_that_vanish_or_stall_do_no_harm(ending, run_file):
    with viewing(run_file) as (process, url):
        for _ in range(3):
            vanish(connect(url)[0])
        stalled, port = connect(url)  # never reads on, and is there to the end
        assert '<div id="scene">' in fetch(url)
        assert children(process.pid) == []
        assert ends(process, ending) == (-signal.SIGKILL if ending is signal.SIGKILL else 0)
        stalled.close()
        assert is_free(port)


def test_the_port_can_be_chosen_and_a_taken_one_is_named(run_file, capsys):
    port = free_port()
    with viewing(run_file, port) as (process, url):
        assert re.fullmatch(rf"http://127\.0\.0\.1:{port}/[-_A-Za-z0-9]{{32}}/", url)
        from frontal_biped.cli import main

        assert main(["view", str(run_file), "--no-open", "--port", str(port)]) == 2
        assert f"port {port} is in use" in capsys.readouterr().err
        assert ends(process, signal.SIGINT) == 0


@pytest.mark.browser
@pytest.mark.slow
def test_used_in_a_browser_closed_and_ended_under_an_open_one(browser, run_file):
    with viewing(run_file) as (process, url):
        for _ in range(2):
            page = browser.new_page(viewport={"width": 700, "height": 420})
            page.goto(url)
            page.wait_for_function("window.page && viewer.animator.duration > 0")
            page.locator("#play").click()
            page.wait_for_function("!viewer.animator.playing")
            if _ == 0:
                page.close()
        assert page.locator(".strip .mark").count() > 4
        assert ends(process, signal.SIGTERM) == 0
        page.keyboard.press("End")  # what was loaded stays in use
        assert page.evaluate("window.page.now() === window.page.duration()")
        page.close()
    assert is_free(urlsplit(url).port)
