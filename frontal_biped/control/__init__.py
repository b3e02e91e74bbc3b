"""Control: the quadratic program of the walking robot and the controllers around it."""

from frontal_biped.control.controller import Command, QpController
from frontal_biped.control.settings import ControllerSettings
from frontal_biped.control.stabilisers.by_name import STABILISERS, make_stabiliser
from frontal_biped.control.stabilisers.transitions import FixedTransitions, ReanchoringTransitions, Stabiliser
from frontal_biped.control.torques.limits import ContactLimits, JointLimits, WalkingLimits
from frontal_biped.control.torques.linearisation import Targets
from frontal_biped.control.torques.torque_program import Source
from frontal_biped.control.torques.walking_qp import WalkingQp

__all__ = [
    "STABILISERS",
    "Command",
    "ContactLimits",
    "ControllerSettings",
    "FixedTransitions",
    "JointLimits",
    "QpController",
    "ReanchoringTransitions",
    "Source",
    "Stabiliser",
    "Targets",
    "WalkingLimits",
    "WalkingQp",
    "make_stabiliser",
]
