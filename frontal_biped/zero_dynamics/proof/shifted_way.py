"""Half a step in balls whose FRI target is shifted by a constant, from panels of the planned one.

A shift is no new path: pose, slope and all that follows from them stay, and of the dynamics only I_P and the
coefficients that hold it or p_FRI are others. So one walk along a path serves every shift.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from frontal_biped.zero_dynamics.proof.balls import Ball, Number, coefficient, is_positive
from frontal_biped.zero_dynamics.proof.half_orbit import (
    NOTHING,
    Panel,
    panel_of,
)
from frontal_biped.zero_dynamics.proof.half_path import (
    Path,
    Projected,
    Shape,
    zero_dynamics_at,
)
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.perturbed_steps import (
    Controls,
)
from frontal_biped.zero_dynamics.proof.ranges import controls


@dataclass(frozen=True)
class Way:
    """Half a step from the reversal on, its FRI target shifted.

    Attributes:
        panels: from the reversal to the end.
        L: int of the rate over it.
        energy: what the way takes, or gives back, of zeta at the reversal [kg^2 m^4/s^2].
        I_P: at the end [kg m^2].
    """

    panels: tuple[Panel, ...]
    L: Ball
    energy: Ball
    I_P: Ball

    @classmethod
    def of(cls, panels: Iterable[Panel], end: Projected, shift: Ball, motors: bool = True) -> "Way":
        """The way along panels, whose end is known, with another FRI target.

        Args:
            panels: with the target as planned.
            end: where the way ends, likewise.
            shift: of the target [m]; a ball is all shifts between.
            motors: are their torques asked for, too? The energy alone takes half the time.

        Raises:
            NotEnclosedError: I_P may vanish, or the drive not be negative.
        """
        found, at = [], NOTHING
        for panel in panels:
            middle, wide = (shifted(place if motors else _alone(place), shift) for place in panel.path)
            on_Z = zero_dynamics_at((middle, wide), panel.h)
            moved, at = panel_of(panel, panel.low, panel.high, (middle, wide), on_Z, at)
            if not all(is_positive(-coefficient(place.drive, 0)) for place in moved.on_Z):
                raise NotEnclosedError("drive")
            found.append(moved)
        return cls(tuple(found), at.L, found[-1].span * at.W, shifted(end, shift).I_P)

    @property
    def zeta(self) -> Ball:
        """At its end [kg^2 m^4/s^2]."""
        return self.L.exp() * self.energy

    @property
    def dbeta_squared(self) -> Ball:
        """At its end [rad^2/s^2]."""
        return 2 * self.zeta / (self.I_P * self.I_P)

    def surplus(self, dbeta_squared: Ball) -> Ball:
        """Energy at its end beyond what rising to the reversal takes [kg^2 m^4/s^2]."""
        return self.I_P * self.I_P * dbeta_squared / 2 - self.zeta

    def rows(self) -> Controls:
        """What the limits of contact and motors bound along it, but for the height of the swing foot.

        Raises:
            NotEnclosedError: the ground may pull.
        """
        rows: Controls = {}
        for panel in self.panels:
            own = {FRI: panel.pose_rows()[FRI]} | panel.motion_rows(panel.dbeta_squared())
            for name, taylor in own.items():
                rows.setdefault(name, []).append(controls(taylor, panel.h))
        return rows


FRI = "FRI in the sole"
"""Among the rows [m]."""


def shifted(place: Projected, shift: Ball) -> Projected:
    """A place of the path, or series about it, with its FRI target moved by so much [m]."""
    return place._replace(I_P=place.I_P - place.A[1] * shift, p_fri=place.p_fri + shift)


def _alone(place: Projected) -> Projected:
    """Without the motors: F_h, F_v and N_0 are all that the energy asks for."""
    return place._replace(A=place.A[:3], B=place.B[:3], G=place.G[:3])


@dataclass(frozen=True)
class Moved(Path):
    """A path whose FRI target is moved by a constant.

    Attributes:
        path: the path.
        shift: of the target [m].
    """

    path: Path
    shift: Ball

    @classmethod
    def of(cls, path: Path, shift: Ball) -> "Moved":
        """A path with its target moved by so much [m]."""
        return cls(path.chain, path.sole, path.span, path, shift)

    def shape(self, y: Number) -> Shape:
        """The virtual constraints at a share of the way."""
        shape = self.path.shape(y)
        return shape._replace(p_fri=shape.p_fri + self.shift)
