"""The energy of the steps of a walk in space, read from its states: what the closed form says of every sample."""

from dataclasses import dataclass

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.virtual_constraints.phase import StepPhase
from frontal_biped.zero_dynamics.frontal_energy import FrontalEnergy


@dataclass(frozen=True, eq=False)
class StepEnergies:
    """`FrontalEnergyReading` of every sample of a walk.

    Attributes:
        t: (T,) time [s].
        beta: (T,) virtual stance ankle angle [rad].
        dbeta: (T,) [rad/s].
        zeta: (T,) of the whole robot, about the FRI target of the gait [kg^2 m^4/s^2].
        energy: (T,) of the step; nan where the closed form says nothing [kg^2 m^4/s^2].
        error: (T,) of that, relative to the orbit's [-].
        barrier_margin: (T,) energy that may be added before the robot tips outwards, over the orbit's [-].
        orbit: energy of the orbit's step [kg^2 m^4/s^2].
    """

    t: FloatArray
    beta: FloatArray
    dbeta: FloatArray
    zeta: FloatArray
    energy: FloatArray
    error: FloatArray
    barrier_margin: FloatArray
    orbit: float


def frontal_energy(biped: FrontalBiped, gait: Gait) -> FrontalEnergy:
    """The reader of a gait's energy, its rising phase continued to the barrier as `ReanchoringTransitions` does.

    Raises:
        ReversalError: the zero dynamics is not defined where a phase begins, or stops before the impact.
    """
    rising = ReanchoringTransitions(biped, gait).planned_rising
    return FrontalEnergy(biped, rising, gait.falling, gait.speed_after_impact)


def step_energies(biped: FrontalBiped, gait: Gait, run: SpatialRun) -> StepEnergies:
    """Read every sample of a walk in space.

    Args:
        biped: the robot.
        gait: that was walked.
        run: the walk; its heading is taken from the stance sole.

    Raises:
        ReversalError: the zero dynamics is not defined where a phase begins, or stops before the impact.
    """
    energy = frontal_energy(biped, gait)
    space = SpaceState(FreeRobot(biped.robot))
    rows = []
    for q, v, yaws, sign, phase in zip(run.q, run.v, run.sole_yaw, run.stance, run.phase, strict=True):
        stance = Stance.of_sign(float(sign))
        space.at(q, v, float(yaws[0 if stance is Stance.LEFT else 1]))
        read = energy.in_space(space, stance, StepPhase.of_sign(float(phase)))
        rows.append((read.beta, read.dbeta, read.zeta, read.energy, read.error, read.barrier_margin))
    beta, dbeta, zeta, found, error, margin = np.array(rows).reshape(-1, 6).T
    return StepEnergies(run.t, beta, dbeta, zeta, found, error, margin, energy.orbit)
