"""The walker's outputs over the sway of the centre of mass, as in space: `FrontalLaw` says what is wanted.

On gaits of least torque beta runs over 0.02 rad while the joints turn fifty times as fast, so that a phase anchored to
an estimate of it follows the noise of that estimate; the sway runs over centimetres.
"""

from frontal_biped.arrays import FloatArray
from frontal_biped.control.controller import Command, QpController
from frontal_biped.control.frontal_law import FrontalLaw
from frontal_biped.control.interface import PhaseEvent
from frontal_biped.control.torques.linearisation import F_V, N_0, StanceDynamics, StanceModel, over_sway
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.model.sway import Sway
from frontal_biped.virtual_constraints.phase import StepPhase


class OverSway:
    """Outputs over the sway.

    Args:
        biped: the robot as it is believed to be.
        controller: turns targets into torques.
        law: what is wanted.
    """

    def __init__(self, biped: FrontalBiped, controller: QpController, law: FrontalLaw) -> None:
        self._controller, self.law = controller, law
        self._stance_model, self._mass = StanceModel(biped), biped.mass
        # of the last tick: c of the line that it took, and its FRI target
        self._last: tuple[FloatArray, float] | None = None
        self._seen: tuple[State, StanceDynamics, Sway] | None = None

    def reset(self, stance: Stance) -> None:
        """Start right after an impact."""
        self._last = None
        self.law.reset(stance)

    def land(self, stance: Stance, state: State) -> None:
        """A foot has landed, with a state after the impact."""
        self._last = None
        self.law.land(stance, self._at(state)[1], state)

    def outwards(self, state: State) -> float:
        """Rate of the phase variable, positive where the robot sways outwards [m/s]."""
        return -self._at(state)[1].rate

    def command(self, phase: StepPhase, event: PhaseEvent | None, state: State, unexplained: FloatArray) -> Command:
        """Torques at a state.

        Args:
            phase: rising or falling.
            event: what was noticed in this tick, if anything.
            state: that the command is for.
            unexplained: (4,) acceleration that the model does not explain [rad/s^2].
        """
        dynamics, sway = self._at(state)
        error = 0.0
        if self._last is not None:
            # what the ankle's moment does not explain, along the virtual constraints: I_P x'' = moment
            c, p_fri = self._last
            along = c.dot(dynamics.M[BASE:])  # M is symmetric
            I_P = along.item(N_0) - p_fri * along.item(F_V)
            error = dynamics.M[BASE, BASE:].dot(unexplained).item() / I_P
        wanted = self.law.at(phase, state, sway, event, error)
        targets, y, dy, line = wanted
        over_sway(line, sway)
        self._last = line[1], targets.p_fri
        return self._controller.follow(phase, state, targets, y, dy, dynamics, line)

    def _at(self, state: State) -> tuple[StanceDynamics, Sway]:
        """Dynamics and sway; a tick asks twice for the same state."""
        if self._seen is None or self._seen[0] is not state:
            dynamics = self._stance_model.at(state)
            self._seen = state, dynamics, dynamics.sway(self._mass)
        return self._seen[1:]
