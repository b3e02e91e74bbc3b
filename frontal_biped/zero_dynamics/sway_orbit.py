r"""The orbit seen in the sway: energy of the centre of mass sideways, and the time to landing in closed form.

s is how far the centre of mass is inwards of the stance ankle; it falls while rising and grows while falling. Along the
orbit the energy of the motion sideways is a function of it,

.. math:: E(s) = \tfrac12 \dot s^2.

A centre of mass at a height z above a ground reaction that acts at p_FRI obeys s'' = g/z (s - p_FRI(s)); so two motions
under the same FRI target differ by an energy e = ds^2/2 - E(s) that is the same everywhere: a constant of the motion,
up to what the legs' turning adds. (Over beta the same difference is multiplied by (delta_FRI/I_P)^2, which falls by two
orders from the reversal to the ends.) The time left is

.. math:: t = \int \frac{ds}{\sqrt{2 (E(s) + e\, e^{-|s - s_0|/\ell})}}

over what is left of the phase, l the length over which a controller takes the error off; while rising over the way to
where the robot turns and from there down. E is tabulated and ds^2 is linear between the points, where the acceleration
is constant and every piece exact.

Before its start the rising orbit is continued as the pendulum that it is, past the reversal with the reversal's
acceleration.
"""

from functools import cached_property

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import GRAVITY
from frontal_biped.virtual_constraints.phase import StepPhase
from frontal_biped.virtual_constraints.swayed import sways
from frontal_biped.zero_dynamics.orbit import PhaseOrbit

POINTS = 129

LONGEST = 1.5
"""Longest time to landing that is told, in steps: a robot near its equilibrium would stand for ever."""

BEYOND = 0.1
"""How far past the reversal the time of a fall from rest is tabulated [m]."""

SLOWEST = 1e-9
"""Sum of two speeds below which a piece counts as one without energy [m/s]."""


class SwayOrbit:
    """Energy and time over the sway, of one gait.

    Args:
        biped: the robot.
        rising: orbit of the rising phase.
        falling: orbit of the falling phase.
        decay: share of a phase's range over which an energy error dies out [-]; inf: it stays.

    Attributes:
        omega: sqrt(g/z), z the mean height of the centre of mass [1/s].
        duration: of a step [s].
        reversal: sway at the reversal [m].
        ranges: way of the centre of mass in either phase [m].

    Raises:
        SimulationError: the sway does not run one way along a phase.
    """

    def __init__(self, biped: FrontalBiped, rising: PhaseOrbit, falling: PhaseOrbit, decay: float = np.inf) -> None:
        self.duration = float(rising.duration + falling.duration)
        self._s: dict[StepPhase, FloatArray] = {}
        self._energy: dict[StepPhase, FloatArray] = {}
        self._table: dict[StepPhase, tuple[float, float, list[float]]] = {}
        self.ranges: dict[StepPhase, float] = {}
        heights: list[float] = []
        for orbit in (rising, falling):
            q, dq = orbit.motion.q, orbit.motion.dq * orbit.dbeta[:, None]
            s = sways(biped, q)
            ds = np.array([float(biped.com_velocity(*state)[0]) for state in zip(q, dq, strict=True)])
            order = np.argsort(s)
            grid = np.linspace(float(s.min()), float(s.max()), POINTS)
            self._s[orbit.kind] = grid
            self._energy[orbit.kind] = np.interp(grid, s[order], 0.5 * ds[order] ** 2)
            # ends and energies in plain numbers, which a control tick looks up
            self._table[orbit.kind] = grid.item(0), grid.item(-1), self._energy[orbit.kind].tolist()
            self.ranges[orbit.kind] = float(np.ptp(s))
            heights.extend(float(biped.com(row)[1]) for row in q)
        self.omega = float(np.sqrt(GRAVITY / np.mean(heights)))
        self._decay = decay
        self.reversal = 0.5 * float(self._s[StepPhase.RISING][0] + self._s[StepPhase.FALLING][0])
        self._first_fri = float(rising.motion.p_fri[np.argmax(rising.tau)])
        reversal_fri = float(rising.motion.p_fri[np.argmin(rising.tau)])
        self._turning = self.omega**2 * (self.reversal - reversal_fri)

    @cached_property
    def _from_rest(self) -> tuple[FloatArray, FloatArray]:
        """Sways of rest [m] and times down from them [s]; only who asks for the time left pays for the table."""
        down = self._s[StepPhase.FALLING]
        turns = np.append(np.linspace(self.reversal - BEYOND, float(down[0]), POINTS)[:-1], down)
        return turns, np.array([self._fall(float(s), 0.0) for s in turns])

    def energy(self, phase: StepPhase, s: float) -> float:
        """E [m^2/s^2] at a sway [m], beyond the phase's ends too; negative where the orbit does not come."""
        first, last, table = self._table[phase]
        if s < first:
            return table[0] - self._turning * (first - s)
        if s <= last:  # between two points of the table, which are as far apart as any
            place = (s - first) / (last - first) * (POINTS - 1)
            before = min(int(place), POINTS - 2)
            at = table[before]
            return at + (place - before) * (table[before + 1] - at)
        p = self._first_fri
        return table[-1] + 0.5 * self.omega**2 * ((s - p) ** 2 - (last - p) ** 2)

    def error(self, phase: StepPhase, s: float, ds: float) -> float:
        """e = ds^2/2 - E(s) [m^2/s^2]."""
        return 0.5 * ds**2 - self.energy(phase, s)

    def ends(self, phase: StepPhase) -> float:
        """Largest sway of a phase [m]: where it rises from, or falls to."""
        return float(self._s[phase][-1])

    def half_way(self, phase: StepPhase) -> float:
        """Sway in the middle of a phase [m]."""
        return 0.5 * float(self._s[phase][0] + self._s[phase][-1])

    def left(self, phase: StepPhase, s: float, ds: float) -> float:
        """Time left to the landing [s], from zero to 1.5 steps.

        Args:
            phase: rising or falling.
            s: sway [m].
            ds: its rate [m/s].
        """
        if phase is StepPhase.FALLING or ds >= 0.0:
            left = self._fall(s, max(ds, 0.0))
        else:
            left, turn = self._rise(s, ds)
            left += float(np.interp(turn, *self._from_rest))
        return min(left, LONGEST * self.duration)

    def _rise(self, s: float, ds: float) -> tuple[float, float]:
        """Time to the reversal [s] and sway there [m]."""
        time = 0.0
        grid = self._s[StepPhase.RISING]
        if s > grid[0]:
            behind = int(np.searchsorted(grid, s))
            way = np.append(grid[:behind], s)[::-1]
            energy = self._led_back(StepPhase.RISING, way, slice(0, behind), s, ds)
            if energy.min() <= 0.0 and (spent := np.flatnonzero(energy[1:] <= 0.0)).size:  # turns before
                k = int(spent[0])
                share = energy[k] / (energy[k] - energy[k + 1])
                turn = float(way[k] + share * (way[k + 1] - way[k]))
                return _time(np.append(way[: k + 1], turn), np.append(energy[: k + 1], 0.0)), turn
            time = _time(way, energy)
            s, ds = grid.item(0), -float(np.sqrt(2.0 * energy[-1]))
        return time - ds / self._turning, s - 0.5 * ds**2 / self._turning

    def _fall(self, s: float, ds: float) -> float:
        """Time to the end of the falling phase [s]."""
        grid = self._s[StepPhase.FALLING]
        if s >= grid[-1]:
            return 0.0
        ahead = int(np.searchsorted(grid, s, side="right"))
        way = np.concatenate([[s], grid[ahead:]])
        energy = self._led_back(StepPhase.FALLING, way, slice(ahead, None), s, ds)
        return _time(way, np.maximum(energy, 0.0))

    def _led_back(self, phase: StepPhase, way: FloatArray, passed: slice, s: float, ds: float) -> FloatArray:
        """(n,) ds^2/2 along a way over points of the table that begins at s with a speed, its error dying out."""
        e, length = self.error(phase, s, ds), self._decay * self.ranges[phase]
        inside = self._energy[phase][passed]
        if phase is StepPhase.RISING:
            inside = inside[::-1]
        energy = e * np.exp(-np.abs(way - s) / length)
        energy[0] = 0.5 * ds**2
        energy[1:] += inside
        return energy


def _time(s: FloatArray, energy: FloatArray) -> float:
    """[s] along a way; pieces without energy are left out."""
    speeds = np.sqrt(2.0 * energy)
    both = speeds[:-1] + speeds[1:]
    both[both < SLOWEST] = np.inf
    return 2.0 * float(np.abs((s[1:] - s[:-1]) / both).sum())
