"""Control: the quadratic program of the walking robot and the controller around it."""

from frontal_biped.control.closed_form import Targets
from frontal_biped.control.controller import Command, QpController
from frontal_biped.control.limits import ContactLimits, JointLimits
from frontal_biped.control.settings import ControllerSettings
from frontal_biped.control.stabilisers import STABILISERS, make_stabiliser
from frontal_biped.control.torque_program import Source
from frontal_biped.control.transitions import AdaptiveTransitions, FixedTransitions, Stabiliser
from frontal_biped.control.walking_qp import WalkingQp

__all__ = [
    "STABILISERS",
    "AdaptiveTransitions",
    "Command",
    "ContactLimits",
    "ControllerSettings",
    "FixedTransitions",
    "JointLimits",
    "QpController",
    "Source",
    "Stabiliser",
    "Targets",
    "WalkingQp",
    "make_stabiliser",
]
