"""Everything the closed form says about a gait, with the residuals it rests on."""

from dataclasses import asdict, dataclass
from typing import Any

from frontal_biped.analysis.in_space import SpaceAnalysis, analyse_in_space
from frontal_biped.exceptions import ReversalError
from frontal_biped.gait.check import ConstraintReport, check_constraints
from frontal_biped.gait.gait import Gait, converged_nodes, quadrature_error
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics, step_orbit
from frontal_biped.zero_dynamics.reversal.bracket import ReversalAnalysis, analyse_reversal
from frontal_biped.zero_dynamics.reversal.certificate import ReversalCertificate, certify_reversal
from frontal_biped.zero_dynamics.reversal.problem import ReversalProblem

RESIDUAL_BOUND = 1e-9
"""Largest residual of a certified gait: invariance, energy balance, stored orbit, reversal point."""

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
    certificate: ReversalCertificate | None
    in_space: SpaceAnalysis | None

    @property
    def certified(self) -> bool:
        """Periodic, stable, hybrid invariant, reversing where planned, and within every constraint."""
        return not self.objections

    @property
    def objections(self) -> tuple[str, ...]:
        """What stands against the certificate, one line each."""
        found = [
            f"residual {name} is {value:.3g}, above {RESIDUAL_BOUND:g}"
            for name, value in self.residuals.items()
            if not value <= RESIDUAL_BOUND
        ]
        if not 0.0 < self.multiplier < 1.0:
            found.append(f"the multiplier {self.multiplier:.4g} is not in (0, 1): the gait is not stable")
        if not self.in_domain:
            found.append("the fixed point is outside the domain of the Poincare map")
        if not self.reversal.is_reversal:
            found.append("no reversal point was found in the bracket (HIP1, HIP2)")
        elif not abs(self.reversal.beta - self.reversal.planned) <= RESIDUAL_BOUND:
            found.append(
                f"the reversal point {self.reversal.beta:.9g} rad is not the planned {self.reversal.planned:.9g} rad"
            )
        for check in self.constraints.violated:
            found.append(f"{check.code} {check.name} = {check.value:.6g} {check.unit}, bound {check.bound:.6g}")
        return tuple(found)

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        table = asdict(self)
        table["reversal"]["is_reversal"] = self.reversal.is_reversal
        table["constraints"] = self.constraints.as_dict()
        table["certificate"] = None if self.certificate is None else self.certificate.as_dict()
        del table["in_space"]
        if self.in_space is not None:
            table["in_space"] = self.in_space.as_dict()
        return {"certified": self.certified, "objections": list(self.objections), **table}

    def __str__(self) -> str:
        r = self.reversal
        rows = [
            ("certificate", "yes" if self.certified else "NO: " + "; ".join(self.objections)),
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
            ("existence", f"Z changes sign between {r.sign_change[0]:.6f} and {r.sign_change[1]:.6f} rad"),
            ("HIP1, HIP2", f"zeta {r.zeta_residual:.1e} (relative), ddbeta {r.acceleration:.4f} rad/s^2"),
            *(self.certificate.rows() if self.certificate is not None else ()),
            ("quadrature", f"{self.nodes} nodes a phase, measured error {self.quadrature_error:.1e}"),
            ("  error by nodes", ", ".join(f"{size}: {error:.1e}" for size, error in self.convergence.items())),
            (
                "largest residual",
                f"{max(self.residuals.values()):.1e} ({max(self.residuals, key=lambda k: self.residuals[k])})",
            ),
        ]
        blocks = ["\n".join(f"{name:26} {value}" for name, value in rows), str(self.constraints)]
        if self.in_space is not None:
            blocks.append(str(self.in_space))
        return "\n\n".join(blocks)


def analyze(
    biped: FrontalBiped,
    gait: Gait,
    specification: GaitSpecification | None = None,
    *,
    certify: bool = True,
    in_space: bool = True,
) -> GaitAnalysis:
    """Analyse a gait in closed form.

    Args:
        biped: the robot.
        gait: the gait.
        specification: bounds to check against; default: those the gait was designed for.
        certify: count the reversal points as well? It takes a few seconds.
        in_space: say what it means for the whole robot as well? It reads the meshes of the feet.

    Returns:
        Orbit, reversal, residuals and constraints.

    Raises:
        ReversalError: the reversal cannot be bracketed.
    """
    spec = specification or gait.specification
    nodes = converged_nodes(biped, gait.rising, gait.falling, gait.step_width)
    step = step_orbit(biped, gait.rising, gait.falling, gait.step_width, nodes)
    hzd = HybridZeroDynamics(biped, step)
    problem = ReversalProblem.of_phases(biped, gait.rising, gait.falling, gait.step_width, nodes)
    try:
        certificate = certify_reversal(problem) if certify else None
    except ReversalError:
        certificate = None
    return GaitAnalysis(
        robot=biped.name,
        nodes=nodes,
        quadrature_error=quadrature_error(biped, gait.rising, gait.falling, gait.step_width, nodes),
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
        reversal=analyse_reversal(biped, gait.rising, gait.falling, gait.step_width, nodes),
        residuals=gait.residuals(biped, step),
        constraints=check_constraints(biped, spec, gait.rising, gait.falling, step),
        certificate=certificate,
        in_space=analyse_in_space(biped, gait, spec, step) if in_space else None,
    )
