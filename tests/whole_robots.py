"""Robots in space with their gaits, and states of them: the gait's own, and far from it."""

from functools import cache
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.control.controller import QpController
from frontal_biped.control.torques.linearisation import Targets
from frontal_biped.control.whole_body.targets import WholeBodyTargets
from frontal_biped.gait.file import load_gait
from frontal_biped.gait.gait import Gait
from frontal_biped.model import FrontalBiped, Stance, load_robot
from frontal_biped.model.space.free_robot import BASE, FreeRobot

BEYOND = 0.05
"""How far outside its range a joint of an adversarial state may be [rad]."""


class Whole(NamedTuple):
    """A robot: its plane, all of it, what it walks."""

    biped: FrontalBiped
    free: FreeRobot
    gait: Gait

    @property
    def still(self):
        return np.zeros(self.free.model.nv)

    @property
    def joints(self):
        return self.free.posture[BASE + 1 :].copy()

    def planar(self, settings=None):
        return QpController(self.biped, self.gait, settings)

    def standing(self, stance=Stance.LEFT, p_fri=0.0, cop_x=0.0, **others):
        """Targets that ask for no motion: outputs and swing foot without acceleration."""
        frontal = Targets(np.zeros(3), np.zeros(3), np.zeros(3), p_fri)
        return WholeBodyTargets(stance, frontal, cop_x, 0.0, self.joints, **others)


@cache
def whole(name):
    """A robot in space and its gait, by name; read-only."""
    biped = load_robot(name)
    return Whole(biped, FreeRobot(biped.robot), load_gait(biped.path.with_name(f"{name}.gait.json")))


def adversarial(robot, count, seed):
    """Postures, speeds and targets far from any walk: (q, v, targets)."""
    rng, model, limits = np.random.default_rng(seed), robot.free.model, robot.free.limits
    joints = model.nv - BASE
    for _ in range(count):
        s, fast = rng.uniform(), rng.choice([0.1, 1.0, 5.0])
        shift = s * rng.normal(size=model.nv) * np.concatenate([np.full(BASE, 0.1), np.full(joints, 0.5)])
        q = pin.integrate(model, robot.free.posture, shift)
        q[BASE + 1 :] = np.clip(q[BASE + 1 :], limits.lower - BEYOND, limits.upper + BEYOND)
        v = s * fast * rng.normal(size=model.nv)
        outer, inner = robot.biped.sole
        frontal = Targets(
            rng.normal(size=3), s * rng.normal(size=3), 30.0 * s * rng.normal(size=3), rng.uniform(outer, inner)
        )
        asked = robot.joints + 0.2 * s * rng.normal(size=joints)
        softness = rng.choice([0.15, 1.0])
        yield (
            q,
            v,
            WholeBodyTargets(
                Stance(rng.choice(["left", "right"])),
                frontal,
                0.1 * rng.normal(),
                20.0 * s * rng.normal(),
                asked,
                softness,
            ),
        )
