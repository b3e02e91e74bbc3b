"""Read a scenario file (TOML): what walks, what disturbs it, what is expected.

Every key has a default; what ``[expect]`` does not name is not asked.

    name = "push"                          # default: the file's name
    about = "pushed at the chest on slippery ground, by a robot that is not quite its model"  # one line for reports
    robot = "frontal_biped"                # a name, or a description or URDF file beside this one
    gait = "robust"                        # a packaged specification, a gait or specification file, or [gait], its keys
    simulator = "ours"                     # or "mujoco"
    steps = 12
    seed = 0
    repeat = 2                             # trials; each draws its own numbers
    stance = "left"                        # first stance foot
    speed_error = 0.0                      # of the first post-impact speed, relative
    slow = false                           # pytest marks it slow
    flat_landing = 0.02                    # rad, up to which a landing foot settles flat; ours only

    [controller]                           # or controller = "walker", "qp", "my_module:make"
    type = "qp"                            # default: "qp", which is told state and events; in MuJoCo "walker"
    stabiliser = "ankle+step"
    period = 0.001                         # s
    frequency = 100.0                      # and every other key of ControllerSettings

    [model]                                # how the true robot differs from the one that the controller knows
    mass = {within = 0.1}                  # every link on its own; or 1.1; or {pelvis = 1.1, left_leg = 0.9}
    com = {pelvis = [0.005, 0.01]}         # (y, z), m
    inertia = 1.02
    length = {left_leg = 1.0}

    [disturbances]                         # numbers, or what each trial draws: {from = , to = }, {within = }
    friction = {from = 0.3, to = 0.9}      # coefficient; left out: the foot sticks whatever is asked of it
    rolls = false                          # does the foot roll over its edge, a fall, where the FRI leaves the sole?
    torque_noise = 0.01                    # relative
    encoder_noise = 0.0                    # rad
    quantisation = 0.0                     # rad, of the encoders
    imu_noise = 0.0                        # rad
    gyro_noise = 0.0                       # rad/s
    delay = 0.0                            # s, from reading to torque
    torque_limits = [150.0, 150.0]         # N m, ankle and hip, of the true motors
    ground = [0.0]                         # m, heights under the next landings
    ground_height = 0.0                    # m, heights that are drawn

    [[push]]
    at = "30 % of the rising phase of step 3"  # or "impact of step 3", "reversal of step 3"; or time = 1.2
    impulse = {within = 3.0}               # N s, to the robot's left
    duration = 0.1                         # s
    profile = "half-sine"                  # or "constant"
    height = 0.2                           # m above the hips

    [expect]                               # no fall, in any case; and what is asked here
    steps = 12                             # walked; left out: all that are asked for
    return_within = 8                      # steps after the push until the speed stays within return_tolerance
    return_tolerance = 0.1                 # of the orbit's
    torque = 1.0                           # of the limits
    output_error = 0.02                    # rad
    friction = 0.9                         # |F_h| / F_v
    fri_margin = 0.0                       # m inside the sole
    step_duration = [0.3, 1.2]             # s
    step_time_error = 0.2                  # of the mean step, relative
    speed_error = 0.1                      # of the last step, relative
    unsolved = 20                          # ticks whose program was not solved, at most
    survival = 0.9                         # share of the trials that pass

``space = true`` walks the whole robot in space (`frontal_biped.scenarios.space_file` has the keys that it changes).

``foot_slip`` [m] and ``foot_rotation`` [rad] can be expected in MuJoCo, where feet can move. ``delay`` [s] in
``[controller]`` is what a walker takes for the delay; left out, the true one. ``[controller.arguments]`` go to a
factory of your own. With a delay, ``output_error`` compares the joints with what is wanted of them when the torques
act, and is larger than the tracking error by about the delay times the joints' speed.
"""

import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from frontal_biped.control.settings import ControllerSettings
from frontal_biped.control.stabilisers.by_name import STABILISERS
from frontal_biped.control.whole_body.settings import WholeBodySettings
from frontal_biped.exceptions import ScenarioError, SpecificationError
from frontal_biped.files.counted import counted
from frontal_biped.files.quoted import quoted
from frontal_biped.files.table import Table
from frontal_biped.files.toml import as_finite, load_toml
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.perturbation import LEGS, LINKS, ModelErrors
from frontal_biped.model.stance_map import Stance
from frontal_biped.scenarios.moments import read_moment, tables_of
from frontal_biped.scenarios.scenario import (
    CONTROLLERS,
    SIMULATORS,
    ControllerChoice,
    Expectations,
    ModelPlan,
    PushPlan,
    Scenario,
)
from frontal_biped.scenarios.space_file import SPACE_EXPECTED, SPACE_KEYS, check_space, read_space
from frontal_biped.simulation.pushes import PROFILES

KEYS = (
    "name", "about", "robot", "gait", "simulator", "controller", "steps", "seed", "repeat", "stance", "speed_error",
    "slow", "flat_landing", "model", "disturbances", "push", "expect", "space", *SPACE_KEYS,
)  # fmt: skip
"""Keys and sections of a scenario file."""

MOST_STEPS, MOST_TRIALS = 100_000, 1_000_000

_FACTORY = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_]\w*")

# key: least and largest value, unit
_DISTURBANCES = {
    "encoder_noise": (0.0, 0.1, "rad"),
    "quantisation": (0.0, 0.1, "rad"),
    "imu_noise": (0.0, 0.1, "rad"),
    "gyro_noise": (0.0, 10.0, "rad/s"),
    "torque_noise": (0.0, 1.0, "(relative)"),
    "delay": (0.0, 0.1, "s"),
    "friction": (0.01, 10.0, "(coefficient)"),
    "ground_height": (0.0, 0.1, "m"),
}
_EXPECTED = {
    "output_error": (1e-12, np.pi, "rad"),
    "torque": (1e-6, 1.0, "(share of the limits)"),
    "friction": (1e-3, 10.0, "(coefficient)"),
    "fri_margin": (-1.0, 1.0, "m"),
    "step_time_error": (1e-9, 1.0, "(relative)"),
    "speed_error": (1e-9, 1.0, "(relative)"),
    "foot_slip": (1e-9, 1.0, "m"),
    "foot_rotation": (1e-9, 1.5, "rad"),
    **SPACE_EXPECTED,
}


def load_scenario(path: Path | str) -> Scenario:
    """Read and check a scenario file (TOML).

    Raises:
        ScenarioError: the file is missing or malformed, a key is unknown, a value is of the wrong type or out of range,
            or parts do not go together; one line with file, field, value and remedy.
    """
    path = Path(path)
    table = Table(f"{path}:", load_toml(path, ScenarioError), KEYS)
    default = path.name.removesuffix(".toml").removesuffix(".scenario")
    name = table.text("name", default)
    in_space = table.flag("space", False)
    if not re.fullmatch(r"\w[\w .,+-]*", name):
        table.refuse("name", "not a name for a file; use letters, digits, spaces and -")
    scenario = Scenario(
        name=name,
        path=path,
        about=table.text("about", "") if "about" in table else "",
        robot=str(_beside(path, table.text("robot", "frontal_biped"))),
        gait=_gait(path, table),
        simulator=table.text("simulator", "mujoco" if in_space else "ours", SIMULATORS),
        steps=table.whole("steps", 20, 1, MOST_STEPS),
        seed=table.whole("seed", 0, 0),
        repeat=table.whole("repeat", 1, 1, MOST_TRIALS),
        stance=Stance(table.text("stance", "left", ("left", "right"))),
        speed_error=table.value("speed_error", 0.0, -0.9, 5.0, "(relative)"),
        slow=table.flag("slow", False),
        flat_landing=table.number("flat_landing", 0.02, 0.0, 0.5, "rad") if "flat_landing" in table else None,
        controller=_controller(path, table, in_space),
        model=ModelPlan() if in_space else _model(path, table),
        disturbances=_disturbances(path, table, in_space),
        pushes=() if in_space else _pushes(path, table),
        space=read_space(path, table) if in_space else None,
        expect=_expectations(path, table),
    )
    _check_together(scenario, table)
    check_space(scenario, table)
    return scenario


def _beside(path: Path, text: str) -> Path | str:
    """A file named relative to the scenario, or a name."""
    looks_like_file = Path(text).suffix in (".toml", ".urdf", ".json") or "/" in text
    return path.parent / text if looks_like_file else text


def _gait(path: Path, table: Table) -> Path | str | dict[str, Any] | None:
    if "gait" not in table:
        return None
    value = table.content["gait"]
    if isinstance(value, dict):
        try:
            GaitSpecification.from_dict(value, "[gait]")
        except SpecificationError as error:
            raise ScenarioError(f"{path}: gait = {quoted(value)}: {error}") from None
        return dict(value)
    return _beside(path, table.text("gait", ""))


def _controller(path: Path, table: Table, in_space: bool) -> ControllerChoice:
    settings = WholeBodySettings if in_space else ControllerSettings
    own = tuple(f.name for f in fields(settings))
    content = table.content.get("controller", {})
    if isinstance(content, str):
        content = {"type": content}
    section = Table(f"{path}: [controller]", content, ("type", "stabiliser", "period", "delay", "arguments", *own))
    # sensor readings are all that MuJoCo gives
    sensed = in_space or table.content.get("simulator") == "mujoco"
    kind = section.text("type", "walker" if sensed else "qp")
    if kind not in CONTROLLERS and not _FACTORY.fullmatch(kind):
        section.refuse("type", f'unknown; write one of {", ".join(CONTROLLERS)}, or "module:factory" of your own')
    arguments = Table(f"{path}: [controller.arguments]", section.content.get("arguments", {}), None)
    given = {key: value for key, value in section.content.items() if key in own}
    for key, value in arguments.content.items():
        if not _plain(value):
            arguments.refuse(key, "neither number, text nor truth value, nor a list or table of them")
    if kind in CONTROLLERS and arguments.content:
        section.refuse("arguments", 'only your own factory takes them; write type = "module:factory"')
    others = [key for key in (*given, "stabiliser", "delay") if key in section]
    if kind not in CONTROLLERS and others:
        key = others[0]
        section.refuse(key, "your own factory is not asked for it; put it into [controller.arguments]")
    return ControllerChoice(
        kind=kind,
        stabiliser=section.text("stabiliser", "", tuple(STABILISERS)) if "stabiliser" in section else None,
        period=section.number("period", 1e-3, 1e-5, 0.02, "s"),
        delay=section.number("delay", 0.0, 0.0, 0.1, "s") if "delay" in section else None,
        settings={key: _setting(section, key, settings) for key in given},
        arguments=dict(arguments.content),
    )


def _plain(value: Any) -> bool:
    """Is it one that JSON has too, and so run files? TOML has dates as well, and numbers that are not finite."""
    if isinstance(value, dict | list):
        return all(map(_plain, value.values() if isinstance(value, dict) else value))
    return isinstance(value, str | bool) or as_finite(value) is not None


def _setting(section: Table, key: str, settings: type[ControllerSettings | WholeBodySettings]) -> Any:
    """A key of the controller's settings, of the type that its default has."""
    default = next(f.default for f in fields(settings) if f.name == key)
    value = section.content[key]
    if isinstance(value, list):
        return section.numbers(key, 4, 1e-9, 1e6, "N m")
    if isinstance(default, bool):
        return section.flag(key, default)
    if isinstance(default, int):
        return section.whole(key, default, 1, 10**6)
    if isinstance(default, str):
        return section.text(key, default)
    return section.number(key, 0.0, 0.0, 1e9, "(not negative)")


def _model(path: Path, table: Table) -> ModelPlan:
    section = Table(f"{path}: [model]", table.content.get("model", {}), ("mass", "com", "inertia", "length"))
    fixed: dict[str, Any] = {}
    within: dict[str, float] = {}
    for key in section.content:
        links, shifts = (LEGS if key == "length" else LINKS), key == "com"
        array = np.zeros((len(links), 2)) if shifts else np.ones(len(links))
        value = section.content[key]
        if not isinstance(value, dict):
            if shifts:
                section.refuse("com", "not a table; write com = {pelvis = [0.01, 0.0]} or {within = 0.02}, (y, z) in m")
            fixed[key] = np.full(len(links), section.number(key, 1.0, 0.05, 20.0, "(factor)"))
            continue
        part = Table(f"{path}: [model] {key}", value, (*links, "within"))
        for i, link in enumerate(links):
            if link in part:
                array[i] = (
                    part.numbers(link, 2, -1.0, 1.0, "m")
                    if shifts
                    else part.number(link, 1.0, 0.05, 20.0, "(factor, 1 for no error)")
                )
        fixed[key] = array
        if "within" in part:
            most = 1.0 if shifts else 0.9
            within[key] = part.number("within", 0.0, 0.0, most, "m" if shifts else "(relative)")
    return ModelPlan(ModelErrors(**fixed), within)


def _disturbances(path: Path, table: Table, in_space: bool) -> dict[str, Any]:
    known = (*_DISTURBANCES, "ground", *(["velocity_noise"] if in_space else ["rolls", "torque_limits"]))
    section = Table(f"{path}: [disturbances]", table.content.get("disturbances", {}), known)
    found: dict[str, Any] = {}
    for key in section.content:
        if key == "ground":
            found[key] = section.numbers(key, None, -0.1, 0.1, "m")
        elif key == "rolls":
            found[key] = section.flag(key, False)
        elif key == "torque_limits":
            found[key] = section.numbers(key, 2, 1e-3, 1e5, "N m: [ankle, hip]")
        elif key != "velocity_noise":  # that one is read with what only a walk in space has
            low, high, unit = _DISTURBANCES[key]
            found[key] = section.value(key, low, low, high, unit)
    return found


def _pushes(path: Path, table: Table) -> tuple[PushPlan, ...]:
    plans = []
    for i, each in enumerate(tables_of(table, "push")):
        known = ("at", "time", "impulse", "duration", "profile", "height")
        section = Table(f"{path}: [[push]] {i + 1}:", each, known)
        if "impulse" not in section:
            section.refuse("impulse", "missing; write impulse = 5.0 (N s, to the robot's left)")
        plans.append(
            PushPlan(
                moment=read_moment(section),
                impulse=section.value("impulse", 0.0, -1e4, 1e4, "N s"),
                duration=section.value("duration", 0.05, 1e-4, 60.0, "s"),
                profile=section.text("profile", "constant", PROFILES),
                height=section.number("height", 0.0, -3.0, 3.0, "m"),
            )
        )
    return tuple(plans)


def _expectations(path: Path, table: Table) -> Expectations:
    known = tuple(f.name for f in fields(Expectations))
    section = Table(f"{path}: [expect]", table.content.get("expect", {}), known)
    found: dict[str, Any] = {}
    for key in section.content:
        if key in ("steps", "return_within"):
            found[key] = section.whole(key, 1, 1, MOST_STEPS)
        elif key in ("unsolved", "self_collisions"):
            found[key] = section.whole(key, 0, 0)
        elif key == "survival":
            found[key] = section.number(key, 1.0, 0.0, 1.0, "(share of the trials)")
        elif key == "return_tolerance":
            found[key] = section.number(key, 0.05, 1e-6, 1.0, "(relative)")
        elif key == "step_duration":
            low, high = section.numbers(key, 2, 1e-3, 60.0, "s: [shortest, longest]")
            if low > high:
                section.refuse(key, "the shortest is above the longest; exchange them")
            found[key] = (low, high)
        elif key == "walking_speed":
            low, high = section.numbers(key, 2, -5.0, 5.0, "m/s: [least, largest]")
            if low > high:
                section.refuse(key, "the least is above the largest; exchange them")
            found[key] = (low, high)
        else:
            found[key] = section.number(key, 0.0, *_EXPECTED[key])
    return Expectations(**found)


def _check_together(scenario: Scenario, table: Table) -> None:
    """What is wrong only beside something else."""
    path, steps, expect = scenario.path, scenario.steps, scenario.expect
    for key in ("steps", "return_within"):
        asked = getattr(expect, key)
        if asked is not None and asked > steps:
            raise ScenarioError(f"{path}: [expect] {key} = {asked}: the walk has {counted(steps, 'step')}; raise steps")
    for i, moment in enumerate(scenario.push_moments):
        if moment.time is None and moment.step > steps:
            at = f"{path}: [[push]] {i + 1}: at names step {moment.step}"
            raise ScenarioError(f"{at}: the walk has {counted(steps, 'step')}; raise steps or push earlier")
    if len(scenario.disturbances.get("ground", ())) > steps:
        count = len(scenario.disturbances["ground"])
        raise ScenarioError(
            f"{path}: [disturbances] ground has {count} heights for {counted(steps, 'step')}; leave some out"
        )
    if scenario.simulator == "mujoco" and scenario.controller.kind == "qp":
        raise ScenarioError(
            f'{path}: controller = "qp" is told state and events, which only our simulator can;'
            ' write controller = "walker" or simulator = "ours"'
        )
    if scenario.simulator == "mujoco" and scenario.flat_landing is not None:
        table.refuse("flat_landing", 'MuJoCo has its own contact; leave it out or write simulator = "ours"')
    if scenario.simulator == "ours":
        for key in ("foot_slip", "foot_rotation"):
            if getattr(expect, key) is not None:
                raise ScenarioError(
                    f"{path}: [expect] {key} = {getattr(expect, key):g}: our simulator's foot rests;"
                    ' leave it out or write simulator = "mujoco"'
                )
    if "return_tolerance" in table.content.get("expect", {}) and expect.return_within is None:
        raise ScenarioError(f"{path}: [expect] return_tolerance without return_within; say within how many steps")
    if scenario.repeat > 1 and not scenario.random:
        table.refuse("repeat", "nothing in the scenario is random, all trials would be the same; leave it out")
