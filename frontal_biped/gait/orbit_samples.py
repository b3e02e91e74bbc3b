"""The periodic orbit of a gait sampled in time, straight from the zero dynamics."""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import ReversalError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.phase import Phase, StepPhase
from frontal_biped.zero_dynamics.orbit import PhaseOrbit, resample
from frontal_biped.zero_dynamics.restricted import F_H, F_V, TORQUES

TIME_POINTS = 241
"""Of the spline that tells the time of points in between: one more changes no instant by as much as a nanosecond."""

_NEWTON_STEPS = 6


class OrbitSamples(NamedTuple):
    """Part of one phase of the periodic orbit; units as in a run.

    Attributes:
        t: (n,) from the start of the phase [s].
        q: (n, 4) [rad].
        dq: (n, 4) [rad/s].
        u: (n, 4) [N m].
        force: (n, 2) F_h, F_v [N].
        p_fri: (n,) [m].
        phase: (n,) +1 rising, -1 falling.
    """

    t: FloatArray
    q: FloatArray
    dq: FloatArray
    u: FloatArray
    force: FloatArray
    p_fri: FloatArray
    phase: FloatArray


def phase_samples(biped: FrontalBiped, phase: Phase, orbit: PhaseOrbit, tau: FloatArray) -> OrbitSamples:
    """A phase at points tau, in the order of time.

    Args:
        biped: the robot.
        phase: its virtual constraints.
        orbit: through its reversal.
        tau: (n,) increasing from 0, the reversal, to 1, the impact.

    Raises:
        ReversalError: the zero dynamics does not go through the phase.
    """
    points = resample(biped, phase, orbit, tau)
    from_reversal = _density(points).antiderivative()(points.tau)
    rising = points.kind is StepPhase.RISING
    t = (from_reversal[-1] - from_reversal) if rising else from_reversal
    order = slice(None, None, -1) if rising else slice(None)
    return OrbitSamples(*(np.ascontiguousarray(values[order]) for values in _samples(points, t)))


class TimedPhase:
    """A phase of the periodic orbit at any instant.

    Args:
        biped: the robot.
        phase: its virtual constraints.
        orbit: through its reversal.

    Attributes:
        duration: of the phase [s].

    Raises:
        ReversalError: the zero dynamics does not go through the phase.
    """

    def __init__(self, biped: FrontalBiped, phase: Phase, orbit: PhaseOrbit) -> None:
        self._parts = biped, phase, orbit
        self._rising = orbit.kind is StepPhase.RISING
        self._tau = np.linspace(0.0, 1.0, TIME_POINTS)
        self._density = _density(resample(*self._parts, self._tau))
        self._time = self._density.antiderivative()
        self.duration = float(self._time(1.0))

    def at(self, t: FloatArray) -> OrbitSamples:
        """The phase at instants t (n,) from its start [s], in any order."""
        wanted = np.clip(self.duration - t if self._rising else t, 0.0, self.duration)
        tau = np.interp(wanted, self._time(self._tau), self._tau)
        for _ in range(_NEWTON_STEPS):
            tau = np.clip(tau - (self._time(tau) - wanted) / self._density(tau), 0.0, 1.0)
        points = resample(*self._parts, np.append(tau, (0.0, 1.0)))  # two points at least
        return OrbitSamples(*(values[:-2] for values in _samples(points, np.append(t, (0.0, 0.0)))))


def _density(points: PhaseOrbit) -> CubicSpline:
    """Time spent per tau [s]."""
    if not np.all(np.isfinite(points.time_density)):
        raise ReversalError(
            f"the gait has no periodic orbit, the robot stops in its {points.kind.value} phase; `frontal-biped analyze`"
            " says more, design it again"
        )
    return CubicSpline(points.tau, points.time_density)


def _samples(points: PhaseOrbit, t: FloatArray) -> OrbitSamples:
    forces = points.generalized_forces
    return OrbitSamples(
        t=t,
        q=points.motion.q,
        dq=points.motion.dq * points.dbeta[:, None],
        u=forces[TORQUES].T,
        force=forces[[F_H, F_V]].T,
        p_fri=points.motion.p_fri,
        phase=np.full(len(t), points.kind.sign),
    )
