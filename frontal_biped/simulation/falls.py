"""What made a robot fall, and what to change: the key of the gait's specification that governs it."""

from dataclasses import asdict

from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.loop import TIMED_OUT

# way to fall: key, the value to try where the specification leaves it free, and the factor by which one is changed
_GOVERNED: dict[str, tuple[str, float, float]] = {
    EventKind.EDGE_LANDING.value: ("max_foot_rotation", 0.05, 0.5),
    EventKind.EARLY_LANDING.value: ("swing_clearance", 0.02, 2.0),
    EventKind.TIPPED_OUTWARDS.value: ("min_energy_margin", 1.0, 2.0),
    EventKind.TURNED_OUTWARDS.value: ("min_energy_margin", 1.0, 2.0),
    EventKind.SLIPPED.value: ("friction", 0.5, 0.7),
    EventKind.COLLAPSED.value: ("fri_margin", 0.01, 2.0),
    TIMED_OUT: ("max_reversal_shift", 0.003, 0.5),
}


def fall_remedy(outcome: str, specification: GaitSpecification) -> str | None:
    """What to change against a fall, in words; None where no key of the specification governs it.

    Args:
        outcome: of the run.
        specification: what its gait was designed for.
    """
    if outcome not in _GOVERNED:
        return None
    key, first, factor = _GOVERNED[outcome]
    present = asdict(specification)[key]
    if present is None:
        return f"ask for {key} = {first:g}, which is free now, and design again"
    new = min(first, present * factor) if factor < 1.0 else max(first, present * factor)
    return f"ask for {key} = {new:.2g} in place of {present:.2g}, and design again"
