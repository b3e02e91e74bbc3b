"""Parts of `SpatialWalker` taken out or put in by something simpler, for `benchmark_space_ablations.py`."""

from dataclasses import replace

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.control.controller import SHIFT_ROOM, QpController
from frontal_biped.control.frontal_law import FrontalTargets
from frontal_biped.control.interface import PhaseEvent
from frontal_biped.control.settings import ControllerSettings
from frontal_biped.control.spatial_walker.walker import SpatialWalker
from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions
from frontal_biped.control.torques.linearisation import StanceModel
from frontal_biped.control.walker.energy_law import EnergyLaw, EnergySettings
from frontal_biped.control.whole_body.targets import WholeBodySolution, WholeBodyTargets
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import LENGTH, PITCH, FrontalCoordinates, SpaceState, X
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.model.sway import Sway
from frontal_biped.virtual_constraints.phase import StepPhase

NEWTON_STEPS = 2
"""Of the joints' references at a tick; they start where the last tick's ended."""

PLANAR_FORCES = 3
"""F_h, F_v and N_0 come before the torques in `linearisation.Motion`."""


def roll_columns(free: FreeRobot, biped: FrontalBiped) -> list[int]:
    """Indices, among the joints, of the planar model's four, in its order."""
    return [free.joint_names.index(name) for name in biped.stance_map.joint_names]


class RollJointState(SpaceState):
    """The frontal plane as the encoders of the roll joints tell it, not as it is seen from the front.

    Args:
        free: the robot.
        biped: the same in the plane.
    """

    def __init__(self, free: FreeRobot, biped: FrontalBiped) -> None:
        self._stance_map, self._roll_joints = biped.stance_map, roll_columns(free, biped)
        self._selected = np.zeros((free.model.nv, 4))
        self._selected[BASE + np.array(self._roll_joints), np.arange(4)] = 1.0
        super().__init__(free)

    def frontal(self, stance: Stance) -> FrontalCoordinates:
        """The roll joints in stance coordinates; beta that of the virtual leg."""
        to_stance = self._stance_map
        joints = FrontalCoordinates(
            to_stance.positions_to_stance(self.q[BASE + 1 :][self._roll_joints], stance),
            to_stance.velocities_to_stance(self.v[BASE:][self._roll_joints], stance),
            to_stance.velocities_to_stance(self._selected, stance).T,
            np.zeros(4),
        )
        for own, seen in zip(vars(joints).values(), vars(super().frontal(stance)).values(), strict=True):
            own[0] = seen[0]
        return joints


class AnkleLaw:
    """In the place of `FrontalLaw`: the paper's phase variable, beta, and the energy law of the planar `Walker`.

    Args:
        walker: whose law it replaces.
    """

    def __init__(self, walker: SpatialWalker) -> None:
        own = walker.frontal
        self.settings, self.orbit, self._period = own.settings, own.orbit, walker.period
        biped, gait = walker.biped, walker.gait
        limits = replace(ControllerSettings.for_gait(gait), frequency=walker.settings.output)
        stabiliser = ReanchoringTransitions(biped, gait, anticipate=False, rejoin=False)
        self.controller = QpController(biped, gait, limits, stabiliser)
        self._energy = EnergyLaw(biped, gait, walker.period, own.settings.energy or EnergySettings())
        self._room = tuple(SHIFT_ROOM * end for end in biped.sole)
        self.offset = own.offset
        self.reset(Stance.LEFT)

    def reset(self, stance: Stance) -> None:
        """Start right after an impact."""
        self._energy.reset(stance)
        self.mid_fall, self._until_settled, self._begun = float("nan"), np.inf, False

    def land(self, stance: Stance, sway: Sway, state: State) -> None:
        """A foot has landed."""
        self._energy.land(stance)
        self._begin(StepPhase.RISING, *state)
        self._until_settled = self.settings.settle or np.inf

    def at(
        self,
        phase: StepPhase,
        state: State,
        sway: Sway,
        event: PhaseEvent | None,
        unexplained: float,
    ) -> FrontalTargets:
        """Targets at a state, over beta; what the model does not explain is left out."""
        q, dq = state.q.copy(), state.dq.copy()
        self._until_settled -= self._period
        turned = event is PhaseEvent.REVERSAL or event is PhaseEvent.TURNED_OUTWARDS
        if turned or not self._begun or (self._until_settled <= 0.0 and phase is StepPhase.RISING):
            self._begin(phase, q, dq)
        targets, y, dy = self.controller.targets(phase, State(q, dq))
        shift = self._energy.fri_shift(phase, q, float(dq[0]), np.zeros(4))
        p_fri = min(max(targets.p_fri + shift, self._room[0]), self._room[1])
        return FrontalTargets(targets._replace(p_fri=p_fri), y, dy, targets.line())

    def _begin(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> None:
        self.controller.begin(phase, q, dq)
        self._begun, self._until_settled = True, np.inf


class JointPd:
    """In the place of the whole-body program: planar torques for the roll joints, PD for all others.

    The planar torques are those of the planar robot at the frontal state, for the outputs over beta and the FRI of
    `AnkleLaw`, which the walker has to follow. The references
    of the other leg joints come from inverse kinematics at the roll joints' angles: both virtual legs at their lengths,
    pelvis and feet not pitched nor yawed, the swing foot on its path, the pelvis on the pendulum's orbit.

    Args:
        walker: whose program it replaces.
        stiffness: of the other joints [N m/rad].
        damping: of them [N m s/rad].
    """

    def __init__(self, walker: SpatialWalker, stiffness: float, damping: float) -> None:
        self.walker, self.stiffness, self.damping = walker, stiffness, damping
        free, biped = walker.free, walker.biped
        self.free, self.biped = free, biped
        self._planar, self._seen = StanceModel(biped), SpaceState(free)
        self._roll = roll_columns(free, biped)
        self._legs = [j for side in Stance for j in free.leg(side) if j not in self._roll]
        self._unknown = [*range(BASE), *(BASE + j for j in self._legs)]
        self._ahead = free.posture[X]
        self.counts: dict[str, int] = {}
        self.reset()

    def reset(self) -> None:
        """Forget the references."""
        self._reference: FloatArray | None = None

    def solve(self, state: SpaceState, targets: WholeBodyTargets) -> WholeBodySolution:
        """Torques at a state, and what they do while the stance foot stands."""
        stance, effort = targets.stance, self.free.limits.effort
        seen = state.frontal(stance)
        last = state.q[BASE + 1 :] if self._reference is None else self._reference
        reference = self._inverse_kinematics(state, stance, last, seen)
        rates = np.zeros(len(last)) if self._reference is None else (reference - last) / self.walker.period
        self._reference = reference
        tau = self.stiffness * (reference - state.q[BASE + 1 :]) + self.damping * (rates - state.v[BASE:])
        motion = self._planar.at(State(seen.q, seen.dq)).linearising(targets.frontal)
        u = np.zeros(4) if motion is None else motion.forces[PLANAR_FORCES:]
        tau[self._roll] = self.biped.stance_map.torques_to_urdf(u, stance)
        tau = np.clip(tau, -effort, effort)

        nv, foot = len(state.v), state.feet[stance]
        K = np.block([[state.M, -foot.J.T], [foot.J, np.zeros((6, 6))]])
        x = np.linalg.solve(K, np.concatenate([np.concatenate([np.zeros(BASE), tau]) - state.bias, -foot.drift]))
        return WholeBodySolution(tau, x[:nv], x[nv:], True)

    def _inverse_kinematics(
        self, state: SpaceState, stance: Stance, joints: FloatArray, frontal: FrontalCoordinates
    ) -> FloatArray:
        """(n,) references: legs by Newton's method, everything else at the posture, roll joints where they are."""
        walker, law, still = self.walker, self.walker.sagittal, np.zeros(len(state.v))
        left = walker.left
        half = 0.5 * law.omega * law.duration
        swayed = np.sinh(half - law.omega * min(left, law.duration)) / np.sinh(half)
        ahead = self._ahead + 0.5 * walker.speed * law.duration * float(swayed)
        q = self.free.posture.copy()
        q[: BASE + 1] = state.q[: BASE + 1]
        q[BASE + 1 + np.array(self._legs)] = joints[self._legs]
        q[BASE + 1 + np.array(self._roll)] = state.q[BASE + 1 :][self._roll]
        foothold = state.feet[stance].position.copy()
        root = np.zeros((1, len(still)))
        for _ in range(NEWTON_STEPS):
            at = self._seen.at(q, still)
            stands, swings = at.feet[stance], at.feet[stance.other]
            root[0, :3] = pin.Quaternion(q[3:7]).matrix()[X]
            error = np.concatenate(
                [
                    stands.position - foothold,
                    stands.turning.angles,
                    [at.legs[side].values[LENGTH] - at.lengths[side] for side in Stance],
                    at.pelvis.angles[PITCH:],
                    [swings.position[X] - walker.swing.x],
                    swings.turning.angles[PITCH:],
                    [q[X] - foothold[X] - ahead],
                ]
            )
            J = np.vstack(
                [
                    stands.J[:3],
                    stands.turning.J,
                    *(at.legs[side].J[LENGTH] for side in Stance),
                    at.pelvis.J[PITCH:],
                    swings.J[X],
                    swings.turning.J[PITCH:],
                    root,
                ]
            )
            step = np.zeros(len(still))
            step[self._unknown] = -np.linalg.solve(J[:, self._unknown], error)
            q = pin.integrate(self.free.model, q, np.clip(step, -0.1, 0.1))
        return q[BASE + 1 :]
