r"""Standing on both feet: at rest, into the first step, and out of the last one.

Both feet carry, so the centre of pressure may be anywhere between them, and with it the divergent component
:math:`\xi = c + \dot c/\omega` of the centre of mass is led along a reference,

.. math:: p = p_{ref} + (1 + k/\omega)(\xi - \xi_{ref}), \qquad \ddot c = \omega^2 (c - p),

p cut to what the soles span. At rest the reference is the middle between the feet.
After the last landing nothing else is asked for: the error of xi, the speed at the landing over omega, dies out at the
rate k.

**The first step** begins where the gait's rising phase does: the centre of mass at s_0 from the first stance ankle, on
its way there with the speed of the orbit. At rest it is next to the same place, without the speed.
The centre of pressure goes to that foot first, so that the centre of mass falls away from it, then to the other one,
which sends it back, and half-way back before the other foot leaves the ground: straight ramps between places that it
keeps. Along a ramp p = p_0 + r t the pendulum has the closed form

.. math:: c(t) = p(t) + (c_0 - p_0) \cosh\omega t + \frac{\dot c_0 - r}{\omega} \sinh\omega t,

and how far it goes to the first foot, and how long it stays at the other, are found so that the way ends at s_0 with
that speed. The foot leaves the ground as soon as the energy sideways is that of the orbit (`SwayOrbit.error`), or a
moment later in any case; the energy law of the walk takes up what is missing.

On legs that keep their lengths the pelvis would roll the other way until then: towards the foot that it leaves. So the
leg that is to swing pushes off, its hip led as it moves right after an impact of the gait: at the end its length grows
at the rate that this takes over a foot that still stands (`push_off_speed`), after it was drawn in before.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import fsolve

from frontal_biped.arrays import FloatArray
from frontal_biped.control.spatial_walker.sagittal import SagittalLaw
from frontal_biped.exceptions import SimulationError
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.space.virtual_legs import SpaceState, X, Y
from frontal_biped.model.stance_map import Stance


@dataclass(frozen=True)
class StandingSettings:
    """How the robot stands.

    Attributes:
        rate: k, at which an error of the divergent component dies out [1/s].
        reach: way of the centre of pressure to either foot, as a share of that to the ankle, while way is gathered for
            the first step [-].
        ramp: time in which it goes from one foot to the other, and for which it stays at the first [s].
        given: where it is when the foot is lifted, as a share of the way to the stance foot [-].
        late: time after which the foot is lifted in any case [s].
        edge: share of a sole, outwards of the ankle, that the centre of pressure may use [-].
        still: speed of the centre of mass below which the robot is at rest [m/s].
        settled: time after a landing before the robot may be at rest [s].
        recovery: time in which both legs take their lengths back after a landing [s].
        push_off: time in which the leg that is to swing pushes off [s].
    """

    rate: float = 3.0
    reach: float = 1.0
    ramp: float = 0.1
    given: float = 0.0
    late: float = 0.06
    edge: float = 0.5
    still: float = 0.02
    settled: float = 0.3
    recovery: float = 0.4
    push_off: float = 0.4


class Start:
    """The way of a pendulum at rest into the first step; all to the left, for the left foot.

    Args:
        omega: of the pendulum [1/s].
        q: way of the centre of pressure to either side [m].
        ramp: time in which it goes from one side to the other, and for which it stays at the first [s].
        given: where it is when the foot is lifted, as a share of q [-].
        place: where the foot is lifted, from the middle [m].
        speed: there [m/s].
        side: the first stance foot: for the right one everything is mirrored.

    Attributes:
        duration: until the foot is lifted [s].

    Raises:
        SimulationError: it cannot gather as much way.
    """

    def __init__(
        self, omega: float, q: float, ramp: float, given: float, place: float, speed: float, side: Stance
    ) -> None:
        self._omega, self._sign = omega, side.sign

        def ways(unknown: FloatArray) -> list[_Ramp]:
            away, hold = unknown
            places = (
                (0.0, away, ramp),
                (away, away, ramp),
                (away, -q, ramp),
                (-q, -q, hold),
                (-q, given * q, 0.5 * (1.0 + given) * ramp),
            )
            return _chain(omega, places)

        def missed(unknown: FloatArray) -> FloatArray:
            last = ways(unknown)[-1]
            c, dc, _ = last.at(last.duration)
            return np.array([c - place, dc - speed])

        unknown, _, found, _ = fsolve(missed, np.array([0.5 * q, 2.0 * ramp]), full_output=True)
        away, hold = unknown
        if found != 1 or hold < 0.0 or abs(away) > 1.3 * q:
            raise SimulationError(
                f"a first step at {speed:.3g} m/s sideways: the centre of pressure cannot gather as much way within"
                f" {q:.3g} m of the middle in ramps of {ramp:.3g} s; shorten ramp or raise reach"
            )
        self._ways = ways(unknown)
        self.duration = sum(way.duration for way in self._ways)

    def at(self, t: float) -> tuple[float, float, float]:
        """Place [m], speed [m/s] and centre of pressure [m] at a time t [s]; from the end on the last one stays."""
        left = t
        for way in self._ways:
            if left < way.duration:
                break
            left -= way.duration
        else:
            way = self._ways[-1]
            end = way.at(way.duration)
            way = _Ramp(self._omega, end[0], end[1], end[2], end[2], np.inf)
        c, dc, p = way.at(left)
        return self._sign * c, self._sign * dc, self._sign * p


class _Ramp(NamedTuple):
    """A pendulum over a centre of pressure that goes from one place to another at a constant speed."""

    omega: float
    place: float
    speed: float
    begin: float
    end: float
    duration: float

    def at(self, t: float) -> tuple[float, float, float]:
        """Place [m], speed [m/s] and centre of pressure [m] after a time t [s]."""
        omega, rate = self.omega, (self.end - self.begin) / self.duration if self.duration else 0.0
        p, grown, turned = self.begin + rate * t, float(np.cosh(omega * t)), float(np.sinh(omega * t))
        off, slip = self.place - self.begin, self.speed - rate
        return p + off * grown + slip / omega * turned, rate + omega * off * turned + slip * grown, p


def _chain(omega: float, places: Iterable[tuple[float, float, float]]) -> list[_Ramp]:
    """Ramps (begin, end, duration) one after the other, from rest in the middle."""
    ways: list[_Ramp] = []
    c = dc = 0.0
    for begin, end, duration in places:
        way = _Ramp(omega, c, dc, begin, end, float(duration))
        ways.append(way)
        c, dc, _ = way.at(way.duration)
    return ways


def push_off_speed(biped: FrontalBiped, gait: Gait, speed: float) -> float:
    """Rate of the swing leg's length just before its foot leaves the ground [m/s].

    The hip moves as it does right after an impact of the gait, the foot still stands.

    Args:
        biped: the robot in the plane.
        gait: its rising phase.
        speed: of the centre of mass outwards there [m/s].
    """
    motion = gait.rising.motion(np.array([gait.rising.beta_start]))
    q, dq = motion.q[0], motion.dq[0]
    h = 1e-5
    ahead, behind = biped.joint_positions(q + h * dq), biped.joint_positions(q - h * dq)
    hip, ankle = biped.joint_positions(q)[-2:]
    way = (ahead[-2] - behind[-2]) / (2.0 * h)
    rate = -speed / float(biped.com_velocity(q, dq)[0])  # of beta: the sway falls while rising
    return float((hip - ankle) @ way / np.linalg.norm(hip - ankle)) * rate


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
        middle = 0.5 * (left + right)[: Y + 1]
        c, dc = state.com[: Y + 1] - middle, state.com_velocity[: Y + 1]
        aside = (0.0, 0.0, 0.0) if start is None else start.at(since)
        place, speed, p_ref = np.array([(law.p_ref, 0.0, law.p_ref), aside]).T
        p = p_ref + (1.0 + settings.rate / omega) * (c + dc / omega - place - speed / omega)
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
