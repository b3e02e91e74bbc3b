"""A process that walks in space as it is steered, and tells what is seen of it.

Of its own like the `worker`s, so that the page stays fluent; it keeps real time where the machine can, and walks slower
where it cannot. It ends when it is closed, when its parent ends, or with the walk.
"""

import contextlib
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.gait.gait import Gait
from frontal_biped.simulation.space.steered import Order, Picture

Listener = Callable[[str, Any], None]
"""Called with "news" and a line, "ready" and a `Ready`, "picture" and a `Picture`, "ended" and a line; in a thread of
its own."""

_PATIENCE = 2.0  # [s] for the process to leave by itself


class Driver:
    """The parent's end.

    Args:
        robot: as for `prepare_to_walk`.
        gait: walked if it is one for that robot; else, or None, what `prepare_to_walk` finds or makes.
        folder: where what is made for the robot is kept.
        listener: hears what happens.
    """

    def __init__(self, robot: str, gait: Gait | None, folder: Path, listener: Listener) -> None:
        self._listener, self._closing = listener, False
        context = multiprocessing.get_context("spawn")
        os.environ.setdefault("OMP_NUM_THREADS", "1")  # inherited: the matrices are too small for a second thread
        self._connection, theirs = context.Pipe()
        self._process = context.Process(
            target=serve, args=(theirs, robot, gait, folder), name="studio-walk", daemon=True
        )
        self._process.start()
        theirs.close()  # so that the end of the process closes the pipe
        threading.Thread(target=self._listen, name="studio-walk", daemon=True).start()

    @property
    def pid(self) -> int | None:
        """Of the process."""
        return self._process.pid

    def steer(self, order: Order) -> None:
        """Walk like this from the next step on."""
        with contextlib.suppress(OSError):  # it has ended, and that was told
            self._connection.send(order)

    def close(self) -> None:
        """End the process; a second call does nothing."""
        if self._closing:
            return
        self._closing = True
        for end in (self._process.terminate, self._process.kill):
            if self._process.is_alive():
                end()
                self._process.join(_PATIENCE)
        self._connection.close()

    def _listen(self) -> None:
        told = False
        while True:
            try:
                kind, content = self._connection.recv()
            except (EOFError, OSError):
                break
            if self._closing:
                return
            told = kind == "ended"
            self._listener(kind, content)
        if not told and not self._closing:
            self._listener("ended", "the walking process ended")


def serve(connection: Connection, robot: str, gait: Gait | None, folder: Path) -> None:
    """The process: prepare robot and gait, then walk until the robot falls or the parent ends.

    Args:
        connection: to the parent.
        robot: as for `prepare_to_walk`.
        gait: walked if it is one for that robot.
        folder: where what is made for the robot is kept.
    """
    from frontal_biped.design.preparation import prepare_to_walk
    from frontal_biped.simulation.space.steered import walk_steered
    from frontal_biped.studio.space_drawing import space_drawing_of

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is for the parent, which closes this process
    with contextlib.suppress(EOFError, BrokenPipeError, ConnectionResetError):
        try:
            ready = prepare_to_walk(robot, folder, None, lambda line: connection.send(("news", line)))
            own = gait is not None and gait.robot.fingerprint == ready.biped.fingerprint
            walked = gait if own and gait is not None else ready.gait
            connection.send(("ready", space_drawing_of(ready.biped)))
            pace = _Pace()

            def show(picture: Picture) -> None:
                connection.send(("picture", picture))
                pace.keep(picture.t)

            run = walk_steered(ready.biped, walked, lambda: _newest(connection), show)
            connection.send(("ended", f"fell after {run.steps_completed} steps: {run.outcome}"))
        except FrontalBipedError as error:
            connection.send(("ended", str(error)))


def _newest(connection: Connection) -> Order | None:
    order = None
    while connection.poll():
        order = connection.recv()
    return order


class _Pace:
    """Waits until the clock has caught up with the walk."""

    def __init__(self) -> None:
        self._began: float | None = None

    def keep(self, t: float) -> None:
        """Time t [s] of the walk has come."""
        now = time.monotonic()
        if self._began is None or now - t > self._began:
            self._began = now - t  # too slow: what is lost is not made up for
        else:
            time.sleep(self._began + t - now)
