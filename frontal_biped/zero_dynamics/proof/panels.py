r"""The energy along half a step as a model of the imposed reversal: the integrals of `passage`, all panels at once.

On a panel s = centre + h t the zero dynamics is a `TaylorModel` in t and y, and

.. math:: K(t) = K_{left} + F(t) - F(-1), \quad F(t) = \int_0^t rate\, span\, h\, dt', \qquad
          W = -\sum_{panels} \int_{-1}^{1} e^{-K} drive\, span\, h\, dt .
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frontal_biped.arrays import FloatArray
from frontal_biped.zero_dynamics.proof.balls import Number
from frontal_biped.zero_dynamics.proof.half_step import HalfStep, NotEnclosedError
from frontal_biped.zero_dynamics.proof.taylor_model import TaylorModel

PANELS = 16
"""Of a half step, to begin with."""

HALVINGS = 12
"""Of a panel, at most."""


class Panels(NamedTuple):
    """The zero dynamics on panels, from the impact to the point.

    Attributes:
        low: (B,) left ends, share of the way to the point.
        rate: 2 kappa_3 / kappa_1 times dbeta/dt.
        drive: kappa_2 / kappa_1 times dbeta/dt.
    """

    low: FloatArray
    rate: TaylorModel
    drive: TaylorModel

    @classmethod
    def in_order(cls, parts: list["Panels"]) -> "Panels":
        """All of some parts, from left to right."""
        low = np.concatenate([part.low for part in parts])
        rate, drive = (TaylorModel.joined(models) for models in zip(*(part[1:] for part in parts), strict=True))
        return cls(low, rate, drive).chosen(np.argsort(low))

    def chosen(self, which: NDArray[np.intp]) -> "Panels":
        """Some of them, in a given order."""
        return Panels(self.low[which], self.rate.chosen(which), self.drive.chosen(which))

    def fine(self, share: float) -> NDArray[np.bool_]:
        """(B,) is a panel known to a share of its energy? Not where nothing is known."""
        return np.asarray((self.rate.radius <= share) & (self.drive.radius <= share * self.drive.norm))


def work(half: HalfStep, ratio: Number, share: float) -> TaylorModel:
    """W of a half step up to a point, as a function of the imposed reversal.

    Args:
        half: the curve, its columns models.
        ratio: s of the point; a number if it is the same for all reversals.
        share: of its energy that a panel's radius may be; panels are halved until then.

    Raises:
        NotEnclosedError: I_P may vanish on the way.
    """
    panels = _panels(half, ratio, share)
    F = panels.rate.antiderivative()
    begun = F.at(-1)
    K = F - begun + (F.at(1) - begun).before()
    energy = ((-K).exp() * panels.drive).antiderivative()
    return (energy.at(-1) - energy.at(1)).total()


def _panels(half: HalfStep, ratio: Number, share: float) -> Panels:
    """Halved until they are fine."""
    low, width = np.linspace(0.0, 1.0, PANELS, endpoint=False), 1.0 / PANELS
    done: list[Panels] = []
    for _ in range(HALVINGS + 1):
        found = _on(half, ratio, low, width)
        fine = found.fine(share)
        done.append(found.chosen(np.flatnonzero(fine)))
        low = found.low[np.flatnonzero(~fine)]
        if not len(low):
            return Panels.in_order(done)
        if len(low) > PANELS:
            break  # narrower ones are no help
        width *= 0.5
        low = np.concatenate([low, low + width])
    raise NotEnclosedError("panel")


def _on(half: HalfStep, ratio: Number, low: FloatArray, width: float) -> Panels:
    """The zero dynamics on panels of one width.

    Raises:
        NotEnclosedError: I_P may vanish at the middle of one, where narrower ones are no help.
    """
    on = half.at(TaylorModel.along(low, low + width) * ratio)
    if not np.all(on.I_P.at(0).surely_positive):
        raise NotEnclosedError("I_P")
    scale = half.span * ratio * (0.5 * width)
    return Panels(low, on.moving * on.I_P.inverse * scale, on.drive * scale)
