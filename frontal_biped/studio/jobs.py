"""What the studio's processes do: design, push, certify, draw. Plain functions of plain data, so they can travel.

The first argument of each, ``tell``, takes a line of news; a robot is named as for `load_robot`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from importlib.util import find_spec

import numpy as np

from frontal_biped.analysis.closed_form import analyze
from frontal_biped.analysis.push_recovery import (
    INSTANTS,
    PUSH_DURATION,
    RECOVERED,
    held_walk,
    speed_errors,
    time_in_step,
)
from frontal_biped.design.optimise import optimise_gait
from frontal_biped.files.counted import counted
from frontal_biped.gait.check import ConstraintReport
from frontal_biped.gait.file import load_gait
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.gait.verdict import judge
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import load_robot, models_dir
from frontal_biped.numerics.verdict import Verdict
from frontal_biped.simulation.orbit import orbit_trajectory
from frontal_biped.simulation.pushes import Push
from frontal_biped.studio.curves import gait_curves
from frontal_biped.studio.drawing import Clip, Drawing, clip_of, drawing_of
from frontal_biped.viewer.page import animation_page

Tell = Callable[[str], None]

Row = tuple[str, str, str]
"""Statement, measured, proved: of a table."""

LOOP_STEPS = 2
"""Steps of the gait on screen: left and right, then it repeats."""

STEPS_BEFORE, STEPS_AFTER = 1, 6
"""Steps walked before and after a push."""

PUSH_MOMENTS = dict(INSTANTS)
"""When to push: place in the step by name, see `push_recovery.INSTANTS`."""

LARGEST_PUSH = 40.0
"""That can be asked for, either way [N s]."""

PUSH_STABILISER = "ankle"


@dataclass(frozen=True)
class Designed:
    """Outcome of a design.

    Attributes:
        gait: the gait, or None.
        report: C01 to C09; None where no step exists.
        message: one line: what was reached, or what stands in the way and what to relax.
        seconds: wall time of the design.
        clip: the gait as an animation; None without a gait.
        curves: the gait in curves, HTML; "" without one.
    """

    gait: Gait | None
    report: ConstraintReport | None
    message: str
    seconds: float
    clip: Clip | None
    curves: str = ""


@dataclass(frozen=True)
class Pushed:
    """Outcome of a push.

    Attributes:
        recovered: did the robot walk on, back at its speed?
        message: one line.
        clip: the walk.
    """

    recovered: bool
    message: str
    clip: Clip


@dataclass(frozen=True)
class Certified:
    """The closed-form certificate of a gait.

    Attributes:
        certified: periodic, stable, invariant, reversing where planned, within every constraint?
        text: the verdict in one line, with what stands against it.
        residual: the largest.
        rows: (what, verdict) on the reversal point.
    """

    certified: bool
    text: str
    residual: float
    rows: tuple[tuple[str, str], ...]


@lru_cache(maxsize=2)
def robot(name: str) -> FrontalBiped:
    """A robot, loaded once a process."""
    return load_robot(name)


def draw(tell: Tell, name: str) -> Drawing:
    """Shapes, colours and camera of a robot and its surroundings."""
    tell("drawing the robot")
    return drawing_of(robot(name))


def design(tell: Tell, name: str, specification: GaitSpecification, start: Gait | None) -> Designed:
    """Design a gait, from another one where there is one.

    Args:
        tell: takes news.
        name: of the robot.
        specification: what the gait must satisfy.
        start: a gait to start from.
    """
    biped = robot(name)

    def show(iteration: int, cost: float, violation: float) -> None:
        missed = f", constraints missed by {violation:.0e}" if violation > 1e-6 else ""
        tell(f"designing: iteration {iteration}, J = {cost:.1f}{missed}")

    tell("designing")
    # from the present gait first: that is fast, where other starts and advice may take a minute
    hurried = start is not None
    result = optimise_gait(
        biped, specification, start=start, fall_back=not hurried, advise=not hurried, on_progress=show
    )
    if result.gait is None and hurried:
        tell("no way from the present gait; trying other starts, and what to relax")
        result = optimise_gait(biped, specification)
    clip, curves = (None, "") if result.gait is None else shown_gait(biped, result.gait)
    return Designed(result.gait, result.report, result.message, result.seconds, clip, curves)


def shown_gait(biped: FrontalBiped, gait: Gait) -> tuple[Clip, str]:
    """The periodic orbit as an animation that repeats, and in curves."""
    orbit = orbit_trajectory(biped, gait, LOOP_STEPS, samples=41)
    return clip_of(biped, orbit), gait_curves(orbit)


def push(tell: Tell, name: str, gait: Gait, impulse: float, moment: str) -> Pushed:
    """Push the robot at the pelvis, and see whether it walks on.

    Args:
        tell: takes news.
        name: of the robot.
        gait: what it walks.
        impulse: positive outwards, away from the swing foot [N s].
        moment: of `PUSH_MOMENTS`.
    """
    biped = robot(name)
    step = gait.step(biped)
    start = STEPS_BEFORE * step.duration + time_in_step(step, PUSH_MOMENTS[moment])
    # the left foot stands in steps 0, 2, ...; outwards is to the side of the foot that stands
    impulse_to_the_left = impulse * (-1.0) ** STEPS_BEFORE
    steps = STEPS_BEFORE + STEPS_AFTER
    shove = Push(float(start), PUSH_DURATION, impulse_to_the_left)
    tell("walking into the push")

    def on_step(done: int) -> None:
        tell(f"walking: step {done} of {steps}")

    run = held_walk(biped, gait, PUSH_STABILISER, shove, steps=steps, on_step=on_step)
    sense = "outwards" if impulse > 0.0 else "inwards"
    what = f"push of {abs(impulse):g} N s {sense}, {moment}"
    if run.fell:
        return Pushed(False, f"{what}: fell, {run.outcome}", clip_of(biped, run, shove))
    errors = speed_errors(run, gait)
    if errors[-1] > RECOVERED:
        left = f"speed still {100.0 * errors[-1]:.0f} % off after {STEPS_AFTER} steps"
        return Pushed(False, f"{what}: walks on, but {left}", clip_of(biped, run, shove))
    late = np.flatnonzero(errors > RECOVERED)
    count = int(late[-1]) - STEPS_BEFORE + 1 if len(late) else 0
    within = f"within {100.0 * RECOVERED:.0f} % of its speed after {counted(count, 'step')}"
    return Pushed(True, f"{what}: recovered, {within}", clip_of(biped, run, shove))


def certify(tell: Tell, name: str, gait: Gait) -> Certified:
    """The closed-form analysis with the number of reversal points; takes seconds."""
    tell("counting reversal points")
    analysis = analyze(robot(name), gait)
    found = analysis.certificate
    rows = () if found is None else tuple((title.strip(), text) for title, text in found.rows())
    return Certified(analysis.certified, analysis.certificate_text, max(analysis.residuals.values()), rows)


PROVABLE = find_spec("flint") is not None
"""Is the extra `proof` installed?"""


def prove(tell: Tell, name: str, gait: Gait) -> tuple[Row, ...]:
    """What is proved of a gait beside what is measured of it; takes 40 s, and the extra `proof`."""
    from frontal_biped.analysis.proof import prove
    from frontal_biped.analysis.statements import in_brief, statements

    tell("proving it in ball arithmetic")
    biped = robot(name)
    found = statements(analyze(biped, gait, in_space=False), prove(biped, gait).proof)
    return tuple(statement.row for statement in in_brief(found))


def page(tell: Tell, name: str, gait: Gait) -> str:
    """One self-contained page with the gait."""
    tell("writing the page")
    biped = robot(name)
    return animation_page(biped, orbit_trajectory(biped, gait), title=f"{biped.name}: J = {gait.orbit.cost:.1f}")


def shipped_gait(name: str) -> Gait | None:
    """The gait that comes with a packaged robot, if one does and still fits."""
    path = models_dir() / f"{name}.gait.json"
    if "/" in name or not path.is_file():
        return None
    gait = load_gait(path)
    return gait if gait.robot.fingerprint == robot(name).fingerprint else None


def opening(tell: Tell, name: str, specification: GaitSpecification) -> Designed:
    """The first gait of a robot: the one that comes with it where it suits the specification, or a design."""
    gait = shipped_gait(name)
    if gait is None or gait.specification != specification:
        return design(tell, name, specification, gait)
    biped = robot(name)
    judged = judge(biped, gait)
    if judged.verdict is not Verdict.CERTIFIED:
        return design(tell, name, specification, gait)
    message = f"J = {gait.orbit.cost:.4f} N^2 m s: the gait that comes with the robot"
    return Designed(gait, judged.constraints, message, 0.0, *shown_gait(biped, gait))
