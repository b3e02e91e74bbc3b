"""Worker processes as copies of the process that asks for them: what they have, and how they end."""

import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest

from frontal_biped.library.executors import can_be_copied

ROOT = Path(__file__).parents[2]

linux = pytest.mark.skipif(sys.platform != "linux", reason="only there are processes copied")


def script(body: str) -> list[str]:
    """A process of one thread, as the command line is; the tests' own may have more."""
    head = """
        import os, sys, threading, time
        from frontal_biped.numerics.threads import one_thread
        one_thread()
        from frontal_biped.library.executors import can_be_copied, worker_processes
    """
    return [sys.executable, "-c", textwrap.dedent(head) + textwrap.dedent(body)]


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT)}


def output(body: str) -> str:
    done = subprocess.run(script(body), env=environment(), capture_output=True, text=True, timeout=120, check=True)
    assert done.stderr == ""
    return done.stdout


def gone(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    return False


@linux
def test_a_copy_has_what_its_parent_has():
    """What was imported or set there: without ``copies``, a worker begins afresh."""
    body = """
        sys.mark = "set in the parent"

        def mark():
            return getattr(sys, "mark", "afresh")

        with worker_processes(2, copies=True) as executor:
            worker = executor.submit(os.getpid).result()
            print(executor.submit(mark).result(), worker != os.getpid())
    """
    assert output(body) == "set in the parent True\n"


@linux
def test_a_process_of_two_threads_is_not_copied():
    """Its workers begin afresh, also where copies are allowed."""
    body = """
        end = threading.Event()
        thread = threading.Thread(target=end.wait)
        alone = can_be_copied()
        thread.start()
        print(alone, can_be_copied())
        with worker_processes(1, copies=True) as executor:
            print(executor._mp_context.get_start_method())
        end.set()
    """
    assert output(body) == "True False\nspawn\n"


def test_where_there_is_no_telling_nothing_is_copied(monkeypatch):
    def absent(_):
        raise FileNotFoundError(2, "No such file or directory", "/proc/self/task")

    monkeypatch.setattr(Path, "iterdir", absent)
    assert not can_be_copied()


@linux
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_copies_end_with_their_parent(number):
    """However it ends, and however many they are: the first of them holds what the others watch."""
    body = """
        with worker_processes(3, copies=True) as executor:
            executor.submit(os.getpid).result()
            for _ in range(3):
                executor.submit(time.sleep, 600.0)
            print(*executor._processes, flush=True)
            time.sleep(600.0)
    """
    with subprocess.Popen(script(body), env=environment(), stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        workers = [int(word) for word in parent.stdout.readline().split()]
        assert len(workers) == 3 and not any(gone(worker) for worker in workers)
        parent.send_signal(number)
        parent.wait(timeout=60.0)
        deadline = time.monotonic() + 60.0
        while not all(gone(worker) for worker in workers):
            assert time.monotonic() < deadline
            time.sleep(0.05)


@linux
def test_an_error_stops_copies_at_once():
    body = """
        began = time.monotonic()
        try:
            with worker_processes(1, copies=True) as executor:
                executor.submit(os.getpid).result()
                executor.submit(time.sleep, 600.0)
                time.sleep(0.2)
                1 / 0
        except ZeroDivisionError:
            print(time.monotonic() - began < 60.0)
    """
    assert output(body) == "True\n"
