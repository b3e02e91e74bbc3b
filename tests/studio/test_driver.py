"""The process that walks as it is steered: it tells, obeys from the next step on, and ends with whoever began it."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import pytest

from frontal_biped.simulation.space.steered import Order
from frontal_biped.studio.driver import Driver

pytest.importorskip("mujoco")

PATIENCE = 300.0  # [s] on a busy machine


def gone(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    return False


class Heard:
    def __init__(self):
        self.said, self.changed = [], threading.Condition()

    def __call__(self, kind, content):
        with self.changed:
            self.said.append((kind, content))
            self.changed.notify_all()

    def of(self, kind):
        return [content for said, content in self.said if said == kind]

    def until(self, done):
        with self.changed:
            assert self.changed.wait_for(lambda: done(self), PATIENCE), self.of("news") + self.of("ended")


@pytest.mark.slow
def test_it_walks_as_it_is_steered_and_ends_when_it_is_closed(tmp_path):
    heard = Heard()
    driver = Driver("simple_humanoid_bent", None, tmp_path, heard)
    try:
        heard.until(lambda h: h.of("picture") and h.of("picture")[-1].steps >= 1)
        assert len(heard.of("ready")) == 1
        order = Order(0.1, 0.0, 0.0)
        driver.steer(order)
        heard.until(lambda h: h.of("picture")[-1].answered[1] > 0)
        given, answered = heard.of("picture")[-1].answered
        assert answered == given + 1
        assert heard.of("picture")[-1].order == order
        before = heard.of("picture")[-1]
        heard.until(lambda h: h.of("picture")[-1].steps >= before.steps + 3)
        assert heard.of("picture")[-1].com[0] > before.com[0] + 0.05
    finally:
        driver.close()
    assert gone(driver.pid)
    count = len(heard.said)
    time.sleep(0.5)
    assert len(heard.said) == count and heard.of("ended") == []


@pytest.mark.slow
def test_a_robot_that_cannot_walk_in_space_is_told(tmp_path):
    heard = Heard()
    driver = Driver("no such robot", None, tmp_path, heard)
    heard.until(lambda h: h.of("ended"))
    driver.close()
    assert "no such robot" in heard.of("ended")[0]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_it_ends_with_a_killed_parent():
    script = textwrap.dedent(
        """
        import os, signal, sys, threading
        from pathlib import Path
        from frontal_biped.studio.driver import Driver
        if __name__ == "__main__":
            walks = threading.Event()
            driver = Driver("simple_humanoid_bent", None, Path(), lambda kind, _: kind == "picture" and walks.set())
            print(driver.pid, walks.wait(300.0), flush=True)
            os.kill(os.getpid(), signal.SIGKILL)
        """
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=PATIENCE, check=False)
    pid, walked = done.stdout.split()
    assert walked == "True" and done.returncode == -signal.SIGKILL
    end = time.monotonic() + 20.0
    while not gone(int(pid)) and time.monotonic() < end:
        time.sleep(0.1)
    assert gone(int(pid))
