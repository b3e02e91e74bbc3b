"""Commands that are killed, ended or interrupted while they write: nothing half-written, nothing lost, one line."""

import contextlib
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import kill_campaign
import pytest

from frontal_biped.cli import interruption, main, robots
from frontal_biped.exceptions import Interruption

KILLS = 20
"""Drawn from all cases of the campaign; `python tests/kill_campaign.py` runs as many as wanted."""


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    return kill_campaign.undisturbed(tmp_path_factory.mktemp("reference"))


@pytest.mark.slow
@pytest.mark.parametrize("case", random.Random(16).sample(list(kill_campaign.cases()), KILLS), ids=str)
def test_killed_while_writing(case, reference, tmp_path):
    assert kill_campaign.kill(case, tmp_path, reference) == ""


def command(monkeypatch, work):
    """A command that does something of ours."""
    monkeypatch.setattr(robots, "run", work)
    return main(["robots"])


@pytest.mark.parametrize("number", interruption.SIGNALS)
def test_signals_unwind_and_are_told_in_one_line(number, monkeypatch, capsys):
    unwound = []
    before = [signal.getsignal(each) for each in interruption.SIGNALS]

    def work(_):
        try:
            signal.raise_signal(number)
        finally:
            unwound.append(number)

    assert command(monkeypatch, work) == 128 + number
    assert capsys.readouterr().err == "frontal-biped: error: interrupted; nothing was left half-written\n"
    assert unwound == [number]
    assert [signal.getsignal(each) for each in interruption.SIGNALS] == before


def test_a_second_ctrl_c_at_once_leaves_the_unwinding_alone(monkeypatch, capsys):
    unwound = []

    def work(_):
        try:
            signal.raise_signal(signal.SIGINT)
        finally:
            signal.raise_signal(signal.SIGINT)
            unwound.append("whole")

    assert command(monkeypatch, work) == 130
    assert unwound == ["whole"]
    assert capsys.readouterr().err.count("\n") == 1


def test_a_second_ctrl_c_later_interrupts_an_unwinding_that_hangs(monkeypatch, capsys):
    monkeypatch.setattr(interruption, "ECHO", 0.0)

    def work(_):
        try:
            signal.raise_signal(signal.SIGINT)
        finally:
            signal.raise_signal(signal.SIGTERM)
            time.sleep(60.0)

    assert command(monkeypatch, work) == 143
    assert capsys.readouterr().err.count("\n") == 1


def test_what_is_ignored_stays_so(monkeypatch):
    """As SIGHUP is under nohup."""
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        assert command(monkeypatch, lambda _: signal.raise_signal(signal.SIGHUP) or 0) == 0
    finally:
        signal.signal(signal.SIGHUP, before)


def test_a_library_says_that_it_goes_on(tmp_path, monkeypatch, capsys):
    from frontal_biped.library import build

    def stop(*_):
        raise Interruption(signal.SIGINT)

    monkeypatch.setattr(build, "design_batch", stop)
    (tmp_path / "sweep.toml").write_text("[sweep]\nfriction = [0.5]\n")
    assert main(["library", str(tmp_path / "sweep.toml"), "-o", str(tmp_path / "gaits")]) == 130
    assert capsys.readouterr().err == (
        "frontal-biped: error: interrupted; run the same command again to go on: what is finished is kept\n"
    )


@pytest.mark.slow
@pytest.mark.browser
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=lambda number: number.name)
@pytest.mark.parametrize("later", [0.0, 2.0])
def test_a_picture_is_interrupted_quietly(number, later, tmp_path):
    """Chromium and its driver, in the same process group, end too; nothing is said of futures."""
    pytest.importorskip("playwright")
    line = ["export", str(kill_campaign.DATA / "gait.json"), "-o", "out.gif", "--fps", "50"]
    process = subprocess.Popen(
        [sys.executable, "-m", "frontal_biped", *line],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    while not browser_of(process.pid) and process.poll() is None:
        time.sleep(0.02)
    time.sleep(later)
    os.killpg(process.pid, number)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out) == (128 + number, "")
    assert err == "frontal-biped: error: interrupted; nothing was left half-written\n"
    assert list(tmp_path.iterdir()) == []


def browser_of(process: int) -> bool:
    """Has it, or a process of its, started Chromium?"""
    found = subprocess.run(["pgrep", "-P", str(process)], capture_output=True, text=True, check=False).stdout.split()
    for child in map(int, found):
        with contextlib.suppress(OSError):
            if b"chrom" in Path(f"/proc/{child}/cmdline").read_bytes():
                return True
        if browser_of(child):
            return True
    return False


def test_interrupted_while_it_is_imported():
    code = (
        "import signal, sys, runpy\n"
        "class Finder:\n"
        "    def find_spec(self, name, *_):\n"
        "        if name == 'frontal_biped.cli.main': signal.raise_signal(signal.SIGINT)\n"
        "sys.meta_path.insert(0, Finder())\n"
        "runpy.run_module('frontal_biped', run_name='__main__')"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "frontal-biped: error: interrupted before it began\n")
