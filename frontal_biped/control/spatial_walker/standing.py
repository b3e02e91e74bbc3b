r"""Standing on both feet: at rest, into the first step, and out of the last one.

Both feet carry, so the centre of pressure may be anywhere between them, and with it the divergent component
:math:`\xi = c + \dot c/\omega` of the centre of mass is led along a reference,

.. math:: p = p_{ref} + (1 + k/\omega)(\xi - \xi_{ref}), \qquad \ddot c = \omega^2 (c - p),

p cut to what the soles span, p_ref = c_ref - ddc_ref/omega^2. At rest the reference is the middle between the feet.
After the last landing nothing else is asked for: the error of xi, the speed at the landing over omega, dies out at the
rate k.

**The first step** begins where the gait's rising phase does: the centre of mass at s_0 from the first stance ankle, on
its way there with the speed of the orbit. At rest it is next to the same place, without the speed. A quintic leads it
there, first away from the foot to gather way, and at the end already braked by the stance foot,

.. math:: \ddot s = \lambda\, \omega^2 (s_0 - p_{FRI}),

so that most of the load is on that foot before the other one leaves the ground. It leaves as soon as the energy
sideways is that of the orbit (`SwayOrbit.error`), which takes up what the lift is early or late.
"""

from dataclasses import dataclass

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.spatial_walker.sagittal import SagittalLaw
from frontal_biped.model.space.virtual_legs import SpaceState, X, Y
from frontal_biped.model.stance_map import Stance


@dataclass(frozen=True)
class StandingSettings:
    """How the robot stands.

    Attributes:
        rate: k, at which an error of the divergent component dies out [1/s].
        gathering: time to gather way for the first step [s].
        braked: share of the acceleration of the first step that the stance foot gives before the lift [-].
        late: time after which the foot is lifted in any case [s].
        edge: share of a sole, outwards of the ankle, that the centre of pressure may use [-].
        still: speed of the centre of mass below which the robot is at rest [m/s].
        settled: time after a landing before the robot may be at rest [s].
        recovery: time in which both legs take their lengths back after a landing [s].
    """

    rate: float = 3.0
    gathering: float = 1.0
    braked: float = 0.6
    late: float = 0.06
    edge: float = 0.5
    still: float = 0.02
    settled: float = 0.3
    recovery: float = 0.4


class Start:
    """Boundary values of the first step, sideways.

    Args:
        place: of the centre of mass where the foot is lifted, to the left of the middle [m].
        speed: there, to the left [m/s].
        acceleration: there [m/s^2].
        duration: until then [s].
        from_place: where it begins [m].
        from_speed: there [m/s].
    """

    def __init__(
        self,
        place: float,
        speed: float,
        acceleration: float,
        duration: float,
        from_place: float = 0.0,
        from_speed: float = 0.0,
    ) -> None:
        T = self.duration = duration
        D = place - from_place - from_speed * T
        V, A = speed - from_speed, acceleration
        # the quintic from (from_place, from_speed, 0) to (place, speed, acceleration)
        self._c = (
            from_place,
            from_speed,
            (20.0 * D - 8.0 * V * T + A * T**2) / (2.0 * T**3),
            (-30.0 * D + 14.0 * V * T - 2.0 * A * T**2) / (2.0 * T**4),
            (12.0 * D - 6.0 * V * T + A * T**2) / (2.0 * T**5),
        )

    def at(self, t: float) -> tuple[float, float, float]:
        """Place [m], speed [m/s] and acceleration [m/s^2] at a time t [s]; from the end on the last ones go on."""
        c0, c1, c3, c4, c5 = self._c
        h = min(t, self.duration)
        x = c0 + c1 * h + c3 * h**3 + c4 * h**4 + c5 * h**5
        dx = c1 + 3.0 * c3 * h**2 + 4.0 * c4 * h**3 + 5.0 * c5 * h**4
        ddx = 6.0 * c3 * h + 12.0 * c4 * h**2 + 20.0 * c5 * h**3
        past = t - h
        return x + dx * past + 0.5 * ddx * past**2, dx + ddx * past, ddx


@dataclass(frozen=True)
class Balance:
    """What standing asks for.

    Attributes:
        acceleration: (2,) of the centre of mass, forwards and to the left [m/s^2].
        share: of the load on the left foot [-].
        cop: (2,) centre of pressure, forwards and to the left of the middle between the ankles [m].
    """

    acceleration: FloatArray
    share: float
    cop: FloatArray


class StandingLaw:
    """Leads the centre of mass between two feet that stand side by side.

    Args:
        sagittal: of the same robot: omega, and where under a sole the centre of pressure may be.
        settings: how.
    """

    def __init__(self, sagittal: SagittalLaw, settings: StandingSettings) -> None:
        self.settings, self._sagittal = settings, sagittal

    def at(self, state: SpaceState, start: Start | None = None, since: float = 0.0) -> Balance:
        """What is asked for at a state.

        Args:
            state: in the heading frame.
            start: of the first step; None: the robot is to be at rest in the middle.
            since: when that began [s ago].
        """
        law, settings = self._sagittal, self.settings
        omega = law.omega
        left, right = (state.feet[side].position for side in (Stance.LEFT, Stance.RIGHT))
        middle = 0.5 * (left + right)[:Y + 1]
        c, dc = state.com[: Y + 1] - middle, state.com_velocity[: Y + 1]
        wanted = np.array([(law.p_ref, 0.0, 0.0), (0.0, 0.0, 0.0) if start is None else start.at(since)])
        xi = c + dc / omega
        xi_ref = wanted[:, 0] + wanted[:, 1] / omega
        p_ref = wanted[:, 0] - wanted[:, 2] / omega**2
        p = p_ref + (1.0 + settings.rate / omega) * (xi - xi_ref)
        soles = state.free.soles
        low, high = law.reach
        half = 0.5 * float(left[Y] - right[Y])
        p = np.array(
            [
                min(max(p[X], low), high),
                min(max(p[Y], -half - settings.edge * soles.right.outer), half + settings.edge * soles.left.outer),
            ]
        )
        share = min(max(0.5 + 0.5 * p[Y] / half, 0.0), 1.0)
        return Balance(omega**2 * (c - p), float(share), p)
