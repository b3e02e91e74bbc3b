"""What a landing does to the foot that lands: its load in MuJoCo, millisecond by millisecond, with and without impact.

A rigid impact is an instant; in an engine whose contact gives way it is a spike and its ringing. A foot that arrives at
rest (`gait.support_gait`) is loaded as the double support has planned it.
"""

from dataclasses import dataclass

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import PhaseEvent
from frontal_biped.control.walker.walker import Walker
from frontal_biped.exceptions import SimulationError
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.support_gait import SupportGait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.mujoco.spec import contact_for
from frontal_biped.simulation.mujoco.walk import MujocoEngine
from frontal_biped.simulation.pushes import PushForces
from frontal_biped.simulation.support_walk import PERIOD, walk_from_lift_off
from frontal_biped.simulation.walking import start_state

BEFORE, AFTER = 0.01, 0.1
"""Time before and after a landing that is looked at [s]."""

LANDINGS = 3
"""The landing looked at: by then the start is forgotten."""

LONGEST = 5.0
"""A walk to that landing that lasts longer has failed [s]."""


@dataclass(frozen=True)
class LandingLoad:
    """Load of the foot that lands.

    Attributes:
        t: (n,) time since the landing [s].
        load: (n,) vertical force, over the weight [-].
    """

    t: FloatArray
    load: FloatArray

    @property
    def peak(self) -> float:
        """Largest load, over the weight [-]."""
        return float(self.load.max())

    @property
    def largest_jump(self) -> float:
        """Largest change from one control period to the next, over the weight [-]."""
        return float(np.abs(np.diff(self.load)).max())


def load_without_impact(biped: FrontalBiped, gait: SupportGait) -> LandingLoad:
    """A landing of a gait with a finite double support.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        SimulationError: the robot falls before.
    """
    run = walk_from_lift_off(biped, gait, steps=LANDINGS, engine="mujoco")
    if run.fell:
        raise SimulationError(f"{biped.name} fell before landing {LANDINGS}: {run.outcome}; try another gait")
    # the first stance foot is the left one
    foot = LANDINGS % 2
    return _around(run.trajectory.t, run.loads[:, foot], run.steps[LANDINGS - 1].landing, biped.weight)


def load_with_impact(biped: FrontalBiped, gait: Gait) -> LandingLoad:
    """A landing of a gait with impacts, walked by a `Walker`.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        SimulationError: the robot falls before.
    """
    engine, walker = MujocoEngine(biped, None, contact_for(PERIOD, None, None), PERIOD), Walker(biped, gait)
    start, pushes = start_state(gait), PushForces(())
    engine.place(Stance.LEFT, start)
    walker.reset(Stance.LEFT, *start)
    t, loads, landed = [], [], np.inf
    for tick in range(round(LONGEST / PERIOD)):
        now = tick * PERIOD
        command = walker.tick(engine.read(now))
        if command.event is PhaseEvent.LANDING and walker.landings == LANDINGS:
            landed = now
        fell = engine.advance(now, now + PERIOD, command.joint_torques, pushes).fell
        t.append(now)
        loads.append([engine.load(side).force_z for side in Stance])
        if fell is not None:
            break
        if now > landed + AFTER:
            return _around(np.array(t), np.array(loads)[:, LANDINGS % 2], landed, biped.weight)
    raise SimulationError(f"{biped.name} did not get to landing {LANDINGS} in MuJoCo; try another gait")


def _around(t: FloatArray, load: FloatArray, landing: float, weight: float) -> LandingLoad:
    inside = (t >= landing - BEFORE) & (t <= landing + AFTER)
    return LandingLoad(t[inside] - landing, load[inside] / weight)
