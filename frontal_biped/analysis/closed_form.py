"""Everything the closed form says about a gait, with the residuals it rests on."""

from dataclasses import asdict, dataclass
from typing import Any

from frontal_biped.analysis.in_space import SpaceAnalysis, analyse_in_space
from frontal_biped.analysis.motors import MotorDemand, motor_demand
from frontal_biped.exceptions import ReversalError
from frontal_biped.files.json_values import for_json
from frontal_biped.files.shown import html_table
from frontal_biped.gait.check import ConstraintReport
from frontal_biped.gait.gait import quadrature_error
from frontal_biped.gait.given import GaitLike, gait_of
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.gait.verdict import Objection, judge
from frontal_biped.model.catalogue import RobotLike, biped_of
from frontal_biped.numerics.verdict import Verdict, together
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics
from frontal_biped.zero_dynamics.reversal.certificate import ReversalCertificate, certify_reversal
from frontal_biped.zero_dynamics.reversal.planned import ReversalAnalysis
from frontal_biped.zero_dynamics.reversal.problem import ReversalProblem

COMPARED_NODES = (8, 16, 24, 32)
"""Quadrature nodes a phase whose error is shown beside the one that was used."""


@dataclass(frozen=True)
class GaitAnalysis:
    """Closed-form analysis of a gait.

    Attributes:
        robot: its name.
        nodes: quadrature nodes a phase.
        quadrature_error: measured by doubling them [-].
        convergence: the same error for fewer nodes and more, by number of nodes [-].
        delta_r: growth of sigma_a over the rising phase [-].
        delta_f: growth of sigma_a over the falling phase [-].
        delta_z: jump of sigma_a at impact [-].
        multiplier: delta_f^2 delta_r^2 delta_z^2 [-].
        barrier_r: energy the rising phase takes, (delta_FRI^a)^2 V_zr [kg^2 m^4/s^2].
        barrier_f: its counterpart of the falling phase, negative [kg^2 m^4/s^2].
        fixed_point: zeta_f* [kg^2 m^4/s^2].
        in_domain: is the fixed point in the domain of rho?
        speed_after_impact: dbeta_r+ [rad/s].
        step_duration: [s].
        cost: J [N^2 m s].
        reversal: where it reverses.
        residuals: of the gait, see `Gait.residuals`.
        constraints: C01..C09 on the dense grid.
        open_points: what keeps the gait from being certified, see `gait.verdict`.
        motors: what the gait needs of them.
        certificate: existence, number and uniqueness of the reversal point; None where no step exists, or not asked.
        in_space: what the gait means for the whole robot; None for a robot of four joints, or not asked.
    """

    robot: str
    nodes: int
    quadrature_error: float
    convergence: dict[int, float]
    delta_r: float
    delta_f: float
    delta_z: float
    multiplier: float
    barrier_r: float
    barrier_f: float
    fixed_point: float
    in_domain: bool
    speed_after_impact: float
    step_duration: float
    cost: float
    reversal: ReversalAnalysis
    residuals: dict[str, float]
    constraints: ConstraintReport
    open_points: tuple[Objection, ...]
    motors: MotorDemand
    certificate: ReversalCertificate | None
    in_space: SpaceAnalysis | None

    @property
    def verdict(self) -> Verdict:
        """On the gait: the one that `design` asked before it accepted the gait (`gait.verdict`)."""
        return together(point.verdict for point in self.open_points)

    @property
    def certified(self) -> bool:
        """Periodic, stable, hybrid invariant, reversing where planned, and within every constraint."""
        return self.verdict is Verdict.CERTIFIED

    @property
    def objections(self) -> tuple[str, ...]:
        """What stands against the certificate, one line each."""
        return tuple(point.reason for point in self.open_points)

    @property
    def certificate_text(self) -> str:
        """The verdict in one line: yes, NO or UNDECIDED, and why."""
        if self.certified:
            return "yes"
        return ("NO: " if self.verdict is Verdict.REFUTED else "UNDECIDED: ") + "; ".join(self.objections)

    @property
    def summary(self) -> str:
        """Three lines: what was reached, what is tightest, what it needs of the motors."""
        reached, *_ = self._head
        return "\n".join([_table([reached]), self.needs])

    @property
    def needs(self) -> str:
        """The last two of these lines."""
        _, *needs = self._head
        return _table(needs)

    @property
    def _head(self) -> list[tuple[str, str]]:
        holds = f"periodic, stable (multiplier {self.multiplier:.4f}), reverses where planned, keeps C01 to C09"
        return [
            ("certificate", f"yes: {holds}" if self.certified else self.certificate_text),
            ("tightest", self.constraints.tightest),
            ("motors", str(self.motors)),
        ]

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        table = asdict(self)
        table["reversal"] |= {"exists": self.reversal.exists, "is_reversal": self.reversal.is_reversal}
        table["constraints"] = self.constraints.as_dict()
        table["certificate"] = None if self.certificate is None else self.certificate.as_dict()
        del table["in_space"], table["open_points"]
        if self.in_space is not None:
            table["in_space"] = self.in_space.as_dict()
        head = {"certified": self.certified, "verdict": self.verdict, "objections": list(self.objections)}
        return dict(for_json(head | table))

    def __repr__(self) -> str:
        return f"GaitAnalysis of {self.robot!r}\n{self.summary}"

    def _repr_html_(self) -> str:
        tables = [html_table([*self._head, *self._rows]), self.constraints._repr_html_()]
        if self.in_space is not None:
            tables.append(html_table([("in space", str(self.in_space))]))
        return "\n".join(tables)

    def __str__(self) -> str:
        blocks = [self.summary, _table(self._rows), str(self.constraints)]
        if self.in_space is not None:
            blocks.append(str(self.in_space))
        return "\n\n".join(blocks)

    @property
    def _rows(self) -> list[tuple[str, str]]:
        r, (a, b) = self.reversal, self.reversal.sign_change
        return [
            ("J", f"{self.cost:.4f} N^2 m s"),
            ("step duration", f"{self.step_duration:.4f} s"),
            ("dbeta after impact", f"{self.speed_after_impact:.6f} rad/s"),
            ("zeta_f*", f"{self.fixed_point:.4f} kg^2 m^4/s^2"),
            ("delta_r, delta_f, delta_z", f"{self.delta_r:.6f}, {self.delta_f:.6f}, {self.delta_z:.6f}"),
            (
                "multiplier",
                f"{self.multiplier:.6f} (stable)" if 0.0 < self.multiplier < 1.0 else f"{self.multiplier:.6f}",
            ),
            ("reversal", f"{r.beta:.9f} rad, planned {r.planned:.9f}, in ]{r.bracket[0]:.4f}, {r.bracket[1]:.4f}["),
            ("existence", r.existence.value + (f", Z changes sign from {a:.9f} to {b:.9f} rad" if r.exists else "")),
            ("HIP1, HIP2", f"zeta {r.zeta_residual:.1e} (relative), ddbeta {r.acceleration:.4f} rad/s^2"),
            *(self.certificate.rows() if self.certificate is not None else ()),
            ("quadrature", f"{self.nodes} nodes a phase, measured error {self.quadrature_error:.1e}"),
            ("  error by nodes", ", ".join(f"{size}: {error:.1e}" for size, error in self.convergence.items())),
            (
                "largest residual",
                f"{max(self.residuals.values()):.1e} ({max(self.residuals, key=lambda k: self.residuals[k])})",
            ),
        ]


def _table(rows: list[tuple[str, str]]) -> str:
    return "\n".join(f"{name:26} {value}" for name, value in rows)


def analyze(
    biped: RobotLike,
    gait: GaitLike,
    specification: GaitSpecification | None = None,
    *,
    certify: bool = True,
    in_space: bool = True,
) -> GaitAnalysis:
    """Analyse a gait in closed form.

    Args:
        biped: the robot, in any of its views, or by name or path.
        gait: the gait, a design's result, or by name or path.
        specification: bounds to check against; default: those the gait was designed for.
        certify: count the reversal points as well? It takes a few seconds.
        in_space: say what it means for the whole robot as well? It reads the meshes of the feet.

    Returns:
        Orbit, reversal, residuals and constraints.

    Raises:
        RobotError: there is no such robot.
        GaitFileError: there is no such gait.
        DesignFailedError: the design found none.
    """
    biped, gait = biped_of(biped), gait_of(gait)
    spec = specification or gait.specification
    judged = judge(biped, gait, spec)
    nodes, step = judged.nodes, judged.step
    hzd = HybridZeroDynamics(biped, step)
    problem = ReversalProblem.of_phases(biped, gait.rising, gait.falling, gait.step_width, nodes)
    try:
        certificate = certify_reversal(problem, judged.reversal) if certify else None
    except ReversalError:
        certificate = None
    return GaitAnalysis(
        robot=biped.name,
        nodes=nodes,
        quadrature_error=judged.quadrature_error,
        convergence={
            size: quadrature_error(biped, gait.rising, gait.falling, gait.step_width, size) for size in COMPARED_NODES
        },
        delta_r=hzd.delta_r,
        delta_f=hzd.delta_f,
        delta_z=hzd.delta_z,
        multiplier=hzd.multiplier,
        barrier_r=hzd.barrier_r,
        barrier_f=hzd.barrier_f,
        fixed_point=hzd.fixed_point,
        in_domain=hzd.in_domain,
        speed_after_impact=hzd.speed_after_impact,
        step_duration=float(step.duration),
        cost=float(step.cost),
        reversal=judged.reversal,
        residuals=judged.residuals,
        constraints=judged.constraints,
        open_points=judged.objections,
        motors=motor_demand(biped, gait, step),
        certificate=certificate,
        in_space=analyse_in_space(biped, gait, spec, step) if in_space else None,
    )
