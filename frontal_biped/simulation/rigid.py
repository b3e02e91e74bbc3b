"""Walk in the event-driven simulator under a walker that sees sensor readings only.

Impacts are rigid and located, as in `simulate_walk`; the walker learns of them from the contact flags at its next tick.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Tickable
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.perturbation import ModelErrors, Plant
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.hybrid_system import EventKind, Guard, land, walking_guards
from frontal_biped.simulation.loop import PERIOD, SensedLoop
from frontal_biped.simulation.pushes import PelvisForce, PushForces, along_h
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.stance_motion import StanceMotion
from frontal_biped.simulation.trajectory import Trajectory


def walk_sensed(
    plant: FrontalBiped,
    walker: Tickable,
    q0: FloatArray,
    dq0: FloatArray,
    settings: SimulationSettings | None = None,
    *,
    errors: ModelErrors | None = None,
    stance: Stance = Stance.LEFT,
    on_step: Callable[[int], None] | None = None,
    gait: Mapping[str, Any] | None = None,
) -> Trajectory:
    """Walk from a state right after an impact; arguments and answer as those of `walk_in_mujoco`."""
    chosen = settings or SimulationSettings()
    engine = _RigidEngine(plant, errors, chosen)
    return SensedLoop(engine, plant, walker, chosen, errors).run(q0, dq0, stance, on_step, gait)


class _RigidEngine:
    """The hybrid system, one control period at a time, spoken to through joints and contact flags."""

    name = "ours"

    def __init__(self, biped: FrontalBiped, errors: ModelErrors | None, settings: SimulationSettings) -> None:
        self.biped, self.settings = biped, settings
        self.period = settings.period or PERIOD
        self.plant = Plant.of(biped, errors)
        self._motion = {side: StanceMotion(self.plant.on(side), PelvisForce(self.plant.on(side))) for side in Stance}
        self._ground = dict.fromkeys(Stance, 0.0)
        self._next_ground = dict.fromkeys(Stance, 0.0)

    def place(self, stance: Stance, q: FloatArray, dq: FloatArray, foot_y: float) -> None:
        self.stance, self.state, self.foot_y = stance, np.concatenate([q, dq]), {stance: foot_y}
        self._rising = True
        self._guard()

    def _guard(self) -> None:
        here, swing = self._ground[self.stance], self.stance.other
        guards = walking_guards(self.plant.on(self.stance), self._ground[swing] - here, self._next_ground[swing] - here)
        self._guards: tuple[Guard, ...] = guards.rising if self._rising else guards.falling

    def read(self) -> tuple[FloatArray, FloatArray, float, float, tuple[bool, bool]]:
        coordinates, stance = self.biped.stance_map, self.stance
        q, dq = self.state[:4], self.state[4:]
        outwards = -1.0 if stance is Stance.LEFT else 1.0
        contact = (stance is Stance.LEFT, stance is Stance.RIGHT)
        return (
            coordinates.positions_to_urdf(q, stance),
            coordinates.velocities_to_urdf(dq, stance),
            outwards * float(self.biped.pelvis_roll(q)),
            outwards * float(dq[0] + dq[1]),
            contact,
        )

    def stance_state(self, stance: Stance) -> tuple[FloatArray, FloatArray]:
        step = 1 if stance is self.stance else -1
        return self.state[:4][::step].copy(), self.state[4:][::step].copy()

    def reaction(self, stance: Stance) -> tuple[float, float, float]:
        if stance is not self.stance:
            return 0.0, 0.0, float("nan")
        motion, q, dq = self._motion[stance], self.state[:4], self.state[4:]
        biped = motion.biped
        wrench = biped.inverse_dynamics(q, dq, biped.forward_dynamics(q, dq, motion.felt(q)))
        for force, height in motion.pushes:  # the ground carries what the push does not
            wrench[0] -= force
            wrench[2] += force * motion.pelvis.height(q, height)
        return float(wrench[0]), float(wrench[1]), float(wrench[2] / wrench[1])

    def foot_position(self, stance: Stance) -> tuple[float, float]:
        outwards = -1.0 if self.stance is Stance.LEFT else 1.0
        if stance is self.stance:
            return self.foot_y[stance], 0.0
        q = self.state[:4]
        distance = float(self.plant.on(self.stance).joint_positions(q)[3, 0])
        return self.foot_y[self.stance] + outwards * distance, outwards * float(self.biped.swing_foot_rotation(q))

    def raise_ground(self, stance: Stance, height: float) -> None:
        self._next_ground[stance] = height
        self._guard()

    def advance(self, t: float, tau: FloatArray, pushes: PushForces) -> EventKind | str | None:
        left = self.period
        while left > 0.0:
            motion = self._motion[self.stance]
            motion.u = self.biped.stance_map.torques_to_stance(tau, self.stance)
            motion.pushes = [(along_h(force, self.stance), height) for force, height in pushes.at(t)]
            if motion.friction_used(self.state) > (self.settings.disturbances.friction or np.inf):
                return EventKind.SLIPPED
            before = [guard.function(self.state[:4], self.state[4:]) for guard in self._guards]
            x = motion.advance(self.state, left)
            after = [guard.function(x[:4], x[4:]) for guard in self._guards]
            hit = motion.first_crossing(self.state, left, self._guards, before, after)
            if hit is None:
                self.state = x
                return None
            elapsed, kind = hit
            self.state = motion.advance(self.state, elapsed)
            left -= elapsed
            if kind in (EventKind.REVERSAL, EventKind.TURNED_OUTWARDS):
                self._rising = kind is EventKind.TURNED_OUTWARDS
                self._guard()
            elif kind is EventKind.IMPACT:
                fate = self._land()
                if fate is not None:
                    return fate
            else:
                return kind
        return None

    def _land(self) -> EventKind | None:
        swing = self.stance.other
        landing = land(self.plant.on(self.stance), self.state[:4], self.state[4:], self.settings.flat_landing)
        if landing is None:
            return EventKind.EDGE_LANDING
        if landing.friction_used > (self.settings.disturbances.friction or np.inf):
            return EventKind.SLIPPED
        self.foot_y = {swing: self.foot_position(swing)[0]}
        self.state = np.concatenate([landing.q_plus, landing.dq_plus])
        self._ground[swing] = self._next_ground[swing]
        self.stance, self._rising = swing, True
        self._guard()
        return None
