"""What a trial is: robot, gait, controller, simulator, what disturbs the robot, and what is expected of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from frontal_biped.files.counted import counted
from frontal_biped.files.table import Range, Value
from frontal_biped.model.perturbation import ModelErrors
from frontal_biped.model.stance_map import Stance

SIMULATORS = ("ours", "mujoco")
CONTROLLERS = ("walker", "qp")
"""Kinds of controller of the package: one that sees sensor readings only, and one that is told state and events."""


@dataclass(frozen=True)
class ControllerChoice:
    """Which controller walks.

    Attributes:
        kind: one of `CONTROLLERS`, or "module:factory" of the user's own.
        stabiliser: by name, of the package's controllers; None: the walker's own default, `QP_STABILISER` for "qp".
        period: control period [s].
        delay: what the walker takes for the delay from reading to torque [s]; None: the true one.
        settings: keys of `ControllerSettings` that differ from the default.
        arguments: keyword arguments of the user's factory.
    """

    kind: str = "qp"
    stabiliser: str | None = None
    period: float = 1e-3
    delay: float | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)
    arguments: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Moment:
    """When a push begins.

    Attributes:
        time: after the start of the run [s]; or
        step: step, from 1, with
        phase: "rising" (from the impact on) or "falling" (from the reversal on), and
        fraction: of the planned duration of that phase that has passed [-].
    """

    time: Value | None = None
    step: int = 1
    phase: str = "rising"
    fraction: float = 0.0


@dataclass(frozen=True)
class PushPlan:
    """A push to come.

    Attributes:
        moment: when it begins.
        impulse: positive to the robot's left [N s].
        duration: [s].
        profile: "constant" or "half-sine".
        height: of its point above the hip line [m].
    """

    moment: Moment
    impulse: Value
    duration: Value = 0.05
    profile: str = "constant"
    height: float = 0.0


@dataclass(frozen=True, eq=False)
class ModelPlan:
    """How the true robot differs from the one the controller knows: fixed errors, and bounds of drawn ones.

    Attributes:
        fixed: the same in every trial.
        within: bounds of `ModelErrors.draw`, by name.
    """

    fixed: ModelErrors = field(default_factory=ModelErrors)
    within: Mapping[str, float] = field(default_factory=dict)

    @property
    def any(self) -> bool:
        """Is there any error?"""
        return self.fixed.any or any(self.within.values())


@dataclass(frozen=True)
class CommandPlan:
    """A change of speed to come, of a walk in space; what is None stays as it is.

    Attributes:
        step: given as this step begins, from 0; or
        time: given at this time [s].
        speed: forwards [m/s].
        lateral: to the left [m/s].
        turn: to the left [rad/s].
    """

    step: int | None = None
    time: float | None = None
    speed: Value | None = None
    lateral: Value | None = None
    turn: Value | None = None


@dataclass(frozen=True)
class SpatialPushPlan:
    """A push to come, of a walk in space.

    Attributes:
        moment: when it begins.
        impulse: forwards, to the left and upwards [N s]; or one size of a horizontal push, with
        direction: from forwards to the left [degrees].
        duration: [s].
        profile: "constant" or "half-sine".
        link: URDF name; "" for the root link.
        point: where it acts, in the axes of the link from its origin [m].
    """

    moment: Moment
    impulse: tuple[Value, ...]
    direction: Value | None = None
    duration: Value = 0.05
    profile: str = "constant"
    link: str = ""
    point: tuple[float, ...] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class SpacePlan:
    """What only a walk in space has.

    Attributes:
        commands: changes of speed, in the order of the file.
        pushes: on any link.
        path: words of the path that is walked, "" for none.
        factors: of all masses and inertias, by name [-].
        within: bounds of `SpatialErrors.draw`, by name.
        velocity_noise: standard deviation of the joint rates that are read [rad/s]; None: exact, and left out where
            encoders are noisy.
    """

    commands: tuple[CommandPlan, ...] = ()
    pushes: tuple[SpatialPushPlan, ...] = ()
    factors: Mapping[str, float] = field(default_factory=dict)
    within: Mapping[str, float] = field(default_factory=dict)
    velocity_noise: Value | None = None
    path: str = ""

    @property
    def drawn(self) -> list[Any]:
        """Everything that may be a range."""
        values: list[Any] = [self.velocity_noise]
        for command in self.commands:
            values += [command.speed, command.lateral, command.turn]
        for push in self.pushes:
            values += [push.moment.time, *push.impulse, push.direction, push.duration]
        return values


@dataclass(frozen=True)
class Expectations:
    """What must hold; None: not asked.

    Attributes:
        steps: steps walked without a fall; None: all that are asked for.
        output_error: largest |q_b - h_d| [rad].
        torque: largest torque as a share of the robot's limits [-].
        friction: largest |F_h| / F_v [-].
        fri_margin: least distance of the FRI from the ends of the sole [m]; negative beyond them.
        return_within: steps after the last push (or the start) until the post-impact speed stays near the orbit's.
        return_tolerance: how near, relative [-].
        step_duration: shortest and longest step [s].
        step_time_error: relative difference of the mean step duration from the planned one [-].
        speed_error: relative error of the last post-impact speed [-].
        unsolved: ticks whose quadratic program was not solved, at most.
        foot_slip: largest slip of a stance foot in one step [m]; MuJoCo only.
        foot_rotation: largest rotation of a stance foot [rad]; MuJoCo only.
        cop_margin: least distance of the fore-aft centre of pressure from the ends of the sole [m]; in space only.
        walking_speed: least and largest mean speed forwards over the second half of the steps [m/s]; in space only.
        yaw_drift: largest change of the pelvis' heading [rad]; in space only.
        joint_speed: largest joint speed as a share of the robot's limits [-]; in space only.
        self_collisions: instants at which links touch, at most; in space only.
        path_distance: from where a path was to end, at most [m]; in space only.
        path_angle: from where the robot was to look there, at most [rad]; in space only.
        survival: least share of the trials in which all of the above holds [-].
    """

    steps: int | None = None
    output_error: float | None = None
    torque: float | None = None
    friction: float | None = None
    fri_margin: float | None = None
    return_within: int | None = None
    return_tolerance: float = 0.05
    step_duration: tuple[float, float] | None = None
    step_time_error: float | None = None
    speed_error: float | None = None
    unsolved: int | None = None
    foot_slip: float | None = None
    foot_rotation: float | None = None
    cop_margin: float | None = None
    walking_speed: tuple[float, float] | None = None
    yaw_drift: float | None = None
    joint_speed: float | None = None
    self_collisions: int | None = None
    path_distance: float | None = None
    path_angle: float | None = None
    survival: float = 1.0


@dataclass(frozen=True, eq=False)
class Scenario:
    """One scenario file.

    Attributes:
        name: for reports.
        path: the file.
        about: one line on what it shows.
        robot: a name or a path, as `load_robot` takes it.
        gait: a gait file, keys of a specification to design, or the name or path of one; None: what is shipped.
        simulator: one of `SIMULATORS`.
        steps: to walk.
        seed: of everything random, unless another one is given.
        repeat: trials, unless another number is given.
        stance: first stance foot.
        speed_error: relative error of the first post-impact speed [-].
        slow: takes more than a few seconds; pytest marks it so.
        flat_landing: rotation up to which a landing foot settles flat [rad]; None: the simulator's. Ours only.
        controller: which.
        model: errors of the robot.
        disturbances: keys of `Disturbances` (without pushes and seed).
        pushes: on the pelvis, in the plane.
        space: what only a walk of the whole robot in space has; None: the robot walks in its frontal plane.
        expect: what must hold.
    """

    name: str
    path: Path
    about: str = ""
    robot: str = "frontal_biped"
    gait: Path | str | Mapping[str, Any] | None = None
    simulator: str = "ours"
    steps: int = 20
    seed: int = 0
    repeat: int = 1
    stance: Stance = Stance.LEFT
    speed_error: Value = 0.0
    slow: bool = False
    flat_landing: float | None = None
    controller: ControllerChoice = field(default_factory=ControllerChoice)
    model: ModelPlan = field(default_factory=ModelPlan)
    disturbances: Mapping[str, Any] = field(default_factory=dict)
    pushes: tuple[PushPlan, ...] = ()
    space: SpacePlan | None = None
    expect: Expectations = field(default_factory=Expectations)

    def __repr__(self) -> str:
        about = f"; {self.about}" if self.about else ""
        return f"Scenario {self.name!r}: {self.robot!r}, {counted(self.steps, 'step')} in {self.simulator!r}{about}"

    @property
    def push_moments(self) -> list[Moment]:
        """When the pushes begin, in the plane or in space."""
        moments = [push.moment for push in self.pushes]
        return moments if self.space is None else [push.moment for push in self.space.pushes]

    @property
    def random(self) -> bool:
        """Do two trials of different seeds differ?"""
        noises = ("encoder_noise", "torque_noise", "imu_noise", "gyro_noise", "ground_height")
        values = [self.speed_error, *self.disturbances.values()]
        for push in self.pushes:
            values += [push.moment.time, push.impulse, push.duration]
        noise, errors = any(self.disturbances.get(key) for key in noises), dict(self.model.within)
        if self.space is not None:
            values += self.space.drawn
            noise, errors = noise or bool(self.space.velocity_noise), {**errors, **self.space.within}
        return any(isinstance(value, Range) for value in values) or any(errors.values()) or noise
