"""What a simulation is told: the controller it asks, and how it runs."""

from dataclasses import dataclass, field
from typing import Protocol

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import SimulationError
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.hybrid_system import FLAT_LANDING
from frontal_biped.virtual_constraints.phase import StepPhase


class Command(Protocol):
    """What the simulator reads of a command."""

    @property
    def u(self) -> FloatArray:
        """(4,) torques [N m]."""

    @property
    def y(self) -> FloatArray:
        """(3,) output error q_b - h_d(beta) [rad]."""

    @property
    def p_fri_target(self) -> float:
        """Wanted FRI [m]."""


class Controller(Protocol):
    """Anything that turns phase and state into a command."""

    def begin(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> None:
        """A phase begins at q (4,) [rad], dq (4,) [rad/s]: after an impact or at a reversal."""

    def command(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> Command:
        """Command at q (4,) [rad], dq (4,) [rad/s]."""


@dataclass(frozen=True)
class SimulationSettings:
    """Settings of the simulator.

    Attributes:
        steps: impacts after which to stop.
        period: control period [s]; None: continuous control.
        rtol: relative tolerance of the integrator (continuous control).
        atol: absolute tolerance of the integrator (continuous control).
        record_rate: samples per second of the recording [1/s].
        disturbances: what the robot is up against; they need a period.
        flat_landing: rotation of the swing foot up to which it settles flat at impact [rad]; steeper is a stumble.

    Raises:
        SimulationError: disturbances under continuous control.
    """

    steps: int = 20
    period: float | None = None
    rtol: float = 1e-9
    atol: float = 1e-11
    record_rate: float = 250.0
    disturbances: Disturbances = field(default_factory=Disturbances)
    flat_landing: float = FLAT_LANDING

    def __post_init__(self) -> None:
        if self.disturbances.any and self.period is None:
            raise SimulationError("disturbances act on sampled control; give a control period")
