"""One walker, two engines: what MuJoCo and our own simulator make of the same gait, side by side.

    frontal-biped design --spec rough -o gait.json
    frontal-biped simulate gait.json --engine both --steps 200 -v -o run.npz
    frontal-biped view run.mujoco.npz run.ours.npz --html page.html

puts the same walker into both engines and prints what they make of it, beside the closed form:

    frontal_biped                         mujoco        ours        gait
    steps walked                             200         200
    step time, s                          0.5863      0.5879      0.5877
      standard deviation, s               0.0005      0.0003
    speed half-way down off by, %          -0.90       -0.07
      at most, %                            1.05        0.07
    largest output error, rad            3.1e-03     1.3e-03
    largest slip of a foot, mm             0.049       0.000
    largest rotation of a foot, rad      5.8e-04     0.0e+00
    double support per step, ms              2.0         0.0
    work of the joints per step, J          9.22        9.25
    J, N^2 m s                            2432.8      2431.2      2428.6
    largest torque, of its limit            0.70        0.36
    unsolved control ticks                     0           0

``rough`` is a gait for this: a wide sway at nearly constant speed, the swing foot within 0.03 rad of level (with 0.1
rad some of the trials of `tests/benchmarks/benchmark_mujoco.py` landed on an edge), friction below 0.25.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from frontal_biped.files.counted import counted
from frontal_biped.gait.sideways import AnyGait, steps_in_turn
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.mid_fall import speed_errors
from frontal_biped.simulation.trajectory import COMPLETED, Trajectory
from frontal_biped.simulation.walking import walk


@dataclass(frozen=True)
class EngineReport:
    """What one engine says of a walk; nan where nothing was measured.

    Attributes:
        engine: "mujoco" or "ours".
        outcome: "completed", or how the robot fell.
        steps: completed.
        step_time: mean duration of a step [s].
        step_time_spread: its standard deviation [s].
        speed_error: speed sideways half-way down, relative to the closed form, mean over the steps [-].
        largest_speed_error: the largest of them, in absolute value [-].
        output_error: largest |q_b - h_d| [rad].
        foot_slip: largest motion of a stance foot after it has settled [m].
        foot_rotation: largest rotation of a stance foot from flat after it has settled [rad].
        double_support: mean time with both feet on the ground, per step [s].
        work: of the joint torques taken without sign, mean per step [J].
        cost: J of the walk, mean of the steps, their width taken as planned [N^2 m s].
        torque: largest, as a share of its limit [-].
        unsolved: ticks without torques that keep every limit.
    """

    engine: str
    outcome: str
    steps: int
    step_time: float
    step_time_spread: float
    speed_error: float
    largest_speed_error: float
    output_error: float
    foot_slip: float
    foot_rotation: float
    double_support: float
    work: float
    cost: float
    torque: float
    unsolved: int


_ROWS: tuple[tuple[str, str, str, int], ...] = (
    ("steps", "steps walked", "d", 1),
    ("step_time", "step time, s", ".4f", 1),
    ("step_time_spread", "  standard deviation, s", ".4f", 1),
    ("speed_error", "speed half-way down off by, %", "+.2f", 100),
    ("largest_speed_error", "  at most, %", ".2f", 100),
    ("output_error", "largest output error, rad", ".1e", 1),
    ("foot_slip", "largest slip of a foot, mm", ".3f", 1000),
    ("foot_rotation", "largest rotation of a foot, rad", ".1e", 1),
    ("double_support", "double support per step, ms", ".1f", 1000),
    ("work", "work of the joints per step, J", ".2f", 1),
    ("cost", "J, N^2 m s", ".1f", 1),
    ("torque", "largest torque, of its limit", ".2f", 1),
    ("unsolved", "unsolved control ticks", "d", 1),
)


@dataclass(frozen=True)
class CrossCheck:
    """The reports of the engines beside the closed form.

    Attributes:
        robot: name.
        step_time: of the gait in closed form [s].
        cost: J of the gait in closed form [N^2 m s].
        reports: one for each engine.
    """

    robot: str
    step_time: float
    cost: float
    reports: tuple[EngineReport, ...]

    @property
    def walked(self) -> bool:
        """Did the robot fall in none of them?"""
        return all(report.outcome == COMPLETED for report in self.reports)

    @property
    def step_time_difference(self) -> float:
        """Step time of the first engine relative to that of the last, minus one [-]."""
        return self.reports[0].step_time / self.reports[-1].step_time - 1.0

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)

    def __str__(self) -> str:
        known = {"step_time": self.step_time, "cost": self.cost}
        lines = [f"{self.robot:32}" + "".join(f"{report.engine:>12}" for report in self.reports) + f"{'gait':>12}"]
        for key, label, form, unit in _ROWS:
            cells = [f"{unit * getattr(report, key):{form}}" for report in self.reports]
            cells.append(f"{known[key]:{form}}" if key in known else "")
            lines.append((f"{label:32}" + "".join(f"{cell:>12}" for cell in cells)).rstrip())
        lines += [
            f"{report.engine}: FELL after {counted(report.steps, 'step')} ({report.outcome})"
            for report in self.reports
            if report.outcome != COMPLETED
        ]
        return "\n".join(lines)


def cross_check(
    biped: FrontalBiped,
    gait: AnyGait,
    *,
    engines: tuple[str, ...] = ("mujoco", "ours"),
    on_step: Callable[[str, int], None] | None = None,
    **options: Any,
) -> tuple[CrossCheck, Mapping[str, Trajectory]]:
    """Walk a gait under the same walker in each engine.

    Args:
        biped: the robot.
        gait: the gait.
        engines: in this order.
        on_step: called with the engine and the number of completed steps.
        options: of `walk`: steps, period, disturbances and so on, the same for each engine.

    Returns:
        The reports, and the runs they are of, by engine.

    Raises:
        MissingExtraError: MuJoCo is not installed.
    """
    runs = {}
    for engine in engines:
        told = None if on_step is None else (lambda done, engine=engine: on_step(engine, done))
        runs[engine] = walk(biped, gait, engine=engine, on_step=told, **options)
    reports = tuple(engine_report(biped, gait, engine, run) for engine, run in runs.items())
    steps = steps_in_turn(gait)
    time, cost = np.mean([(step.orbit.step_duration, step.orbit.cost) for step in steps], axis=0)
    return CrossCheck(biped.name, float(time), float(cost), reports), runs


def engine_report(biped: FrontalBiped, gait: AnyGait, engine: str, run: Trajectory) -> EngineReport:
    """What a run under a walker measures."""
    measured = run.settings.get("measured", {})

    def of(name: str, which: str) -> float:
        return float(measured[name][which]) if name in measured else float("nan")

    durations = np.diff(run.event_t[run.events("IMPACT")])
    speeds = speed_errors(biped, gait, run)
    some = len(speeds) > 0
    return EngineReport(
        engine=engine,
        outcome=run.outcome,
        steps=run.steps_completed,
        step_time=float(durations.mean()) if len(durations) else float("nan"),
        step_time_spread=float(durations.std()) if len(durations) else float("nan"),
        speed_error=float(speeds.mean()) if some else float("nan"),
        largest_speed_error=float(np.abs(speeds).max()) if some else float("nan"),
        output_error=float(np.abs(run.output_error).max()),
        foot_slip=of("slip", "largest"),
        foot_rotation=of("rotation", "largest"),
        double_support=of("double_support", "mean"),
        work=of("work", "mean"),
        cost=of("effort", "mean") * float(np.mean([1.0 / step.step_width for step in steps_in_turn(gait)])),
        torque=float(np.max(np.abs(run.u) / biped.max_torque)),
        unsolved=int(run.settings.get("controller", {}).get("unsolved", 0)),
    )
