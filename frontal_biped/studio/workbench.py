"""What the studio knows and decides: robot, specification, last good gait, and what is worked on next.

Two workers: one designs, the other pushes and certifies, so a slider never waits for either. The newest request wins.
A specification without a gait leaves the last good one on screen, with the reason beside it. Knows no browser: a
listener is called after every change and reads the state.

A browser can send what its page does not offer. So a robot is one of the list, by name; a slider stands between its
ends, and a push is no larger than the largest. Files have names of ours, in the folder that the command line named.
"""

import contextlib
import os
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol

from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.files.atomic import write_text
from frontal_biped.gait.check import ConstraintReport
from frontal_biped.gait.file import save_gait
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.specification import GaitSpecification, default_specification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import robot_names
from frontal_biped.studio import jobs
from frontal_biped.studio.drawing import Clip, Drawing
from frontal_biped.studio.knobs import Knob, Value, knobs_for
from frontal_biped.studio.worker import Job, Listener, NewestFirst


class Worker(Protocol):
    """What a workbench asks of a worker; see `worker.NewestFirst`."""

    def submit(self, job: Job, *arguments: Any) -> int:
        """Run a job instead of what runs; returns the number of the request."""

    def close(self) -> None:
        """End."""


@dataclass(frozen=True)
class State:
    """Everything there is to show.

    Attributes:
        robot: name.
        specification: where the sliders stand.
        drawing: of the robot; None until it is drawn.
        gait: the last good gait; None before the first.
        report: its C01 to C09.
        clip: the gait as an animation.
        curves: the gait in curves, HTML; "" before the first.
        fits: was the gait designed for the specification as it stands?
        designing: what the designer does; "" when it rests.
        explanation: why there is no gait for the specification; "" where there is one.
        seconds: wall time of the last design.
        designs: gaits found so far.
        previous_cost: J of the gait before this one; None at the first.
        certificate: of the gait; None until it is there.
        proof: statements on the gait, with their verdicts by measurement and by proof; () until they are there.
        busy: what the second worker does; "" when it rests.
        push: outcome of the last push on this gait; "" without one.
        push_recovered: did it recover?
        push_clip: the pushed walk, to be shown once; None without one.
        notice: the last thing saved, or an error.
    """

    robot: str
    specification: GaitSpecification
    drawing: Drawing | None = None
    gait: Gait | None = None
    report: ConstraintReport | None = None
    clip: Clip | None = None
    curves: str = ""
    fits: bool = False
    designing: str = ""
    explanation: str = ""
    seconds: float = 0.0
    designs: int = 0
    previous_cost: float | None = None
    certificate: jobs.Certified | None = None
    proof: tuple[jobs.Row, ...] = ()
    busy: str = ""
    push: str = ""
    push_recovered: bool = False
    push_clip: Clip | None = None
    notice: str = ""
    knobs: tuple[Knob, ...] = field(default=(), repr=False)


class Workbench:
    """The studio without its screen.

    Args:
        robot: as for `load_robot`.
        folder: where files are saved.
        make_worker: worker of a listener and a name; another one in tests.

    Attributes:
        robots: that can be chosen: the one given here, and the packaged ones.

    Raises:
        RobotError: the robot cannot be loaded.
    """

    def __init__(self, robot: str, folder: Path, make_worker: Callable[[Listener, str], Worker] = NewestFirst) -> None:
        self.folder = folder
        self.on_change: Callable[[State], None] = lambda _: None
        self._lock = threading.RLock()
        self._biped, self.state = _opened(robot)
        self.robots = tuple(dict.fromkeys([robot, *robot_names()]))
        self._designer = make_worker(self._on_design, "studio-designer")
        self._helper = make_worker(self._on_help, "studio-helper")
        self._design_number = self._help_number = 0
        self._wanted: dict[str, tuple[Job, tuple[Any, ...]]] = {}
        self._helping = ""

    # ------------------------------------------------------------------ what the user does
    def begin(self) -> None:
        """Draw the robot and find its first gait."""
        with self._lock:
            self._change(designing="loading the robot")
            self._help("draw", jobs.draw, self.state.robot)
            self._design_number = self._designer.submit(jobs.opening, self.state.robot, self.state.specification)

    def choose_robot(self, name: str) -> None:
        """Take another robot, with the specification that suits it; on an error the present one stays."""
        with self._lock:
            if name not in self.robots:
                self._change(notice=f"no robot {name[:40]!r} is offered here; choose one of the list")
                return
            try:
                self._biped, self.state = _opened(name)
            except FrontalBipedError as error:
                self._change(notice=str(error))
                return
            self._wanted.clear()
            self._helping = ""
            self.begin()

    def turn(self, key: str, value: Value) -> bool:
        """Move a slider; the gait is designed anew. False: it cannot stand there, and the explanation says why."""
        with self._lock:
            knob = next((knob for knob in self.state.knobs if knob.key == key), None)
            if knob is None:  # of the robot before
                return True
            try:
                specification = knob.applied(self.state.specification, value)
            except FrontalBipedError as error:
                self._change(explanation=str(error), fits=False)
                return False
            if specification != self.state.specification:
                self.design(specification)
            return True

    def design(self, specification: GaitSpecification) -> None:
        """Design for a specification, from the present gait."""
        with self._lock:
            self._change(specification=specification, designing="designing", fits=False, explanation="")
            self._design_number = self._designer.submit(jobs.design, self.state.robot, specification, self.state.gait)

    def reset(self) -> None:
        """Back to the specification that suits the robot."""
        with self._lock:
            self.design(default_specification(self._biped))

    def push(self, impulse: float, moment: str) -> None:
        """Push the robot; positive is outwards [N s]."""
        with self._lock:
            if not abs(impulse) <= jobs.LARGEST_PUSH or moment not in jobs.PUSH_MOMENTS:
                largest = f"{jobs.LARGEST_PUSH:g} N s"
                self._change(
                    notice=f"no push of {impulse:g} N s, {moment[:40]!r}: up to {largest}, at a time of the list"
                )
                return
            if self.state.gait is None:
                self._change(notice="there is no gait to push yet")
                return
            self._change(push="", push_clip=None)
            self._help("push", jobs.push, self.state.robot, self.state.gait, impulse, moment)

    def save(self) -> None:
        """Write gait file and page of the present gait, under names that are not taken."""
        with self._lock:
            if self.state.gait is None:
                self._change(notice="there is no gait to save yet")
                return
            try:
                stem = _claimed_stem(self.folder, Path(self.state.robot).stem)
                path = self.folder / f"{stem}.gait.json"
                with _unclaimed_on_error(path):
                    save_gait(self.state.gait, path)
            except OSError as error:
                self._change(
                    notice=f"{self.folder}: {error.strerror or error}; start the studio with -o, a folder that you may"
                    " write to"
                )
                return
            self._change(notice=f"saved {path.name}; the page follows")
            self._help(f"page {stem}", jobs.page, self.state.robot, self.state.gait)

    def close(self) -> None:
        """End both workers."""
        self._designer.close()
        self._helper.close()

    # ------------------------------------------------------------------ what the workers say
    def _on_design(self, number: int, kind: str, content: Any) -> None:
        with self._lock:
            if number != self._design_number:
                return  # overtaken while this thread waited
            if kind == "news":
                self._change(designing=content)
            elif kind == "error":
                self._change(designing="", explanation=content)
            elif content is not None and content.gait is None:
                # the last good gait stays on screen
                self._change(designing="", explanation=content.message, seconds=content.seconds)
            elif content is not None:
                before = self.state.gait
                self._change(
                    gait=content.gait,
                    report=content.report,
                    clip=content.clip,
                    curves=content.curves,
                    fits=True,
                    designing="",
                    explanation="",
                    seconds=content.seconds,
                    designs=self.state.designs + 1,
                    previous_cost=None if before is None else before.orbit.cost,
                    certificate=None,
                    proof=(),
                    push="",
                    push_clip=None,
                )
                if self._wanted.pop("push", None) and self._helping == "push":
                    self._helping = ""  # of the gait before
                self._wanted.pop("prove", None)  # likewise
                self._help("certify", jobs.certify, self.state.robot, content.gait)

    def _on_help(self, number: int, kind: str, content: Any) -> None:
        with self._lock:
            if number != self._help_number:
                return
            if kind == "news":
                self._change(busy=content)
                return
            task, self._helping = self._helping, ""
            self._wanted.pop(task, None)
            if kind == "error":
                self._change(busy="", notice=content)
            elif task == "draw":
                self._change(busy="", drawing=content)
            elif task == "push":
                self._change(busy="", push=content.message, push_recovered=content.recovered, push_clip=content.clip)
            elif task == "certify":
                self._change(busy="", certificate=content)
                if jobs.PROVABLE and self.state.gait is not None:
                    self._wanted["prove"] = (jobs.prove, (self.state.robot, self.state.gait))
            elif task == "prove":
                self._change(busy="", proof=content)
            else:
                self._write_page(task.removeprefix("page "), content)
            self._next()

    def _write_page(self, stem: str, text: str) -> None:
        path = self.folder / f"{stem}.html"
        try:
            _claim(path)
            with _unclaimed_on_error(path):
                write_text(path, text)
        except OSError as error:
            self._change(busy="", notice=f"{path}: {error.strerror or error}; the gait is saved, the page is not")
            return
        self._change(busy="", notice=f"saved {stem}.gait.json and {path.name} in {self.folder.resolve()}")

    def _help(self, name: str, job: Job, *arguments: Any) -> None:
        """Want something of the second worker: a newer wish of one kind replaces the older one; proofs wait longest."""
        self._wanted[name] = (job, arguments)
        if self._helping in ("", name, "certify", "prove"):
            self._next()

    def _next(self) -> None:
        order = ("draw", "page", "push", "certify", "prove")
        if self._wanted:
            self._helping = min(self._wanted, key=lambda name: order.index(name.split()[0]))
            job, arguments = self._wanted[self._helping]
            self._help_number = self._helper.submit(job, *arguments)

    def _change(self, **changes: Any) -> None:
        self.state = replace(self.state, **changes)
        self.on_change(self.state)


def _opened(name: str) -> tuple[FrontalBiped, State]:
    biped = jobs.robot(name)
    return biped, State(name, default_specification(biped), knobs=knobs_for(biped))


def _claimed_stem(folder: Path, name: str) -> str:
    """A name that neither a gait file nor a page has; the gait file is there then, empty."""
    folder.mkdir(parents=True, exist_ok=True)
    number = 0
    while True:
        number += 1
        stem = f"{name}-{number}"
        if not os.path.lexists(folder / f"{stem}.html"):
            with contextlib.suppress(FileExistsError):
                _claim(folder / f"{stem}.gait.json")
                return stem


def _claim(path: Path) -> None:
    """Make an empty file where nothing is, not even a link; what is there belongs to somebody else."""
    os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))


@contextlib.contextmanager
def _unclaimed_on_error(path: Path) -> Iterator[None]:
    try:
        yield
    except BaseException:
        path.unlink(missing_ok=True)
        raise
