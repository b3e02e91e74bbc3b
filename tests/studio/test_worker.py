"""The worker process: newest request first, errors told, no orphan."""

import os
import queue
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest

from frontal_biped.exceptions import RobotError
from frontal_biped.studio.worker import NewestFirst

PATIENCE = 60.0  # [s] for a process to start on a busy machine


def echo(tell, value):
    tell(f"got {value}")
    return value


def spin(tell, path):
    """Never ends by itself, and tells nothing that could be cancelled there."""
    Path(path).write_text("spinning")
    while True:
        sum(range(100))


def fail(tell):
    raise RobotError("no such robot")


def surprise(tell):
    raise ZeroDivisionError("by zero")


def die(tell):
    os._exit(3)


@pytest.fixture
def worker():
    heard = queue.Queue()
    found = NewestFirst(lambda *message: heard.put(message), "test-worker")
    found.heard = heard
    yield found
    found.close()


def until(worker, kind):
    while True:
        message = worker.heard.get(timeout=PATIENCE)
        if message[1] == kind:
            return message


def gone(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    state = Path(f"/proc/{pid}/stat")
    return state.exists() and state.read_text().split(")")[1].split()[0] == "Z"


def test_newest_request_interrupts_the_one_that_runs(worker, tmp_path):
    flag = tmp_path / "flag"
    first = worker.submit(spin, str(flag))
    until_spinning = time.monotonic() + PATIENCE
    while not flag.exists() and time.monotonic() < until_spinning:
        time.sleep(0.02)
    assert flag.exists()
    numbers = [worker.submit(echo, value) for value in (1, 2, 3)]
    assert numbers[0] > first
    assert until(worker, "done") == (numbers[-1], "done", 3)
    assert worker.heard.empty()  # of the others nothing is heard


def test_errors_are_told_and_the_process_goes_on(worker):
    assert until_error(worker, fail) == "no such robot"
    assert until_error(worker, surprise) == "ZeroDivisionError: by zero"
    number = worker.submit(echo, "alive")
    assert until(worker, "done") == (number, "done", "alive")


def until_error(worker, job):
    worker.submit(job)
    return until(worker, "error")[2]


def test_dead_process_is_replaced(worker):
    before = worker.pid
    assert "started again" in until_error(worker, die)
    assert worker.pid != before
    worker.submit(echo, "alive")
    assert until(worker, "done")[2] == "alive"


def test_close_ends_a_busy_process(worker, tmp_path):
    flag = tmp_path / "flag"
    worker.submit(spin, str(flag))
    while not flag.exists():
        time.sleep(0.02)
    pid = worker.pid
    worker.close()
    worker.close()
    assert gone(pid)


def test_process_ends_with_a_killed_parent():
    script = textwrap.dedent(
        """
        import os, signal, sys, time
        from frontal_biped.studio.worker import NewestFirst
        if __name__ == "__main__":
            worker = NewestFirst(lambda *_: None)
            print(worker.pid, flush=True)
            time.sleep(0.5)
            os.kill(os.getpid(), signal.SIGKILL)
        """
    )
    out = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=PATIENCE).stdout
    pid, end = int(out), time.monotonic() + 20.0
    while not gone(pid) and time.monotonic() < end:
        time.sleep(0.1)
    assert gone(pid)
