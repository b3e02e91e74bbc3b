"""Room left to the contact and torque limits along a phase of the zero dynamics, and at the impact that ends it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.zero_dynamics.energy import PhaseEnergy
from frontal_biped.zero_dynamics.half_steps import landing_at_end, speed_at_end
from frontal_biped.zero_dynamics.poincare import Landing
from frontal_biped.zero_dynamics.restricted import F_H, F_V, TORQUES

ALONG = ("friction", "normal force", "FRI in the sole", "torque", "swing foot clearance")


@dataclass(frozen=True)
class Margin:
    """Room left to one limit over a step.

    Attributes:
        name: of the limit.
        value: room, positive inside, in units of a typical size of the quantity [-].
    """

    name: str
    value: float


@dataclass(frozen=True)
class ContactMargins:
    """Evaluates the limits that a gait was designed for.

    Attributes:
        biped: the robot.
        gait: the gait.
    """

    biped: FrontalBiped
    gait: Gait

    @cached_property
    def friction(self) -> float:
        """Coefficient of friction [-]."""
        return self.gait.specification.friction

    @cached_property
    def min_normal_force(self) -> float:
        """Smallest normal force, as a fraction of the weight [-]."""
        return self.gait.specification.min_normal_force

    @cached_property
    def max_torque(self) -> FloatArray:
        """(4,) torque limits [N m]."""
        return self.gait.specification.torque_limits(self.biped)

    def rising(self, energy: PhaseEnergy, dbeta: float, reversal: float) -> list[Margin]:
        """Along a rising phase begun with dbeta [rad/s], up to its reversal [rad]."""
        zeta = 0.5 * (energy.start_inertia * dbeta) ** 2
        return self._along("rising", energy, zeta, reversal, energy.panels[0].start)

    def falling(self, energy: PhaseEnergy, reversal: float) -> list[Margin]:
        """Along a falling phase from its reversal [rad], and at the impact.

        Raises:
            ReversalError: the robot stops before the impact.
        """
        impact = self._at_impact(landing_at_end(self.biped, energy), speed_at_end(energy))
        return [*self._along("falling", energy, 0.0, reversal, energy.end), *impact]

    def _along(self, name: str, energy: PhaseEnergy, zeta: float, reversal: float, foot_end: float) -> list[Margin]:
        """Contact constraints along a phase; ``foot_end`` is where the swing foot is on the ground [rad]."""
        outer, inner = self.biped.sole
        worst = dict.fromkeys(ALONG, np.inf)
        for panel in energy.panels:
            beta = panel.motion.q[:, 0]
            inside = beta <= reversal + 1e-12
            if not np.any(inside):
                break
            value = np.exp(panel.growth(beta)) * (zeta - panel.spent(beta))
            dynamics = panel.restricted
            speed_squared = np.maximum(2.0 * value, 0.0) / dynamics.I_P**2
            A, B, G = dynamics.projected
            forces = (A * dynamics.acceleration(speed_squared) + B * speed_squared + G)[:, inside]
            p = dynamics.p_fri[inside]
            share = (beta[inside] - foot_end) / (reversal - foot_end)
            lifted = share > 1e-3
            found = {
                "friction": self.friction - np.abs(forces[F_H] / forces[F_V]),
                "normal force": forces[F_V] / self.biped.weight - self.min_normal_force,
                "FRI in the sole": np.minimum(p - outer, inner - p) / (inner - outer),
                "torque": np.min(1.0 - np.abs(forces[TORQUES]) / self.max_torque[:, None], axis=0),
                "swing foot clearance": np.array(
                    [
                        self.biped.swing_sole(q)[:, 1].min() / (0.01 * s)
                        for q, s in zip(panel.motion.q[inside][lifted], share[lifted], strict=True)
                    ]
                ),
            }
            for key, values in found.items():
                worst[key] = min(worst[key], float(np.min(values, initial=np.inf)))
        return [Margin(f"{key}, {name}", value) for key, value in worst.items()]

    def _at_impact(self, landing: Landing, dbeta: float) -> list[Margin]:
        outer, inner = self.biped.sole
        L = landing.impulse * dbeta
        lever = float(L[2] / L[1])
        return [
            Margin("touchdown speed", float(np.min(-landing.touchdown * dbeta)) / 0.05),
            Margin("normal impulse", float(L[1]) / (0.1 * self.biped.mass)),
            Margin("impulse in the friction cone", self.friction - abs(float(L[0] / L[1]))),
            # the landing foot is mirrored: its inner end points towards -h
            Margin("impulse in the sole", min(lever + inner, -outer - lever) / (inner - outer)),
            Margin("lift-off of the old stance foot", float(np.min(landing.lift_off * dbeta)) / 0.05),
        ]
