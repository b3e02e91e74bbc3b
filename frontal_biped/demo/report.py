"""What the demonstration found, as numbers, text and JSON."""

from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from frontal_biped.analysis.closed_form import GaitAnalysis
from frontal_biped.analysis.robustness import RobustnessCard
from frontal_biped.analysis.sensitivity import SensitivityExperiment, SpeedErrorOutcome
from frontal_biped.design.optimise import DesignResult
from frontal_biped.files.provenance import software_versions

if TYPE_CHECKING:
    from frontal_biped.analysis.statements import Statement  # needs the extra `proof`


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
        statements: on the gait, measured and proved; () where it was not asked.
        seconds: wall time by stage [s]; what ran in another process meanwhile is in the last one.
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
    statements: "tuple[Statement, ...]" = ()

    @property
    def success(self) -> bool:
        """Certified, contradicted by no proof, and both runs walked every step."""
        contradicted = any(statement.contradicted for statement in self.statements)
        return self.analysis.certified and not contradicted and self.sampled.steps_completed == self.steps

    @property
    def statements_in_brief(self) -> "tuple[Statement, ...]":
        """Of C01 to C09 only what is open."""
        if not self.statements:
            return ()
        from frontal_biped.analysis.statements import in_brief

        return in_brief(self.statements)

    def figures(self) -> list[tuple[str, str, str]]:
        """(name, value, unit) of the key numbers."""
        a = self.analysis
        relative = abs(self.multiplier_simulated / a.multiplier - 1.0)
        return [
            ("Certificate", a.certificate_text, ""),
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
            "statements": [statement.as_dict() for statement in self.statements],
            "seconds": self.seconds,
        }

    def __str__(self) -> str:
        rows = [f"{name:52} {value} {unit}".rstrip() for name, value, unit in self.figures()]
        notes = [f"sensitivity: {outcome}" for outcome in self.speed_errors]
        for gait, card in self.robustness.items():
            notes += [f"{gait} gait, {name.strip()}: {text}" for name, text in card.rows()]
        if self.statements:
            verdicts = Counter(statement.proved.value for statement in self.statements)
            told = ", ".join(f"{count} {verdict}" for verdict, count in verdicts.items())
            notes.append(f"statements on the gait in ball arithmetic: {told}; see gait.proof.json")
        total = sum(self.seconds.values())
        return "\n".join(
            [*rows, *notes, f"written to {self.folder} in {total:.1f} s; open {self.folder / 'report.html'}"]
        )
