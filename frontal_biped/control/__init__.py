"""Control: the quadratic program of the walking robot and the controller around it."""

from frontal_biped.control.controller import Command, ControllerSettings, QpController
from frontal_biped.control.walking_qp import ContactLimits, Targets, WalkingQp

__all__ = ["Command", "ContactLimits", "ControllerSettings", "QpController", "Targets", "WalkingQp"]
