r"""The closed form spoken of a robot in space: beta, sigma, zeta, the energy of its step, and the room before it tips.

The angular momentum sigma of all that moves, about the axis through the FRI that points where the robot walks, obeys

.. math:: \dot\sigma = -m g (p_{cm}^h - p_{FRI}) - \dot p_{FRI}\, m \dot p_{cm}^v

however the joints move, as long as the ground reaction acts at the FRI sideways: that is Euler's law, and kappa_2 and
kappa_3 of the zero dynamics are its two terms where p_cm follows the virtual constraints. What the closed form says of
zeta = sigma^2/2 it therefore says of the free robot, and is wrong by what its centre of mass is off by.

One number says how a step goes: the *energy of the step*, the zeta after its impact with which the zero dynamics would
pass here with this zeta. It is a constant of the motion from the impact to the next one, on the orbit and off it: with
zeta = e^Gamma (zeta+ - R) (`energy`) it is e^-Gamma zeta + R while rising; a falling phase is led back to the reversal,
or retraces the rising one above it, and from there to the impact. The next step's is an affine function of it.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.space.free_robot import BASE
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.stance_map import Stance
from frontal_biped.virtual_constraints.contract import RisingConstraints, VirtualConstraints
from frontal_biped.virtual_constraints.phase import StepPhase
from frontal_biped.zero_dynamics.energy import Panel
from frontal_biped.zero_dynamics.half_steps import falling_energy, landing_at_end, rising_energy, speed_at_end

BEYOND = 0.1
"""How far past its ends the first and the last panel of a phase are still believed, in units of their length."""


class FrontalEnergyReading(NamedTuple):
    """What the closed form says of a state.

    Attributes:
        beta: stance ankle angle, of the virtual leg in space [rad].
        dbeta: its rate [rad/s].
        sigma: angular momentum about the FRI [kg m^2/s].
        zeta: sigma^2/2 [kg^2 m^4/s^2].
        energy: of the step; nan where beta is outside what the closed form was followed over [kg^2 m^4/s^2].
        error: of that, relative to the orbit's [-].
        next_energy: of the next step [kg^2 m^4/s^2].
        barrier_margin: energy that may be added before the robot tips outwards, over the orbit's [-]; while rising of
            this step, while falling of the next one.
    """

    beta: float
    dbeta: float
    sigma: float
    zeta: float
    energy: float
    error: float
    next_energy: float
    barrier_margin: float


class FrontalEnergy:
    """Reads the energy of a gait's steps, in the plane and in space.

    Args:
        biped: the robot.
        rising: virtual constraints of the rising phase, followed past its end up to the energy barrier.
        falling: virtual constraints of the falling phase.
        speed_after_impact: dbeta_r+ of the orbit [rad/s].

    Attributes:
        orbit: energy of the orbit's step [kg^2 m^4/s^2].
        barrier: energy with which a step just does not tip, as far as the rising phase could be followed.
        reaches_barrier: could it be followed all the way?

    Raises:
        ReversalError: the zero dynamics is not defined where a phase begins, or stops before the impact.
    """

    def __init__(
        self,
        biped: FrontalBiped,
        rising: RisingConstraints,
        falling: VirtualConstraints,
        speed_after_impact: float,
    ) -> None:
        self.biped = biped
        self._constraints = {StepPhase.RISING: rising, StepPhase.FALLING: falling}
        up, down = rising_energy(biped, rising), falling_energy(biped, falling, falling.beta_start)
        self._panels = {StepPhase.RISING: up.panels, StepPhase.FALLING: down.panels}
        self.orbit = 0.5 * (up.start_inertia * speed_after_impact) ** 2
        self.barrier, self.reaches_barrier = up.highest, up.reaches_barrier
        self._reversal = falling.beta_start
        self._turn_growth, self._turn_spent = self._at(up.panels, falling.beta_start)
        # from zeta at the reversal to zeta after the next impact: of rest it makes the orbit's, or what the gait does
        landing, last = landing_at_end(biped, down), down.panels[-1]
        growth = float(np.exp(last.growth(last.end)))
        ratio = float(landing.speed_ratio) * up.start_inertia / float(down.restricted.I_P[-1])
        self._gain = growth * ratio**2
        self._after_rest = 0.5 * (up.start_inertia * float(landing.speed_ratio) * speed_at_end(down)) ** 2

    def at(self, phase: StepPhase, beta: float, sigma: float, dbeta: float = float("nan")) -> FrontalEnergyReading:
        """Read a state that is known by its angular momentum.

        Args:
            phase: rising or falling.
            beta: stance ankle angle [rad].
            sigma: angular momentum about the FRI target of the phase there [kg m^2/s].
            dbeta: rate of the stance ankle, which nothing but the answer needs [rad/s].
        """
        zeta = 0.5 * sigma**2
        above = phase is StepPhase.FALLING and beta > self._reversal
        growth, spent = self._at(self._panels[StepPhase.RISING if above else phase], beta)
        energy = float(np.exp(-growth)) * zeta + spent
        if phase is StepPhase.FALLING and not above:
            energy = float(np.exp(-self._turn_growth)) * energy + self._turn_spent
        at_turn = float(np.exp(self._turn_growth)) * (energy - self._turn_spent)
        following = self._after_rest + self._gain * at_turn
        margin = (self.barrier - (energy if phase is StepPhase.RISING else following)) / self.orbit
        return FrontalEnergyReading(beta, dbeta, sigma, zeta, energy, energy / self.orbit - 1.0, following, margin)

    def in_space(self, space: SpaceState, stance: Stance, phase: StepPhase) -> FrontalEnergyReading:
        """Read a free robot: its virtual stance leg is beta, and the angular momentum that of all its bodies.

        Args:
            space: the robot at a state.
            stance: the stance foot.
            phase: rising or falling.
        """
        seen = space.frontal(stance)
        beta, dbeta = float(seen.q[0]), float(seen.dq[0])
        return self.at(phase, beta, angular_momentum(space, stance, self._fri(phase, beta)), dbeta)

    def _fri(self, phase: StepPhase, beta: float) -> float:
        above = phase is StepPhase.FALLING and beta > self._reversal
        return self._constraints[StepPhase.RISING if above else phase].desired(beta)[3]

    @staticmethod
    def _at(panels: Iterable[Panel], beta: float) -> tuple[float, float]:
        """Gamma and R; nan beyond what was followed."""
        nearest = min(panels, key=lambda panel: _outside(panel, beta))
        if _outside(nearest, beta) > BEYOND:
            return float("nan"), float("nan")
        return float(nearest.growth(beta)), float(nearest.spent(beta))


def angular_momentum(space: SpaceState, stance: Stance, p: float) -> float:
    """Angular momentum of a free robot as the plane counts it: positive where dbeta is.

    Args:
        space: the robot at a state; rotors are not counted.
        stance: the stance foot.
        p: from the point below the stance ankle, which lies on the axis for p = 0, towards the other foot [m].

    Returns:
        About the horizontal axis along the heading through that point of the ground [kg m^2/s].
    """
    momentum = space.M[:BASE] @ space.v  # of the whole robot, in the axes of the root link and about its origin
    R = pin.Quaternion(space.q[3:7]).matrix()
    linear, angular = R @ momentum[:3], R @ momentum[3:]
    foot, side = space.feet[stance].position, stance.sign
    at = space.to_world(foot + np.array([0.0, -side * p, 0.0]))
    axis = space.to_world(np.array([1.0, 0.0, 0.0]))
    return float(-side * axis @ (angular + np.cross(space.q[:3] - at, linear)))


def _outside(panel: Panel, beta: float) -> float:
    """How far beta is from a panel, in units of its length; 0 inside."""
    low, high = sorted((panel.start, panel.end))
    return max(low - beta, beta - high, 0.0) / (high - low)
