"""What of a scenario file (TOML) is read otherwise for a walk of the whole robot in space, ``space = true``.

Everything that `frontal_biped.scenarios.file` lists holds in space too, but for these keys:

    space = true
    robot = "talos_full"
    speed = 0.2                            # m/s, forwards, from the start; a number or a range, as all below
    lateral = 0.0                          # m/s, to the left
    turn = 0.0                             # rad/s, to the left
    # no simulator, MuJoCo walks; no flat_landing

    [controller]                           # or controller = "walker", "my_module:make"
    type = "walker"                        # `SpatialWalker`; your own is called with (free, biped, gait, period=...)
    output = 60.0                          # and every other key of WholeBodySettings

    [[command]]                            # and as often as wanted
    step = 5                               # from 1; or time = 3.0 (s)
    speed = 0.3                            # lateral, turn; what is left out stays as it is

    [model]                                # every body of the robot on its own
    mass = {within = 0.1}                  # or 1.1, for all
    inertia = {within = 0.1}
    com = {within = 0.01}                  # m, along each axis

    [disturbances]                         # no torque_limits, no rolls: feet roll in any case
    velocity_noise = 0.02                  # rad/s, of joint rates; left out: exact, but not read behind noisy encoders
    imu_noise = 1e-3                       # rad, about each axis of the root link
    gyro_noise = 5e-3                      # rad/s, about each

    [[push]]
    at = "reversal of step 5"              # or time = 1.2, as in the plane
    impulse = [0.0, 10.0, 0.0]             # N s: forwards, to the left, upwards; or a size, with
    # impulse = 10.0
    # direction = {within = 180.0}         # degrees from forwards to the left
    link = "torso_2_link"                  # of the URDF; left out: the root link
    point = [0.0, 0.0, 0.1]                # m, in the axes of the link from its origin

    [expect]
    walking_speed = [0.18, 0.22]           # m/s, mean over the second half of the steps
    cop_margin = 0.0                       # m, fore and aft, inside the sole; fri_margin is that to either side
    yaw_drift = 0.01                       # rad, of the pelvis
    torque = 1.0                           # of the limits of any joint
    joint_speed = 1.0                      # of the limits of any joint
    self_collisions = 0                    # instants at which links touch, at most

A walk along a path is one from a stand to a stand, without speeds and commands (`frontal_biped.control.path.language`
has its words):

    space = true
    robot = "talos_full"
    path = "stand 1; forward 2; turn 90; stop"
    steps = 100                            # after which it gives up

    [expect]
    path_distance = 0.1                    # m, from where the path was to end; in truth, not by odometry
    path_angle = 0.09                      # rad
"""

from pathlib import Path
from typing import Any

from frontal_biped.control.path.language import PathError, parse_path
from frontal_biped.exceptions import ScenarioError
from frontal_biped.files.counted import counted
from frontal_biped.files.table import Range, Table, Value
from frontal_biped.scenarios.moments import read_moment, tables_of
from frontal_biped.scenarios.scenario import CommandPlan, Scenario, SpacePlan, SpatialPushPlan
from frontal_biped.simulation.pushes import PROFILES

_SPEEDS = {"speed": (3.0, "m/s"), "lateral": (3.0, "m/s"), "turn": (3.0, "rad/s")}
"""Largest size of each, and its unit."""

SPACE_KEYS = (*_SPEEDS, "command", "path")
"""Keys and sections of a scenario file that only a walk in space has."""

SPACE_EXPECTED = {
    "cop_margin": (-1.0, 1.0, "m"),
    "yaw_drift": (1e-9, 10.0, "rad"),
    "joint_speed": (1e-6, 10.0, "(share of the limits)"),
    "path_distance": (1e-9, 100.0, "m"),
    "path_angle": (1e-9, 4.0, "rad"),
}

_ONLY_IN_SPACE = (*SPACE_EXPECTED, "walking_speed", "self_collisions")
_OF_PATHS = ("path_distance", "path_angle")
_ONLY_IN_THE_PLANE = ("stabiliser",)


def read_space(path: Path, table: Table) -> SpacePlan:
    """What only a walk in space has, from the table of a scenario file."""
    factors, within = _model(path, table)
    return SpacePlan(
        _commands(path, table), _pushes(path, table), factors, within, _velocity_noise(path, table), _path(path, table)
    )


def check_space(scenario: Scenario, table: Table) -> None:
    """What is wrong only in space, or only in the plane."""
    path, expect = scenario.path, scenario.expect
    if scenario.space is None:
        for key in SPACE_KEYS:
            if key in table:
                table.refuse(key, "only a walk of the whole robot goes anywhere; write space = true, or leave it out")
        for key in _ONLY_IN_SPACE:
            if getattr(expect, key) is not None:
                raise ScenarioError(f"{path}: [expect] {key}: measured in space only; write space = true")
        return
    if scenario.simulator != "mujoco":
        table.refuse("simulator", 'only MuJoCo walks a whole robot; leave it out, or write simulator = "mujoco"')
    for key in _ONLY_IN_THE_PLANE:
        if getattr(scenario.controller, key) is not None:
            raise ScenarioError(f"{path}: [controller] {key}: of walks in the plane only; leave it out")
    if not scenario.space.path:
        for key in _OF_PATHS:
            if getattr(expect, key) is not None:
                raise ScenarioError(f'{path}: [expect] {key}: of walks along a path only; write path = "forward 2"')
    elif scenario.space.commands:
        raise ScenarioError(f"{path}: speed, lateral, turn or [[command]] beside path; write rates there, or leave it")
    elif scenario.controller.kind != "walker":
        table.refuse("path", "only the walker of this package follows one; leave controller out")
    for i, command in enumerate(scenario.space.commands):
        if command.step is not None and command.step >= scenario.steps:
            raise ScenarioError(
                f"{path}: [[command]] {i + 1}: step = {command.step + 1}: the walk has"
                f" {counted(scenario.steps, 'step')}; raise steps"
            )


def _commands(path: Path, table: Table) -> tuple[CommandPlan, ...]:
    plans = []
    if any(key in table for key in _SPEEDS):
        plans.append(_command(table, step=0))
    for i, each in enumerate(tables_of(table, "command")):
        section = Table(f"{path}: [[command]] {i + 1}:", each, ("step", "time", *_SPEEDS))
        if ("step" in section) == ("time" in section):
            remedy = "write either step = 5 (from 1) or time = 3.0 (s)"
            section.refuse("step", f"given beside time; {remedy}" if "step" in section else f"missing; {remedy}")
        if not any(key in section for key in _SPEEDS):
            section.refuse("speed", "missing; write speed = 0.2 (m/s), lateral or turn")
        if "step" in section:
            plans.append(_command(section, step=section.whole("step", 1, 1) - 1))
        else:
            plans.append(_command(section, time=section.number("time", 0.0, 0.0, 1e5, "s")))
    return tuple(plans)


def _command(section: Table, step: int | None = None, time: float | None = None) -> CommandPlan:
    speed, lateral, turn = (
        section.value(key, 0.0, -most, most, unit) if key in section else None for key, (most, unit) in _SPEEDS.items()
    )
    return CommandPlan(step, time, speed, lateral, turn)


def _pushes(path: Path, table: Table) -> tuple[SpatialPushPlan, ...]:
    plans = []
    for i, each in enumerate(tables_of(table, "push")):
        known = ("at", "time", "impulse", "direction", "duration", "profile", "link", "point")
        section = Table(f"{path}: [[push]] {i + 1}:", each, known)
        if "impulse" not in section:
            section.refuse("impulse", "missing; write impulse = [5.0, 0.0, 0.0] (N s: forwards, left, up)")
        plans.append(
            SpatialPushPlan(
                moment=read_moment(section),
                impulse=_impulse(section),
                direction=section.value("direction", 0.0, -360.0, 360.0, "degrees") if "direction" in section else None,
                duration=section.value("duration", 0.05, 1e-4, 60.0, "s"),
                profile=section.text("profile", "constant", PROFILES),
                link=section.text("link", "") if "link" in section else "",
                point=section.numbers("point", 3, -3.0, 3.0, "m") if "point" in section else (0.0, 0.0, 0.0),
            )
        )
    return tuple(plans)


def _impulse(section: Table) -> tuple[Value, ...]:
    """Three components, or one size where a direction is given."""
    given = section.content["impulse"]
    if "direction" in section:
        if isinstance(given, list):
            section.refuse("impulse", "three components have a direction; leave direction out, or give one size")
        return (section.value("impulse", 0.0, 0.0, 1e4, "N s"),)
    if not isinstance(given, list) or len(given) != 3:
        section.refuse("impulse", "not three components; write [0.0, 5.0, 0.0] (N s), or give a direction (degrees)")
    axes = ("forwards", "left", "up")
    components = Table(f"{section.where} impulse", dict(zip(axes, given, strict=True)), axes)
    return tuple(components.value(axis, 0.0, -1e4, 1e4, "N s") for axis in axes)


def _model(path: Path, table: Table) -> tuple[dict[str, float], dict[str, float]]:
    section = Table(f"{path}: [model]", table.content.get("model", {}), ("mass", "inertia", "com"))
    factors: dict[str, float] = {}
    within: dict[str, float] = {}
    for key in section.content:
        most, unit = (1.0, "m") if key == "com" else (0.9, "(relative)")
        value = section.value(key, 0.0, -20.0, 20.0, "(factor)")
        if isinstance(value, Range):
            if value.high != -value.low or not value.high <= most:
                section.refuse(key, f"not understood; write {{within = 0.1}}, at most {most:g} {unit}")
            within[key] = value.high
        elif key == "com":
            section.refuse(key, "bodies have axes of their own; write com = {within = 0.01} (m)")
        else:
            factors[key] = section.number(key, 1.0, 0.05, 20.0, "(factor)")
    return factors, within


def _path(path: Path, table: Table) -> str:
    if "path" not in table:
        return ""
    words = table.text("path", "")
    try:
        parse_path(words)
    except PathError as error:
        raise ScenarioError(f"{path}: {error}") from None
    return words


def _velocity_noise(path: Path, table: Table) -> Value | None:
    content: Any = table.content.get("disturbances", {})
    section = Table(f"{path}: [disturbances]", content, None)
    return section.value("velocity_noise", 0.0, 0.0, 10.0, "rad/s") if "velocity_noise" in section else None
