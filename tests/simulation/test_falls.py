"""Against every way to fall, what to change: a key that the specification has, towards what helps."""

import pytest

from frontal_biped.design.tightening import tightenings
from frontal_biped.gait import GaitSpecification
from frontal_biped.simulation.falls import GOVERNING, Remedy, fall_remedy, remedies
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.loop import TIMED_OUT, TOO_STIFF

FALLS = {kind.value for kind in EventKind} - {"reversal", "impact"} | {TIMED_OUT, TOO_STIFF}


@pytest.mark.parametrize("outcome", sorted(FALLS))
def test_every_fall_of_the_plane_names_a_key(outcome):
    key = fall_remedy(outcome, GaitSpecification()).split()[2]
    assert hasattr(GaitSpecification(), key)


@pytest.mark.parametrize(
    ("kind", "specification", "words"),
    [
        (EventKind.EDGE_LANDING, GaitSpecification(), "max_foot_rotation = 0.05, which is free now"),
        (EventKind.EDGE_LANDING, GaitSpecification(max_foot_rotation=0.3), "max_foot_rotation = 0.05 in place of 0.3"),
        (EventKind.EDGE_LANDING, GaitSpecification(max_foot_rotation=0.04), "max_foot_rotation = 0.02 in place of"),
        (EventKind.EARLY_LANDING, GaitSpecification(), "swing_clearance = 0.015 in place of 0.01,"),
        (EventKind.EARLY_LANDING, GaitSpecification(swing_clearance=0.03), "swing_clearance = 0.045 in place of 0.03"),
        (EventKind.EARLY_LANDING, GaitSpecification(swing_clearance=0.0), "swing_clearance = 0.01 in place of 0,"),
        (EventKind.TIPPED_OUTWARDS, GaitSpecification(), "fri_margin = 0.01 in place of 0.005"),
        (EventKind.COLLAPSED, GaitSpecification(fri_margin=0.01), "fri_margin = 0.02 in place of 0.01"),
        (EventKind.SLIPPED, GaitSpecification(friction=0.6), "friction = 0.42 in place of 0.6"),
        # level as it can be: the next that governs it
        (EventKind.EDGE_LANDING, GaitSpecification(max_foot_rotation=0.02), "swing_clearance = 0.015 in place of"),
    ],
)
def test_the_value_goes_where_it_helps(kind, specification, words):
    assert words in fall_remedy(kind.value, specification)


def test_what_no_key_governs_gets_no_advice():
    assert fall_remedy("completed", GaitSpecification()) is None
    assert fall_remedy("MuJoCo's state is no longer finite", GaitSpecification()) is None


@pytest.mark.parametrize("outcome", sorted(GOVERNING))
def test_the_advice_is_what_design_would_try_first(outcome):
    spec = GaitSpecification()
    first = next(remedies(spec, outcome, Remedy))
    assert first.of(spec) != spec
    assert f"ask for {first.key} = " in fall_remedy(outcome, spec)
    tried = next(tightenings(spec, outcome))
    assert (tried.key, tried.old, tried.new) == (first.key, first.old, first.new)


def test_a_range_is_told_as_one():
    (longer,) = (r for r in remedies(GaitSpecification(), TIMED_OUT, Remedy) if r.new == (0.5, 0.8))
    assert str(longer) == "step_duration = [0.5, 0.8] (before [0.4, 0.8])"
