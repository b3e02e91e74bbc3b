"""Signals wait for a pause in the conversation with the browser; a browser that ends is one line."""

import os
import signal
import subprocess
from pathlib import Path

import pytest

from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.files.signals import serve_signals, signals_wait
from frontal_biped.viewer import headless

PAGE = "<script>window.page = {seek() {}}; window.viewer = {animator: {duration: 1}}</script><main>a page</main>"


class Stopped(BaseException):
    pass


@pytest.fixture
def stopping():
    """SIGTERM raises `Stopped`."""

    def stop(*_):
        raise Stopped

    before = signal.signal(signal.SIGTERM, stop)
    yield
    signal.signal(signal.SIGTERM, before)


def test_a_signal_waits_for_a_pause(stopping):
    said = []
    with pytest.raises(Stopped), signals_wait():
        signal.raise_signal(signal.SIGTERM)
        signal.raise_signal(signal.SIGTERM)
        said.append("whole")
        serve_signals()
        said.append("never")
    assert said == ["whole"]
    with pytest.raises(Stopped), signals_wait():
        signal.raise_signal(signal.SIGTERM)
    with pytest.raises(Stopped):  # and afterwards it does not wait
        signal.raise_signal(signal.SIGTERM)


def test_a_second_one_later_breaks_in(stopping, monkeypatch):
    monkeypatch.setattr("frontal_biped.files.signals.LONGEST_WAIT", -1.0)
    with pytest.raises(Stopped), signals_wait():
        signal.raise_signal(signal.SIGTERM)
        signal.raise_signal(signal.SIGTERM)
        pytest.fail("it was not heard")


@pytest.mark.browser
def test_a_browser_that_ends(tmp_path):
    pytest.importorskip("playwright")
    with (
        pytest.raises(FrontalBipedError, match="Chromium could not show the page: ") as caught,
        headless.opened_page(PAGE, (200, 200)) as page,
    ):
        for child in _children(os.getpid()):
            if b"chrom" in _command(child) and b"--remote-debugging" in _command(child):
                os.kill(child, signal.SIGKILL)
        headless.picture(page, 0.0)
    assert "\n" not in str(caught.value)


def _children(process: int) -> list[int]:
    found = subprocess.run(["pgrep", "-P", str(process)], capture_output=True, text=True, check=False).stdout.split()
    return [each for child in map(int, found) for each in (child, *_children(child))]


def _command(process: int) -> bytes:
    try:
        return Path(f"/proc/{process}/cmdline").read_bytes()
    except OSError:
        return b""
