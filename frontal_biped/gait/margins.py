"""Room left to the contact and torque limits along a phase of the zero dynamics, and at the impact that ends it.

The limits are C04 to C08 of the gait's specification (`gait.constraints`), less the reserves that a plan keeps for
perturbations: here the perturbation has come, so the FRI may go to the end of the sole (no ``fri_margin``), the swing
foot down to the ground (no ``swing_clearance``), and land as softly as it likes (no ``touchdown_speed``). Friction,
normal force and torques are limits of the ground and of the motors, and hold as specified.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from frontal_biped.gait.constraints import Constraint, clearance_limit, impact_limits, phase_limits, sole_heights
from frontal_biped.gait.planned_step import PlannedStep
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.impact import Landing
from frontal_biped.zero_dynamics.energy import PhaseEnergy
from frontal_biped.zero_dynamics.half_steps import landing_at_end, speed_at_end
from frontal_biped.zero_dynamics.restricted import F_V

ROUNDING = 1e-12
"""Of an angle where a phase ends [rad]."""

LIFTED = 1e-3
"""Share 1 - t2 of a phase below which touchdown or lift-off speak for the swing foot: both it and its height vanish."""


@dataclass(frozen=True)
class Margin:
    """Room left to one limit over a step.

    Attributes:
        name: of the limit.
        value: room, positive inside, as a share of what the limit leaves: of the coefficient 1 and of the weight, of
            the width of the sole, of the torque limit; else in units of the constraint's `scale` [-].
    """

    name: str
    value: float


@dataclass(frozen=True)
class ContactMargins:
    """Evaluates the limits that a gait was designed for.

    Attributes:
        biped: the robot.
        gait: the gait, or the step between two gaits.
    """

    biped: FrontalBiped
    gait: PlannedStep

    @cached_property
    def limits(self) -> GaitSpecification:
        """The gait's specification without the reserves of a plan."""
        return replace(self.gait.specification, fri_margin=0.0, swing_clearance=0.0, touchdown_speed=0.0)

    @cached_property
    def _max_torque(self) -> list[float]:
        most: list[float] = self.limits.torque_limits(self.biped).tolist()
        return most

    @cached_property
    def _sole_width(self) -> float:
        outer, inner = self.biped.sole
        return inner - outer

    def rising(self, energy: PhaseEnergy, dbeta: float, reversal: float) -> list[Margin]:
        """Along a rising phase begun with dbeta [rad/s], up to its reversal [rad]."""
        zeta = 0.5 * (energy.start_inertia * dbeta) ** 2
        return self._along("rising", energy, zeta, reversal, energy.start)

    def falling(self, energy: PhaseEnergy, reversal: float) -> list[Margin]:
        """Along a falling phase from its reversal [rad], and at the impact.

        Raises:
            ReversalError: the robot stops before the impact.
        """
        impact = self._at_impact(landing_at_end(self.biped, energy), speed_at_end(energy))
        return [*self._along("falling", energy, 0.0, reversal, energy.end), *impact]

    def load(self, energy: PhaseEnergy, zeta: float) -> float:
        """Largest torque and friction of a phase that begins with zeta, up to where it reverses, over their limits [-].

        Args:
            energy: of the phase.
            zeta: at its start [kg^2 m^4/s^2].
        """
        left = energy.left(zeta)
        moving = left >= 0.0
        if not np.any(moving):
            return 0.0
        forces, p_fri = energy.forces(left)[:, moving], energy.restricted.p_fri[moving]
        if np.any(forces[F_V] <= 0.0):
            return float("inf")
        limits = phase_limits(self.biped, self.limits, forces, p_fri, "rising")
        pairs = ((limits.friction, self.limits.friction), *zip(limits.torques, self._max_torque, strict=True))
        return max(float(np.max(np.abs(limit.values))) / most for limit, most in pairs)

    def _along(self, name: str, energy: PhaseEnergy, zeta: float, reversal: float, foot_end: float) -> list[Margin]:
        """Contact constraints along a phase; ``foot_end`` is where the swing foot is on the ground [rad]."""
        inside = energy.motion.q[:, 0] <= reversal + ROUNDING
        q, p_fri = energy.motion.q[inside], energy.restricted.p_fri[inside]
        forces = energy.forces(energy.left(zeta))[:, inside]
        way, whole = q[:, 0] - foot_end, reversal - foot_end
        # a robot that turns back where it begins has no way along which a foot could have lifted
        share = way / whole if whole > ROUNDING else np.zeros_like(way)
        lifted = share > LIFTED
        heights = sole_heights(self.biped, q[lifted])
        limits = phase_limits(self.biped, self.limits, forces, p_fri, name)
        clearance = clearance_limit(self.limits, heights, share[lifted], name)
        rooms = {
            "friction": _room(limits.friction, 1.0),
            "normal force": _room(limits.normal_force, 1.0),
            "FRI in the sole": _room(limits.fri, self._sole_width),
            "torque": min(_room(torque, most) for torque, most in zip(limits.torques, self._max_torque, strict=True)),
            "swing foot clearance": _room(clearance, clearance.scale),
        }
        return [Margin(f"{key}, {name}", value) for key, value in rooms.items()]

    def _at_impact(self, landing: Landing, dbeta: float) -> list[Margin]:
        limits = impact_limits(self.biped, self.limits, landing, dbeta)
        return [
            Margin("touchdown speed", _room(limits.touchdown, limits.touchdown.scale)),
            Margin("normal impulse", _room(limits.normal_impulse, limits.normal_impulse.scale)),
            Margin("impulse in the friction cone", _room(limits.friction, 1.0)),
            Margin("impulse in the sole", _room(limits.center_of_pressure, self._sole_width)),
            Margin("lift-off of the old stance foot", _room(limits.lift_off, limits.lift_off.scale)),
        ]


def _room(limit: Constraint, unit: float) -> float:
    """Least distance to the bounds, negative outside, over a unit."""
    if limit.values.size == 0:
        return np.inf
    above = np.inf if limit.lower is None else limit.values.min().item() - limit.lower
    below = np.inf if limit.upper is None else limit.upper - limit.values.max().item()
    return min(above, below) / unit
