"""What the whole body is asked for at one tick."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.torques.linearisation import Targets
from frontal_biped.model.stance_map import Stance


class LegLength(NamedTuple):
    """How the length of a virtual leg is to differ from the posture's.

    Attributes:
        offset: [m].
        rate: [m/s].
        acceleration: [m/s^2].
    """

    offset: float = 0.0
    rate: float = 0.0
    acceleration: float = 0.0


KEPT = LegLength()


class Yaw(NamedTuple):
    """Where something is to look, from the heading.

    Attributes:
        angle: [rad].
        rate: [rad/s].
        acceleration: [rad/s^2].
    """

    angle: float = 0.0
    rate: float = 0.0
    acceleration: float = 0.0


STRAIGHT = Yaw()


@dataclass(frozen=True)
class WholeBodyTargets:
    """Targets of one tick, in the heading frame.

    Attributes:
        stance: the stance foot.
        frontal: the paper's outputs and FRI target.
        cop_x: wanted centre of pressure ahead of the stance ankle [m].
        swing_acceleration: of the swing sole forwards, feedback included [m/s^2].
        joints: (n,) where every joint that is not in a leg is to be [rad].
        softness: 1 as the settings say; below, all feedback is reduced by this factor, as after a landing [-].
        stance_length: of the stance leg.
        swing_length: of the swing leg.
        pelvis_yaw: where the pelvis looks.
        swing_yaw: where the swing foot looks.
    """

    stance: Stance
    frontal: Targets
    cop_x: float
    swing_acceleration: float
    joints: FloatArray
    softness: float = 1.0
    stance_length: LegLength = KEPT
    swing_length: LegLength = KEPT
    pelvis_yaw: Yaw = STRAIGHT
    swing_yaw: Yaw = STRAIGHT


@dataclass(frozen=True)
class WholeBodySolution:
    """Answer of the program.

    Attributes:
        tau: (n,) joint torques [N m].
        dv: (nv,) accelerations expected [rad/s^2 or m/s^2].
        wrench: (6,) on the stance sole, about the origin of its frame, in the heading frame [N, N m].
        solved: every limit kept, to the solver's accuracy?
        given_way: what gave way, "" for none.
    """

    tau: FloatArray
    dv: FloatArray
    wrench: FloatArray
    solved: bool
    given_way: str = ""


NOTHING = WholeBodySolution(np.zeros(0), np.zeros(0), np.zeros(6), False, "never solved")
