"""How far the planar impact is from the landing of the robot in space, where no motor holds a joint for an impulse.

The planar map holds every joint but the four roll joints rigidly. In space only reflected rotor inertia holds them:
with none of it, knees and hips give way and the landing is far softer; as it grows on the held joints, the landing
tends to the planar map (`model.space.landing`). With virtual legs it tends to another one: there the held joints turn
before the landing too, and large rotors keep their rates. A gait is landed at the end of its falling phase, standing on
the left foot.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.impact import impact
from frontal_biped.model.robot import Soles
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.landing import SpatialLanding, land
from frontal_biped.model.space.plane_masses import F_V, S_V, PlaneMasses
from frontal_biped.model.space.virtual_legs import LENGTH, PITCH, YAW, SpaceState
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.space.start import start_in_space

STANCE = Stance.LEFT
"""The foot that stands before the landing; of the right one the figures differ as much as the legs do."""

SWEPT = tuple(float(a) for a in np.geomspace(1e-3, 1e3, 37))
"""Rotor inertias of the held joints for a figure [kg m^2]: small motors, gears of 100, and nearly rigid."""

JUMPS = 4
"""Joints that are named."""


@dataclass(frozen=True)
class Landed:
    """One landing.

    Attributes:
        rotors: reflected inertia of the joints that the plane holds [kg m^2]; None: as described; inf: held.
        vertical_impulse: on the landing foot [N s].
        energy_before: kinetic energy before it, rotors included [J].
        energy_after: after it [J].
        dbeta_after: rate of the virtual ankle of the new stance leg [rad/s].
        leg_rate: how fast the new stance leg grows longer, seen from the front [m/s]; 0 in the plane.
        pelvis_pitch_rate: of the pelvis [rad/s]; 0 in the plane.
        pelvis_yaw_rate: of the pelvis [rad/s]; 0 in the plane.
        cop: where the impulse acts, ahead of the ankle and towards the other foot [m].
        friction: coefficient that keeps the foot from slipping, its yaw moment aside [-].
        in_sole: does the impulse act inside the sole? Where it does not, the foot tips, and the landing is another.
    """

    rotors: float | None
    vertical_impulse: float
    energy_before: float
    energy_after: float
    dbeta_after: float
    leg_rate: float
    pelvis_pitch_rate: float
    pelvis_yaw_rate: float
    cop: tuple[float, float]
    friction: float
    in_sole: bool

    @property
    def energy_lost(self) -> float:
        """Kinetic energy before less that after [J]."""
        return self.energy_before - self.energy_after

    def as_dict(self) -> dict[str, Any]:
        """For JSON, which knows no infinity."""
        rotors = "held" if self.rotors == np.inf else "as described" if self.rotors is None else self.rotors
        return {**vars(self), "rotors": rotors, "cop": list(self.cop)}


@dataclass(frozen=True)
class FreeLandingReport:
    """The landing of a gait in the plane and in space.

    Attributes:
        planar: the planar impact.
        described: in space, with the rotor inertia of the description.
        bare: without rotor inertia on any joint.
        jumps: of the rates of those joints that the plane holds and the landing turns most, as described [rad/s].
        swept: with the roll joints as described, over the rotor inertia of all others.
    """

    planar: Landed
    described: Landed
    bare: Landed
    jumps: dict[str, float]
    swept: tuple[Landed, ...]

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        landings = {name: getattr(self, name).as_dict() for name in ("planar", "described", "bare")}
        return {**landings, "jumps": self.jumps, "swept": [landed.as_dict() for landed in self.swept]}

    def __str__(self) -> str:
        landings = self.planar, self.described, self.bare
        rows = [("landing with every joint free", ["planar", "as described", "no rotors"])]
        for name, key in _ROWS.items():
            values = [getattr(landed, key) for landed in landings]
            rows.append((name, [f"{value if abs(value) > ROUNDING else 0.0:.4g}" for value in values]))
        rows.append(("impulse acts ahead of the ankle [m]", [f"{landed.cop[0]:.3f}" for landed in landings]))
        rows.append(("  and inside of it [m]", [f"{landed.cop[1]:.3f}" for landed in landings]))
        if not all(landed.in_sole for landed in landings):
            marks = ["" if landed.in_sole else "outside" for landed in landings]
            rows.append(("  of the sole, so that the foot tips", marks))
        jumps = ", ".join(f"{name} {jump:+.2f}" for name, jump in self.jumps.items())
        lines = [f"{name:43} " + " ".join(f"{value:>14}" for value in values) for name, values in rows]
        return "\n".join([*lines, f"{'largest jumps, as described [rad/s]':43} {jumps}"])


_ROWS = {
    "vertical impulse [N s]": "vertical_impulse",
    "kinetic energy before [J]": "energy_before",
    "kinetic energy after [J]": "energy_after",
    "  lost [J]": "energy_lost",
    "dbeta after [rad/s]": "dbeta_after",
    "new stance leg grows longer by [m/s]": "leg_rate",
    "pelvis pitch rate [rad/s]": "pelvis_pitch_rate",
    "pelvis yaw rate [rad/s]": "pelvis_yaw_rate",
    "friction used [-]": "friction",
}

ROUNDING = 1e-9
"""Below this a number is printed as zero."""


def free_landing(biped: FrontalBiped, gait: Gait, swept: tuple[float, ...] = SWEPT) -> FreeLandingReport:
    """Land a gait with every joint free.

    Args:
        biped: the robot.
        gait: the gait.
        swept: rotor inertias of the held joints [kg m^2].

    Raises:
        RobotError: a joint has more than one freedom, or the length of the soles is not known.
        SimulationError: the legs do not reach the pose.
    """
    falling = gait.step(biped).falling
    state = State(falling.motion.q[-1], falling.motion.dq[-1] * falling.dbeta[-1])
    robot = FreeRobot(biped.robot)
    before, after = SpaceState(robot), SpaceState(robot)
    start = start_in_space(robot, biped, state, STANCE, before)
    before.at(*start)
    rolls = np.isin(robot.joint_names, list(biped.description.joints.values()))

    def landed(armature: FloatArray, rotors: float | None) -> Landed:
        landing = land(before, STANCE.other, armature)
        return _landed(after.at(start.q, landing.v_plus), landing, rotors)

    def with_others(rotors: float) -> Landed:
        return landed(np.where(rolls, robot.armature, rotors), rotors)

    described = land(before, STANCE.other)
    jumps = np.where(rolls, 0.0, described.v_plus[BASE:] - start.v[BASE:])
    largest = np.argsort(-np.abs(jumps))[:JUMPS]
    return FreeLandingReport(
        planar=_planar(biped, state),
        described=_landed(after.at(start.q, described.v_plus), described, None),
        bare=landed(np.zeros(len(rolls)), 0.0),
        jumps={robot.joint_names[joint]: float(jumps[joint]) for joint in largest},
        swept=tuple(with_others(rotors) for rotors in swept),
    )


def _planar(biped: FrontalBiped, state: State) -> Landed:
    """The planar impact; how far ahead its impulse acts follows from the momentum of each mass weighted by its x."""
    landing, side = impact(biped, *state), STANCE.other
    old, new = PlaneMasses.of(biped, STANCE), PlaneMasses.of(biped, side)
    rest = np.zeros((1, 4))
    before, after = (
        robot.along(q[None], dq[None], rest).A[[F_V, S_V], 0] for robot, (q, dq) in ((old, state), (new, landing.state))
    )
    before[1] -= old.swing_ahead * before[0]
    lifted, weighted = after - before
    energies = (0.5 * float(dq @ biped.D(q) @ dq) for q, dq in (state, landing.state))
    x, inwards = float(weighted / lifted), -landing.center_of_pressure
    return Landed(
        rotors=np.inf,
        vertical_impulse=float(landing.impulse[1]),
        energy_before=next(energies),
        energy_after=next(energies),
        dbeta_after=float(landing.dq_plus[0]),
        leg_rate=0.0,
        pelvis_pitch_rate=0.0,
        pelvis_yaw_rate=0.0,
        cop=(x, inwards),
        friction=landing.friction_used,
        in_sole=_contains(biped.robot.soles, x, inwards),
    )


def _landed(after: SpaceState, landing: SpatialLanding, rotors: float | None) -> Landed:
    """What is seen of a landing; ``after`` has its velocity."""
    side = STANCE.other
    x, y = landing.cop.tolist()
    inwards = -side.sign * y
    return Landed(
        rotors=rotors,
        vertical_impulse=float(landing.impulse[2]),
        energy_before=landing.energy_before,
        energy_after=landing.energy_after,
        dbeta_after=float(after.frontal(side).dq[0]),
        leg_rate=float(after.legs[side].rates[LENGTH]),
        pelvis_pitch_rate=float(after.pelvis.rates[PITCH]),
        pelvis_yaw_rate=float(after.pelvis.rates[YAW]),
        cop=(x, inwards),
        friction=landing.friction_used,
        in_sole=_contains(after.free.soles, x, inwards),
    )


def _contains(soles: Soles, x: float, inwards: float) -> bool:
    (sole,) = (sole for sole in soles if sole.side is STANCE.other)
    return -sole.back <= x <= sole.front and -sole.outer <= inwards <= sole.inner
