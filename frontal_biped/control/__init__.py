"""Control: the quadratic program of the walking robot and the controller around it."""

from frontal_biped.control.controller import Command, ControllerSettings, QpController
from frontal_biped.control.stabilisers import STABILISERS, make_stabiliser
from frontal_biped.control.transitions import AdaptiveTransitions, FixedTransitions, Stabiliser
from frontal_biped.control.walking_qp import ContactLimits, Targets, WalkingQp

__all__ = [
    "STABILISERS",
    "AdaptiveTransitions",
    "Command",
    "ContactLimits",
    "ControllerSettings",
    "FixedTransitions",
    "QpController",
    "Stabiliser",
    "Targets",
    "WalkingQp",
    "make_stabiliser",
]
