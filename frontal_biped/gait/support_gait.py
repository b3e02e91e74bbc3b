r"""Gaits with a finite double support: no impact, and a step that retraces itself.

The swing foot leaves the ground and comes back to it at rest: where the curve h(beta) of the virtual constraints begins
on the double-support family it has the family's slope. Nothing collides, so nothing is lost, and the step may be walked
backwards: **falling retraces rising**, the same curve h and the same FRI over beta from beta_r- back to beta_0. The
scalar dynamics on Z depends on beta and dbeta^2 alone, so the robot lands exactly as fast as it lifted off, wherever it
reversed: Z(beta_r-) = 0 holds for *every* reversal, and the slope of the return map of the single support is one.

The double support between two steps is its own mirror image: landing and lift-off are the same pose seen from either
foot. With the pressure point crossing as planned over beta its slope is all but one as well (`support_certificate`),
for the height of the centre of mass is the same on both sides of half-way. Such a gait would be neutral: an error of
speed stays. It is the choice of ddbeta in double support (`zero_dynamics.support_plan`) that makes the multiplier zero.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

from frontal_biped.exceptions import GaitFileError, SpecificationError
from frontal_biped.gait.gait import RobotReference
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.double_support import DoubleSupportFamily
from frontal_biped.virtual_constraints.phase import Phase, StepPhase
from frontal_biped.zero_dynamics.orbit import PhaseOrbit, phase_orbit
from frontal_biped.zero_dynamics.support_dynamics import SupportLimits
from frontal_biped.zero_dynamics.support_plan import HandOver, SingleSupportEnd

DOUBLE_SUPPORT = (0.1, 0.2)
"""Shortest and longest double support where the bounds do not say [s]."""


@dataclass(frozen=True)
class SupportSpecification:
    """What a gait with a finite double support must satisfy.

    Attributes:
        bounds: the bounds of single support, and of the duration of a step, double support included; what they ask of
            an impact has no meaning here. Where they do not say how long the double support lasts, it is
            `DOUBLE_SUPPORT`.
        pressure_margin: how deep inside what the bounds' FRI margin leaves of both feet the pressure point stays on the
            way from standing [m].

    Raises:
        SpecificationError: a value is out of range.
    """

    bounds: GaitSpecification = field(default_factory=GaitSpecification)
    pressure_margin: float = 0.006

    def __post_init__(self) -> None:
        if self.bounds.double_support is None:
            object.__setattr__(self, "bounds", replace(self.bounds, double_support=DOUBLE_SUPPORT))
        if not 0.0 <= self.pressure_margin < 0.1:
            raise SpecificationError(f"pressure_margin = {self.pressure_margin:g}: needs 0 <= m < 0.1; write 0.006")

    @property
    def double_support(self) -> tuple[float, float]:
        """Shortest and longest double support [s]."""
        return self.bounds.double_support or DOUBLE_SUPPORT


class SupportNumbers(NamedTuple):
    """Orbit of a gait, beside its speed.

    Attributes:
        step_duration: of a step, double support included [s].
        double_support: of that [s].
        cost: J of a step [N^2 m s].
    """

    step_duration: float
    double_support: float
    cost: float


@dataclass(frozen=True)
class SupportGait:
    """A gait without impacts: one curve, walked up and down, and a double support from foot to foot.

    A `PlannedStep` that a controller can track.

    Attributes:
        robot: whose it is.
        rising: virtual constraints from the lift-off to the reversal.
        width: distance between the ankles [m].
        speed: dbeta at lift-off, and the opposite at the landing [rad/s].
        setting_off: duration of the motion from rest half-way to the lift-off for which it was designed [s].
        asked: the bounds.
        numbers: of its orbit; None while it is being designed.
        provenance: versions and figures of the design.
    """

    robot: RobotReference
    rising: Phase
    width: float
    speed: float
    setting_off: float
    asked: SupportSpecification
    numbers: SupportNumbers | None = None
    provenance: Mapping[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        numbers = self.numbers
        orbit = (
            ""
            if numbers is None
            else f", steps of {numbers.step_duration:.4f} s, {numbers.double_support:.4f} s of them on both feet,"
            f" J = {numbers.cost:.4g} N^2 m s"
        )
        return f"SupportGait of {self.robot.name!r}: {self.width:.3f} m wide, dbeta = {self.speed:.4f} rad/s{orbit}"

    @cached_property
    def falling(self) -> Phase:
        """The rising phase, backwards."""
        up = self.rising
        return Phase(up.beta_end, up.beta_start, up.joint_bezier[:, ::-1].copy(), up.fri_bezier[::-1].copy())

    @property
    def speed_after_impact(self) -> float:
        """dbeta with which the single support begins [rad/s]."""
        return self.speed

    @property
    def specification(self) -> GaitSpecification:
        """Bounds of single support."""
        return self.asked.bounds

    @property
    def p_fri(self) -> float:
        """FRI at lift-off and landing, from the stance ankle [m]."""
        return float(self.rising.fri_bezier[0])

    def family(self, biped: FrontalBiped) -> DoubleSupportFamily:
        """The poses of its double support.

        Raises:
            GaitFileError: the gait is of another robot.
        """
        if biped.fingerprint != self.robot.fingerprint:
            raise GaitFileError(f"a gait of {self.robot.name!r} for {biped.name!r}; it must be of the same robot")
        return DoubleSupportFamily(biped, self.width)

    def hand_over(self, biped: FrontalBiped) -> HandOver:
        """Its double support, in the coordinates of the foot that takes the weight."""
        lift_off = SingleSupportEnd(self.rising.beta_start, self.p_fri)
        return HandOver.mirrored(self.family(biped), lift_off, self.speed)

    def limits(self, biped: FrontalBiped) -> SupportLimits:
        """What soles and motors carry in double support."""
        bounds = self.asked.bounds
        return SupportLimits(bounds.friction, bounds.fri_margin, bounds.torque_limits(biped))

    def orbit(self, biped: FrontalBiped, size: int = 24) -> PhaseOrbit:
        """The rising half of its single support on quadrature nodes; the falling half is the same, backwards."""
        return phase_orbit(biped, self.rising, StepPhase.RISING, size)
