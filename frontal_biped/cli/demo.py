"""The demonstration: from a URDF to a certified gait that walks in the browser, in one folder."""

import shutil
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from frontal_biped.analysis import GaitAnalysis, analyze
from frontal_biped.control import ControllerSettings
from frontal_biped.design import DesignResult, default_specification, design_gait, load_specification
from frontal_biped.exceptions import DesignFailedError
from frontal_biped.files import require_folder, write_json
from frontal_biped.gait import Gait, save_gait
from frontal_biped.library import worker_processes
from frontal_biped.model import FrontalBiped
from frontal_biped.provenance import software_versions
from frontal_biped.robustness import RobustnessCard, robustness_card
from frontal_biped.sensitivity import SensitivityExperiment, reversal_sensitivity
from frontal_biped.simulation import Trajectory, save_trajectory
from frontal_biped.walking import SpeedErrorOutcome, simulate, simulated_multiplier, speed_error_outcome

STEPS = 20
PAGE_STEPS = 6  # animated in the report; enough for both feet three times
CONTROL_PERIOD = 1e-3  # [s]
COMPARED_PERIODS = (4e-3, 2e-3, 1e-3)  # [s], for the order of the sampling error
COMPARED_STEPS = 1
SPEED_ERRORS = (+0.001, -0.001)
REVERSAL_ERRORS = (-1e-3, -1e-5, 1e-5, 1e-3)  # [rad]
SHOWN_STABILISERS = ("adaptive", "ankle")
SHOWN_PUSHES: tuple[tuple[str, float], ...] = ()  # `analyze --robustness` finds the largest; it takes minutes
SPEED_ERROR_STEPS = 4  # the decay by the multiplier shows after a few

Say = Callable[[str], None]


@dataclass(frozen=True)
class SampledRun:
    """Tracking under a zero-order hold.

    Attributes:
        period: [s].
        steps_completed: [-].
        worst_output_error: largest |q_b - h_d| [rad].
    """

    period: float
    steps_completed: int
    worst_output_error: float


@dataclass(frozen=True)
class DemoReport:
    """What the demonstration found.

    Attributes:
        folder: where everything was written.
        analysis: of the gait.
        design: how it was found.
        steps: walked in either run.
        continuous_state_error: worst difference of a post-impact state from the periodic orbit (rad, rad/s).
        continuous_output_error: largest |q_b - h_d|, continuous control [rad].
        sampled: the run at the default period.
        compared: shorter runs at several periods.
        sampling_order: slope of log error over log period [-].
        multiplier_simulated: slope of the return map of the full model [-].
        speed_errors: what errors in the post-impact speed do.
        sensitivity: loss of invariance over the error of the reversal.
        robustness: of the gait, and of the one the specification `robust` gives.
        seconds: wall time by stage [s].
    """

    folder: Path
    analysis: GaitAnalysis
    design: DesignResult
    steps: int
    continuous_state_error: float
    continuous_output_error: float
    sampled: SampledRun
    compared: tuple[SampledRun, ...]
    sampling_order: float
    multiplier_simulated: float
    speed_errors: tuple[SpeedErrorOutcome, ...]
    sensitivity: SensitivityExperiment
    robustness: dict[str, RobustnessCard]
    seconds: dict[str, float]

    @property
    def success(self) -> bool:
        """Certified, and both runs walked every step."""
        return self.analysis.certified and self.sampled.steps_completed == self.steps

    def figures(self) -> list[tuple[str, str, str]]:
        """(name, value, unit) of the key numbers."""
        a = self.analysis
        relative = abs(self.multiplier_simulated / a.multiplier - 1.0)
        return [
            ("Certificate", "yes" if a.certified else "NO: " + "; ".join(a.objections), ""),
            ("Cost J", f"{a.cost:.3f}", "N² m s"),
            ("Step duration", f"{a.step_duration:.4f}", "s"),
            ("Post-impact speed dβ", f"{a.speed_after_impact:.5f}", "rad/s"),
            ("Fixed point ζ_f*", f"{a.fixed_point:.3f}", "kg² m⁴/s²"),
            ("Multiplier, closed form", f"{a.multiplier:.6f}", ""),
            ("Multiplier, full model", f"{self.multiplier_simulated:.6f}", ""),
            ("Relative difference of the two", f"{relative:.0e}", ""),
            ("Reversal β_r-", f"{a.reversal.beta:.6f}", "rad"),
            ("Largest invariance residual", f"{max(a.residuals.values()):.1e}", ""),
            (
                f"Post-impact state error, {self.steps} steps, continuous",
                f"{self.continuous_state_error:.1e}",
                "rad, rad/s",
            ),
            (f"Output error, {self.steps} steps, continuous", f"{self.continuous_output_error:.1e}", "rad"),
            (
                f"Output error, {self.sampled.steps_completed} steps, {1e3 * self.sampled.period:g} ms hold",
                f"{self.sampled.worst_output_error:.1e}",
                "rad",
            ),
            ("Order of the sampling error", f"{self.sampling_order:.2f}", ""),
        ]

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "robot": self.analysis.robot,
            "success": self.success,
            "versions": software_versions(),
            "analysis": self.analysis.as_dict(),
            "design": {
                "message": self.design.message,
                "iterations": self.design.iterations,
                "evaluations": self.design.evaluations,
                "seconds": self.design.seconds,
            },
            "simulation": {
                "steps": self.steps,
                "continuous_post_impact_state_error": self.continuous_state_error,
                "continuous_output_error": self.continuous_output_error,
                "sampled": asdict(self.sampled),
                "sampling_periods": [asdict(run) for run in self.compared],
                "sampling_order": self.sampling_order,
                "multiplier": self.multiplier_simulated,
            },
            "speed_errors": [asdict(outcome) for outcome in self.speed_errors],
            "sensitivity": self.sensitivity.as_dict(),
            "robustness": {name: card.as_dict() for name, card in self.robustness.items()},
            "seconds": self.seconds,
        }

    def __str__(self) -> str:
        rows = [f"{name:52} {value} {unit}".rstrip() for name, value, unit in self.figures()]
        notes = [f"sensitivity: {outcome}" for outcome in self.speed_errors]
        for gait, card in self.robustness.items():
            notes += [f"{gait} gait, {name.strip()}: {text}" for name, text in card.rows()]
        total = sum(self.seconds.values())
        return "\n".join(
            [*rows, *notes, f"written to {self.folder} in {total:.1f} s; open {self.folder / 'report.html'}"]
        )


def make_demo(biped: FrontalBiped, folder: Path, on_progress: Say | None = None) -> DemoReport:
    """Design, certify, simulate, draw, and write one folder.

    Everything is made in a temporary folder first; the demonstration's files move to ``folder`` only when all of
    them exist.

    Args:
        biped: the robot.
        folder: to write ``gait.json``, ``run.npz``, ``report.json``, ``report.html`` and ``figures/`` to.
        on_progress: called with what is being done.

    Returns:
        The report.

    Raises:
        DesignFailedError: no gait was found.
        MissingExtraError: matplotlib is not installed.
        OSError: the folder cannot be written.
    """
    require_folder(folder)
    say = on_progress or (lambda _: None)
    seconds: dict[str, float] = {}
    with tempfile.TemporaryDirectory(prefix="frontal-biped-") as scratch:
        made = Path(scratch) / "demo"  # with the usual permissions; those of the scratch folder are private
        made.mkdir()
        report, run, gait, figures = _compute(biped, folder, made / "figures", say, seconds)
        say("drawing the page")
        began = time.perf_counter()
        save_gait(gait, made / "gait.json")
        save_trajectory(run, made / "run.npz")
        _draw(biped, run, report, figures, made)
        seconds["page"] = time.perf_counter() - began
        write_json(made / "report.json", report.as_dict())
        shutil.copytree(made, folder, dirs_exist_ok=True)
    return report


def _compute(
    biped: FrontalBiped, folder: Path, figures: Path, say: Say, seconds: dict[str, float]
) -> tuple[DemoReport, Trajectory, Gait, list[Path]]:
    from frontal_biped.visualisation import write_figures

    def timed(stage: str) -> "_Stage":
        say(stage)
        return _Stage(stage, seconds)

    with timed("design"):
        design = design_gait(
            biped,
            default_specification(biped),
            on_progress=lambda i, cost, _: say(f"designing, iteration {i}, J = {cost:.2f} N^2 m s"),
        )
    if design.gait is None:
        raise DesignFailedError(f"{biped.name}: {design.message}")
    gait = design.gait
    # errors take longer than all the rest: other processes see to them
    with worker_processes(2) as executor:
        errors_taken = executor.submit(_take_errors, biped, gait)
        card = executor.submit(robustness_card, biped, gait, stabilisers=SHOWN_STABILISERS, instants=())
        robust_card = executor.submit(_robust_card, biped)
        with timed("analysis"):
            analysis = analyze(biped, gait)
        with timed("continuous walk"):
            run = simulate(
                biped, gait, steps=STEPS, on_step=lambda n: say(f"walking, continuous control, step {n}/{STEPS}")
            )
        with timed("sampled walk"):
            sampled = _sampled(biped, gait, CONTROL_PERIOD, STEPS)
            gains = ControllerSettings.for_gait(gait)  # the same for every period
            compared = tuple(_sampled(biped, gait, period, COMPARED_STEPS, gains) for period in COMPARED_PERIODS)
        with timed("multiplier"):
            multiplier = simulated_multiplier(biped, gait)
        with timed("figures"):
            paths = write_figures(figures, biped, gait, run)
        with timed("robustness"):
            outcomes, sensitivity = errors_taken.result()
            cards = {"this": card.result()}
            if (of_robust := robust_card.result()) is not None:
                cards["robust"] = of_robust
    periods = np.log([run.period for run in compared])
    errors = np.log([run.worst_output_error for run in compared])
    states = run.post_impact_states()
    report = DemoReport(
        folder=folder,
        analysis=analysis,
        design=design,
        steps=STEPS,
        continuous_state_error=float(np.max(np.abs(states - states[0]))),
        continuous_output_error=float(np.max(np.abs(run.output_error))),
        sampled=sampled,
        compared=compared,
        sampling_order=float(np.polyfit(periods, errors, 1)[0]),
        multiplier_simulated=multiplier,
        speed_errors=outcomes,
        sensitivity=sensitivity,
        robustness=cards,
        seconds=seconds,
    )
    return report, run, gait, paths


def _take_errors(biped: FrontalBiped, gait: Gait) -> tuple[tuple[SpeedErrorOutcome, ...], SensitivityExperiment]:
    """What errors of speed and of the reversal do to the gait."""
    outcomes = tuple(speed_error_outcome(biped, gait, error, steps=SPEED_ERROR_STEPS) for error in SPEED_ERRORS)
    return outcomes, reversal_sensitivity(biped, gait, shifts=REVERSAL_ERRORS)


def _robust_card(biped: FrontalBiped) -> RobustnessCard | None:
    """What the gait of the specification `robust` can take; None where the robot has none."""
    robust = design_gait(biped, load_specification("robust")).gait
    if robust is None:
        return None
    return robustness_card(biped, robust, stabilisers=SHOWN_STABILISERS[-1:], instants=SHOWN_PUSHES)


def _sampled(
    biped: FrontalBiped, gait: Gait, period: float, steps: int, settings: ControllerSettings | None = None
) -> SampledRun:
    run = simulate(biped, gait, steps=steps, period=period, controller_settings=settings)
    return SampledRun(period, run.steps_completed, float(np.max(np.abs(run.output_error))))


def _draw(biped: FrontalBiped, run: Trajectory, report: DemoReport, paths: list[Path], folder: Path) -> None:
    from frontal_biped.visualisation import report_page
    from frontal_biped.visualisation.figures import write_figure
    from frontal_biped.visualisation.robustness_figures import ROBUSTNESS_FIGURES, return_map, sensitivity

    paths = paths + write_figure(folder / "figures", "sensitivity", sensitivity(report.sensitivity.runs))
    card = list(report.robustness.values())[-1]
    paths += write_figure(folder / "figures", "return_map", return_map(card))
    drawn = [
        (ROBUSTNESS_FIGURES.get(path.stem, path.stem), path.read_text(encoding="utf-8"))
        for path in paths
        if path.suffix == ".svg"
    ]
    page = report_page(
        biped,
        run.first_steps(PAGE_STEPS),
        drawn,
        title=f"{biped.name}: a certified frontal gait",
        numbers=report.figures(),
        constraints=[
            (c.code, c.name, f"{c.value:.5g}", f"{c.bound:.4g}", f"{c.margin:.3g}", c.unit)
            for c in report.analysis.constraints.checks
        ],
        robustness=[
            (f"{name} gait", [(row, text) for row, text in card.rows()]) for name, card in report.robustness.items()
        ],
        notes=[
            "Sensitivity, with the paper's fixed transition at the planned reversal:",
            *(str(outcome) for outcome in report.speed_errors),
        ],
    )
    (folder / "report.html").write_text(page, encoding="utf-8")


class _Stage:
    """Wall time of a stage."""

    def __init__(self, name: str, seconds: dict[str, float]) -> None:
        self.name, self.seconds = name, seconds

    def __enter__(self) -> None:
        self.began = time.perf_counter()

    def __exit__(self, *_: object) -> None:
        self.seconds[self.name] = time.perf_counter() - self.began
