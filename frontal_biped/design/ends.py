"""What a step of a design begins and ends with: its own landing, as a gait does, or the landings of two gaits."""

from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.start import swayed_stand
from frontal_biped.design.variables import BETA_IMPACT, STEP_WIDTH, VariableLayout
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.impact import Landing, impact
from frontal_biped.model.stance_map import relabel
from frontal_biped.virtual_constraints.invariance import FreeParameters, StepBegin, double_support_pose
from frontal_biped.zero_dynamics.poincare import StepOrbit


class Departure(NamedTuple):
    """The impact that a step begins with, where it is not the one it ends with.

    Attributes:
        begin: pose and slope.
        landing: of the gait walked until then.
    """

    begin: StepBegin
    landing: Landing


class StepEnds(Protocol):
    """All in which a design problem depends on where its step comes from and leads to."""

    @property
    def departure(self) -> Departure | None:
        """The impact it begins with; None where that is the one it ends with."""

    def starts(self, layout: VariableLayout) -> tuple[FloatArray, ...]:
        """Variables (P,) to start from: the nearest to a step is taken, and the last are the middle of the bounds."""

    def held(self, layout: VariableLayout) -> tuple[list[int], FloatArray]:
        """Variables that are not free: which, and their values."""

    def completed(self, free: FreeParameters) -> FreeParameters:
        """The free parameters, with what the end of the step wants put in."""

    def balance(self, step: StepOrbit) -> list[float]:
        """Squared speeds that must vanish [rad^2/s^2]."""


@dataclass(frozen=True)
class Periodic:
    """A gait: the step begins with the landing it ends with, and returns the speed it began with.

    Attributes:
        biped: the robot.
        specification: the bounds.
    """

    biped: FrontalBiped
    specification: GaitSpecification

    departure = None

    def starts(self, layout: VariableLayout) -> tuple[FloatArray, ...]:
        """`swayed_stand`."""
        return (layout.pack(swayed_stand(self.biped, self.specification)),)

    def held(self, layout: VariableLayout) -> tuple[list[int], FloatArray]:
        """None."""
        return [], np.empty(0)

    def completed(self, free: FreeParameters) -> FreeParameters:
        """As they are."""
        return free

    def balance(self, step: StepOrbit) -> list[float]:
        """Periodicity."""
        return [step.periodicity]


class Between:
    """A transition: the step begins as one gait has landed, and lands as another one does, in pose, slope and speed.

    Args:
        biped: the robot.
        before: the gait walked until now.
        after: the gait walked from the next impact on.

    Attributes:
        departure: the landing of the gait before.
        speed_after_impact: dbeta_r+ that it leaves [rad/s].
        speed_before_impact: dbeta_f- that the gait after lands with [rad/s].
    """

    def __init__(self, biped: FrontalBiped, before: Gait, after: Gait) -> None:
        self._before, self._after = before, after
        start = before.rising.motion(np.array([before.rising.beta_start]))
        landed = before.falling.motion(np.array([before.falling.beta_end]))
        end = after.falling.motion(np.array([after.falling.beta_end]))
        arrival = impact(biped, end.q[0], end.dq[0])
        self.departure = Departure(
            StepBegin(relabel(start.q[0]), start.dq[0, 1:]), impact(biped, landed.q[0], landed.dq[0])
        )
        self.speed_after_impact = before.orbit.beta_dot_after_impact
        self.speed_before_impact = after.orbit.beta_dot_after_impact / float(arrival.speed_ratio)
        self._q_minus = double_support_pose(biped, after.falling.beta_end, after.step_width)
        self._slope_minus = end.dq[0, 1:]

    def starts(self, layout: VariableLayout) -> tuple[FloatArray, ...]:
        """First gait, second gait, their mean."""
        first, second = layout.of(self._before), layout.of(self._after)
        return first, second, 0.5 * (first + second)

    def held(self, layout: VariableLayout) -> tuple[list[int], FloatArray]:
        """What the second gait's landing fixes."""
        which = [BETA_IMPACT, STEP_WIDTH, *layout.last_falling_column]
        return which, layout.of(self._after)[which]

    def completed(self, free: FreeParameters) -> FreeParameters:
        """The last free falling column where the final slope wants it."""
        M = free.falling_columns.shape[1] + 2
        column = self._q_minus[1:] - self._slope_minus * (free.beta_impact - free.beta_reversal) / M
        columns = np.concatenate([free.falling_columns[:, :-1], column[:, None]], axis=1)
        return replace(free, falling_columns=columns)

    def balance(self, step: StepOrbit) -> list[float]:
        """Squared speeds less what the gaits want, at the start and at the end."""
        ends = ((step.rising, self.speed_after_impact), (step.falling, self.speed_before_impact))
        return [2.0 * orbit.z[-1] / orbit.restricted.I_P[-1] ** 2 - speed**2 for orbit, speed in ends]
