"""Settings of the walking controller."""

from dataclasses import dataclass

from frontal_biped.exceptions import SimulationError
from frontal_biped.gait.planned_step import PlannedStep
from frontal_biped.gait.specification import GaitSpecification

OUTPUTS = ("linearising", "clf")
SOLVERS = ("exact", "compiled", "proxqp")


@dataclass(frozen=True)
class ControllerSettings:
    """Settings of the controller.

    Attributes:
        frequency: natural frequency of the output error dynamics [rad/s].
        damping: damping ratio of the output error dynamics [-].
        friction: coefficient of friction of the cone [-].
        min_normal_force: smallest normal force, as a fraction of the weight [-].
        max_torque: torque limits, chain order [N m]; None: the robot's.
        joint_rate: rate at which a joint may approach the limits of its range and speed [1/s]; None: no such limits.
        accuracy: absolute tolerance of ProxQP.
        max_iterations: of ProxQP's outer loop.
        outputs: how the outputs are driven to zero: "linearising", to linear error dynamics, or "clf", by a control
            Lyapunov function (see `lyapunov`).
        epsilon: time scale of the control Lyapunov function [s].
        relaxation_price: price rho of its relaxation [-].
        solver: of the quadratic program: "exact", in closed form and in the residuals of the targets (see
            `nearest_motion`), with ProxQP where that fails; "compiled", the same with the common ticks in one
            function that Numba compiles (see `few_rows`); or "proxqp", at every tick.

    Raises:
        SimulationError: unknown ``outputs`` or ``solver``.
    """

    frequency: float = 30.0
    damping: float = 1.0
    friction: float = GaitSpecification.friction
    min_normal_force: float = GaitSpecification.min_normal_force
    max_torque: tuple[float, float, float, float] | None = None
    joint_rate: float | None = None
    accuracy: float = 1e-9
    max_iterations: int = 80
    outputs: str = "linearising"
    epsilon: float = 0.003
    relaxation_price: float = 1e3
    solver: str = "exact"

    def __post_init__(self) -> None:
        if self.outputs not in OUTPUTS:
            raise SimulationError(f"no controller {self.outputs!r}; known: {', '.join(OUTPUTS)}")
        if self.solver not in SOLVERS:
            raise SimulationError(f"no solver {self.solver!r}; known: {', '.join(SOLVERS)}")

    @classmethod
    def for_gait(cls, gait: PlannedStep) -> "ControllerSettings":
        """Defaults, with the friction, normal force and torque limits that the gait was designed for."""
        asked = gait.specification
        return cls(friction=asked.friction, min_normal_force=asked.min_normal_force, max_torque=asked.max_torque)


def sampled_frequency(period: float) -> float:
    """Natural frequency of the error dynamics for torques held for a period [rad/s]: a tenth of the rate, at most 100.

    Held torques leave an error at every impact, when the old stance ankle's torque acts on a light swing foot; it must
    be gone within the phase. On the feet of G1 and iCub 30 rad/s are too slow for that.
    """
    return min(100.0, 0.1 / period)
