r"""Paths of many reversals at once, by the mean value theorem.

With how early the reversal is in a ball, formulas that use it many times give balls that are far wider than what they
enclose: a hundred times, where phases are rescaled. So a family of paths is computed twice, at the middle of the ball,
and for all of it with the derivative by it (`Jet`): f(d) = f(m) + f'(somewhere in the ball) (d - m).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from frontal_biped.zero_dynamics.proof.balls import Ball, Jet, Number, value_of
from frontal_biped.zero_dynamics.proof.half_path import OnZ, Path, Projected, Shape

T = TypeVar("T", Projected, OnZ)


@dataclass(frozen=True)
class Family(Path):
    """Paths of all reversals of a ball.

    Attributes:
        middle: that of its middle.
        all: those of all of it, in jets by how early the reversal is.
        off: the ball less its middle [rad].
    """

    middle: Path
    all: Path
    off: Ball

    @classmethod
    def of(cls, path_of: Callable[[Number], Path], d: Ball) -> "Family":
        """Of the path by how early its reversal is [rad], a ball or a `Jet`.

        Raises:
            NotEnclosedError: as it.
        """
        middle, moving = path_of(d.mid()), path_of(Jet([d, d * 0 + 1]))
        return cls(middle.chain, middle.sole, value_of(moving.span), middle, moving, d - d.mid())

    def shape(self, y: Number) -> Shape:
        """Of all of them, without further ado."""
        return Shape(*(_values(part) for part in self.all.shape(y)))

    def at(self, y: Number) -> Projected:
        """The dynamics along all of them."""
        return self._centred(self.middle.at(y), self.all.at(y), y)

    def on_panel(self, y: tuple[Ball, Ball], h: Ball) -> tuple[tuple[Projected, Projected], tuple[OnZ, OnZ]]:
        """As of any path; here the zero dynamics itself is narrowed as well."""
        places, on_Z = self.middle.on_panel(y, h)
        moving, moving_on_Z = self.all.on_panel(y, h)
        return (
            (self._centred(places[0], moving[0], y[0]), self._centred(places[1], moving[1], y[1])),
            (self._centred(on_Z[0], moving_on_Z[0], y[0]), self._centred(on_Z[1], moving_on_Z[1], y[1])),
        )

    def _centred(self, middle: T, moving: T, y: Number) -> T:
        return type(middle)(*(self._each_centred(a, b, y) for a, b in zip(middle, moving, strict=True)))

    def _each_centred(self, middle: Number, moving: Number, y: Number) -> Number:
        if isinstance(middle, list):
            return [self._each_centred(a, b, y) for a, b in zip(middle, moving, strict=True)]
        if not isinstance(moving, Jet):
            return moving
        # a part that does not depend on y may be no series yet
        return y * 0 + middle + moving.parts[1] * self.off


def _values(x: Number) -> Number:
    return [_values(part) for part in x] if isinstance(x, list | tuple) else value_of(x)
