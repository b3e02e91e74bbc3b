"""The live viewer starts, serves, and is gone afterwards: no process, no port."""

import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pytest

from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.visualisation import LiveViewer, view_live

SCRIPT = """
from frontal_biped.gait import load_gait
from frontal_biped.model import load_robot
from frontal_biped.visualisation import orbit_trajectory, view_live
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


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="counts processes in /proc")
@pytest.mark.parametrize("ending", [signal.SIGTERM, signal.SIGINT, signal.SIGKILL], ids=lambda s: s.name)
def test_no_orphan_after_a_signal(ending):
    code = SCRIPT.format(gait=str(Path(__file__).parent / "data" / "gait.json"))
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
    assert is_free(int(url.rstrip("/").rsplit(":", 1)[1]))
