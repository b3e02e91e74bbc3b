"""The demonstration: from a URDF to a certified gait that walks in the browser, in one folder."""

import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from frontal_biped.analysis.closed_form import analyze
from frontal_biped.analysis.robustness import RobustnessCard, robustness_card
from frontal_biped.analysis.sensitivity import (
    SensitivityExperiment,
    SpeedErrorOutcome,
    reversal_sensitivity,
    simulated_multiplier,
    speed_error_outcome,
)
from frontal_biped.control.settings import ControllerSettings
from frontal_biped.demo.report import DemoReport, SampledRun
from frontal_biped.design.optimise import optimise_gait
from frontal_biped.exceptions import DesignFailedError
from frontal_biped.figures.style import require_matplotlib
from frontal_biped.files.atomic import require_folder, write_json
from frontal_biped.gait.file import save_gait
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.shipped import load_specification
from frontal_biped.gait.specification import default_specification
from frontal_biped.library.executors import worker_processes
from frontal_biped.library.shared_work import SharedWork
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.trajectory import Trajectory, save_trajectory
from frontal_biped.simulation.walking import simulate

STEPS = 20
CONTROL_PERIOD = 1e-3  # [s]
COMPARED_PERIODS = (4e-3, 2e-3, 1e-3)  # [s], for the order of the sampling error
COMPARED_STEPS = 1
SPEED_ERRORS = (+0.001, -0.001)
REVERSAL_ERRORS = (-1e-3, -1e-5, 1e-5, 1e-4)  # [rad]; 1e-3 late costs 1.7 rad, and seconds, with fixed transitions
SHOWN_STABILISERS = ("adaptive", "ankle")
SHOWN_PUSHES: tuple[tuple[str, float], ...] = (("at the reversal", 1.0),)  # `analyze --robustness` has four
MAP_SAMPLES = 7
DRAWN_MAP_SAMPLES = 25  # of the map in the figure: its corners are seen
PUSH_RESOLUTION = 8.0  # [N s]
CONTINUOUS = SimulationSettings(rtol=1e-8, atol=1e-10)  # 20 steps repeat to some 1e-10, far inside 1e-7
PARTS = 7  # that another process may do
SPEED_ERROR_STEPS = 3  # the decay by the multiplier shows after a few

Say = Callable[[str], None]


def make_demo(biped: FrontalBiped, folder: Path, on_progress: Say | None = None, *, prove: bool = False) -> DemoReport:
    """Design, certify, simulate, draw, and write one folder.

    Everything is made in a temporary folder first; the demonstration's files move to ``folder`` only when all of
    them exist.

    Args:
        biped: the robot.
        folder: to write ``gait.json``, ``run.npz``, ``report.json``, ``report.html`` and ``figures/`` to.
        on_progress: called with what is being done.
        prove: prove the gait in ball arithmetic as well, and write ``gait.proof.json``? It takes 40 s.

    Returns:
        The report.

    Raises:
        DesignFailedError: no gait was found.
        MissingExtraError: matplotlib is not installed; to prove, python-flint.
        OSError: the folder cannot be written.
    """
    require_folder(folder)
    require_matplotlib()
    say = on_progress or (lambda _: None)
    seconds: dict[str, float] = {}
    with tempfile.TemporaryDirectory(prefix="frontal-biped-") as scratch:
        made = Path(scratch) / "demo"  # with the usual permissions; those of the scratch folder are private
        made.mkdir()
        shown = _compute(biped, folder, made / "figures", say, seconds)
        if prove:
            shown = shown._replace(report=_proved(biped, shown.gait, shown.report, made, say, seconds))
        say("drawing the page")
        with _timed("page", seconds):
            save_gait(shown.gait, made / "gait.json")
            save_trajectory(shown.run, made / "run.npz")
            _draw(biped, shown, made)
        write_json(made / "report.json", shown.report.as_dict())
        shutil.copytree(made, folder, dirs_exist_ok=True)
    return shown.report


class _Shown(NamedTuple):
    """What is computed, and drawn of it.

    Attributes:
        report: the numbers.
        gait: the gait.
        run: its continuous walk.
        figures: files of figures.
        animation: page of the moving robot.
    """

    report: DemoReport
    gait: Gait
    run: Trajectory
    figures: list[Path]
    animation: str


def _compute(biped: FrontalBiped, folder: Path, figures: Path, say: Say, seconds: dict[str, float]) -> _Shown:
    from frontal_biped.demo.page import animated
    from frontal_biped.figures.write import write_figures

    def timed(stage: str) -> AbstractContextManager[None]:
        say(stage)
        return _timed(stage, seconds)

    # work goes to a process on every other processor; what none has begun when the rest is done is done here
    processes = min(max(1, len(os.sched_getaffinity(0)) - 1), PARTS)
    with worker_processes(processes, copies=True) as executor:
        work = SharedWork(executor, processes)
        robust_card = work.add(_robust_card, biped, figures, SHOWN_STABILISERS[-1:], SHOWN_PUSHES)
        with timed("design"):
            design = optimise_gait(
                biped,
                default_specification(biped),
                on_progress=lambda i, cost, _: say(f"designing, iteration {i}, J = {cost:.2f} N^2 m s"),
            )
        if design.gait is None:
            raise DesignFailedError(f"{biped.name}: {design.message}")
        gait = design.gait
        sampled = work.add(_sampled, biped, gait, CONTROL_PERIOD, STEPS)
        card = work.add(_card, biped, gait, SHOWN_STABILISERS)
        sensitivity = work.add(_lose_invariance, biped, figures, gait, REVERSAL_ERRORS)
        compared = work.add(_compare_periods, biped, gait)
        outcomes = work.add(_take_speed_errors, biped, gait)
        with timed("analysis"):
            analysis = analyze(biped, gait)
        with timed("continuous walk"):
            run = simulate(
                biped,
                gait,
                steps=STEPS,
                period=None,
                simulation_settings=CONTINUOUS,
                on_step=lambda n: say(f"walking, continuous control, step {n}/{STEPS}"),
            )
        animation = work.add(animated, biped, run)
        with timed("multiplier"):
            multiplier = simulated_multiplier(biped, gait)
        with timed("figures"):
            paths = write_figures(figures, biped, gait, run)
        with timed("sampled walk, errors and robustness"):
            work.do_the_rest()
            cards = {"this": card.result()}
            if (of_robust := robust_card.result()) is not None:
                cards["robust"] = of_robust
            else:
                _draw_map(figures, cards["this"], "this")
    periods = np.log([run.period for run in compared.result()])
    errors = np.log([run.worst_output_error for run in compared.result()])
    states = run.post_impact_states()
    report = DemoReport(
        folder=folder,
        analysis=analysis,
        design=design,
        steps=STEPS,
        continuous_state_error=float(np.max(np.abs(states - states[0]))),
        continuous_output_error=float(np.max(np.abs(run.output_error))),
        sampled=sampled.result(),
        compared=compared.result(),
        sampling_order=float(np.polyfit(periods, errors, 1)[0]),
        multiplier_simulated=multiplier,
        speed_errors=outcomes.result(),
        sensitivity=sensitivity.result(),
        robustness=cards,
        seconds=seconds,
    )
    drawn = [*paths, figures / "sensitivity.svg", figures / "return_map.svg"]
    return _Shown(report, gait, run, drawn, animation.result())


def _proved(
    biped: FrontalBiped, gait: Gait, report: DemoReport, folder: Path, say: Say, seconds: dict[str, float]
) -> DemoReport:
    from frontal_biped.analysis.proof import prove
    from frontal_biped.analysis.statements import statements

    say("proving it in ball arithmetic")
    with _timed("proof", seconds):
        certificate = prove(biped, gait)
        certificate.save(folder / "gait.proof.json")
    return replace(report, statements=statements(report.analysis, certificate.proof))


def _take_speed_errors(biped: FrontalBiped, gait: Gait) -> tuple[SpeedErrorOutcome, ...]:
    """What errors of speed do to the gait with the paper's transitions."""
    return tuple(speed_error_outcome(biped, gait, error, steps=SPEED_ERROR_STEPS) for error in SPEED_ERRORS)


def _lose_invariance(
    biped: FrontalBiped, figures: Path, gait: Gait, shifts: tuple[float, ...]
) -> SensitivityExperiment:
    """What errors of the reversal do to the gait, with its figure."""
    from frontal_biped.figures.robustness import sensitivity
    from frontal_biped.figures.write import write_figure

    experiment = reversal_sensitivity(biped, gait, shifts=shifts)
    write_figure(figures, "sensitivity", sensitivity(experiment.runs))
    return experiment


def _compare_periods(biped: FrontalBiped, gait: Gait) -> tuple[SampledRun, ...]:
    """Short walks at several control periods, with the same gains."""
    gains = ControllerSettings.for_gait(gait)
    return tuple(_sampled(biped, gait, period, COMPARED_STEPS, gains) for period in COMPARED_PERIODS)


def _card(biped: FrontalBiped, gait: Gait, stabilisers: tuple[str, ...]) -> RobustnessCard:
    """What the gait can take; pushes are left to `analyze --robustness`."""
    return robustness_card(biped, gait, stabilisers=stabilisers, instants=(), samples=MAP_SAMPLES)


def _robust_card(
    biped: FrontalBiped, figures: Path, stabilisers: tuple[str, ...], pushes: tuple[tuple[str, float], ...]
) -> RobustnessCard | None:
    """What the gait of the specification `robust` can take, with its figure; None where the robot has none."""
    robust = optimise_gait(biped, load_specification("robust")).gait
    if robust is None:
        return None
    card = robustness_card(
        biped,
        robust,
        stabilisers=stabilisers,
        instants=pushes,
        push_resolution=PUSH_RESOLUTION,
        samples=DRAWN_MAP_SAMPLES,
    )
    _draw_map(figures, card, "robust")
    return card


def _draw_map(figures: Path, card: RobustnessCard, name: str) -> None:
    from frontal_biped.figures.robustness import return_map
    from frontal_biped.figures.write import write_figure

    write_figure(figures, "return_map", return_map(card, f"{name} gait"))


def _sampled(
    biped: FrontalBiped, gait: Gait, period: float, steps: int, settings: ControllerSettings | None = None
) -> SampledRun:
    run = simulate(biped, gait, steps=steps, period=period, stabiliser="adaptive", controller_settings=settings)
    return SampledRun(period, run.steps_completed, float(np.max(np.abs(run.output_error))))


def _draw(biped: FrontalBiped, shown: _Shown, folder: Path) -> None:
    from frontal_biped.demo.page import report_page
    from frontal_biped.figures.robustness import ROBUSTNESS_FIGURES

    report = shown.report
    drawn = [
        (ROBUSTNESS_FIGURES.get(path.stem, path.stem), path.read_text(encoding="utf-8"))
        for path in shown.figures
        if path.suffix == ".svg"
    ]
    page = report_page(
        biped,
        shown.run,
        drawn,
        title=f"{biped.name}: a {'certified ' if report.analysis.certified else ''}frontal gait",
        numbers=report.figures(),
        constraints=[
            (c.code, c.name, f"{c.value:.5g}", f"{c.bound:.4g}", f"{c.margin:.3g}", c.unit)
            for c in report.analysis.constraints.checks
        ],
        robustness=[
            (f"{name} gait", [(row, text) for row, text in card.rows()]) for name, card in report.robustness.items()
        ],
        statements=[statement.row for statement in report.statements_in_brief],
        notes=[
            "Sensitivity, with the paper's fixed transition at the planned reversal:",
            *(str(outcome) for outcome in report.speed_errors),
        ],
        animation=shown.animation,
    )
    (folder / "report.html").write_text(page, encoding="utf-8")


@contextmanager
def _timed(stage: str, seconds: dict[str, float]) -> Iterator[None]:
    """Wall time of a stage."""
    began = time.perf_counter()
    yield
    seconds[stage] = time.perf_counter() - began
