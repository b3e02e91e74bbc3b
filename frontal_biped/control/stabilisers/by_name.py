"""Every stabiliser by name."""

from collections.abc import Callable, Sequence

from frontal_biped.control.stabilisers.ankle_law import AnkleLaw
from frontal_biped.control.stabilisers.look_ahead import LookAheadTransitions
from frontal_biped.control.stabilisers.step_law import StepLaw, StepRule
from frontal_biped.control.stabilisers.transitions import FixedTransitions, ReanchoringTransitions, Stabiliser
from frontal_biped.exceptions import SimulationError
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.planned_step import PlannedStep
from frontal_biped.model.biped import FrontalBiped

STABILISERS: dict[str, Callable[[FrontalBiped, Gait], Stabiliser]] = {
    "fixed": lambda biped, gait: FixedTransitions(gait),
    "re-anchored": lambda biped, gait: ReanchoringTransitions(biped, gait, anticipate=False),
    "adaptive": LookAheadTransitions,
    "ankle": AnkleLaw,
    "step": StepLaw,
    "step-lqr": lambda biped, gait: StepLaw(biped, gait, rule=StepRule.LQR),
    "ankle+step": lambda biped, gait: StepLaw(biped, gait, ankle=AnkleLaw(biped, gait)),
}
"""The paper's transitions; plain re-anchoring; re-anchoring that looks ahead; and each law on top of re-anchoring."""


def make_stabiliser(name: str, biped: FrontalBiped, gait: Gait) -> Stabiliser:
    """A stabiliser by name.

    Raises:
        SimulationError: the name is unknown.
    """
    if name not in STABILISERS:
        raise SimulationError(f"no stabiliser {name!r}; known: {', '.join(STABILISERS)}")
    return STABILISERS[name](biped, gait)


IN_TURN: dict[str, Callable[[FrontalBiped, PlannedStep], Stabiliser]] = {
    "fixed": lambda biped, step: FixedTransitions(step),
    "re-anchored": lambda biped, step: ReanchoringTransitions(biped, step, anticipate=False),
}
"""Those that ask no more of a step than its phases: the others look ahead to the same step again."""


def make_stabilisers(
    name: Stabiliser | str, biped: FrontalBiped, steps: Sequence[PlannedStep]
) -> tuple[Stabiliser, ...]:
    """A stabiliser by name for each of several steps in turn.

    Raises:
        SimulationError: the name is unknown or not of one that suits steps in turn.
    """
    if not isinstance(name, str) or name not in IN_TURN:
        shown = repr(name) if isinstance(name, str) else type(name).__name__
        raise SimulationError(f"no stabiliser {shown} for two steps in turn; known: {', '.join(IN_TURN)}")
    return tuple(IN_TURN[name](biped, step) for step in steps)
