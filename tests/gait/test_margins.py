"""The room of a step is the constraints' own: what the stabilisers read agrees with what design and report ask."""

from dataclasses import replace

import numpy as np
import pytest

from frontal_biped.gait.constraints import SoleHeights, sole_heights, step_constraints
from frontal_biped.gait.margins import LIFTED, ContactMargins
from frontal_biped.model.chain import JOINTS
from frontal_biped.zero_dynamics.half_steps import falling_energy, rising_energy
from frontal_biped.zero_dynamics.orbit import resample

SAME = 1e-7
"""Two integrations of one orbit: on panels from the impact, by quadrature from the reversal."""


@pytest.fixture(scope="module", params=["reference_gait", "level_gait"])
def gait(request):
    """With other limits than the default ones, so that each comes from the specification; the reserves stay."""
    gait = request.getfixturevalue(request.param)
    own = {"friction": 0.37, "min_normal_force": 0.21, "max_torque": (31.0, 57.0, 43.0, 17.0)}
    return replace(gait, specification=replace(gait.specification, **own))


@pytest.fixture(scope="module")
def energies(biped, gait):
    return rising_energy(biped, gait.rising), falling_energy(biped, gait.falling, gait.beta_reversal)


@pytest.fixture(scope="module")
def margins(biped, gait, energies):
    rising, falling = energies
    limits = ContactMargins(biped, gait)
    found = [
        *limits.rising(rising, gait.orbit.beta_dot_after_impact, gait.beta_reversal),
        *limits.falling(falling, gait.beta_reversal),
    ]
    return {margin.name: margin.value for margin in found}


@pytest.fixture(scope="module")
def constraints(biped, gait, energies):
    """The constraints of the design at the points of the panels, by name; of phases that end where the foot lifts."""

    def tau(energy, end):
        beta = energy.motion.q[:, 0]
        beta = beta[beta <= gait.beta_reversal]
        return np.unique(np.clip((gait.beta_reversal - beta) / (gait.beta_reversal - end), 0.0, 1.0) ** 0.5)

    step = gait.step(biped)
    rising, falling = (
        resample(biped, phase, orbit, tau(energy, end))
        for phase, orbit, energy, end in (
            (gait.rising, step.rising, energies[0], gait.rising.beta_start),
            (gait.falling, step.falling, energies[1], gait.falling.beta_end),
        )
    )
    dense = step._replace(rising=rising, falling=falling)
    soles = SoleHeights(*(sole_heights(biped, orbit.motion.q) for orbit in (rising, falling)))
    found = step_constraints(biped, gait.specification, dense, soles, step.duration)
    return dense, {constraint.name: constraint for constraint in found}


def room(constraint):
    """Least distance to the bounds that the design asks for."""
    return min(float(np.min(sign * (constraint.values - bound))) for bound, sign in constraint.sides())


@pytest.mark.parametrize("phase", ["rising", "falling"])
def test_along_a_phase(biped, gait, margins, constraints, phase):
    orbits, rows = constraints
    width, spec = biped.sole[1] - biped.sole[0], gait.specification
    expected = {
        "friction": room(rows[f"F_h / F_v, {phase}"]),
        "normal force": room(rows[f"F_v / m g, {phase}"]),
        "FRI in the sole": (room(rows[f"FRI in the sole, {phase}"]) + spec.fri_margin) / width,
        "torque": min(
            room(rows[f"{joint} torque, {phase}"]) / limit for joint, limit in zip(JOINTS, spec.max_torque, strict=True)
        ),
    }
    for name, value in expected.items():
        assert margins[f"{name}, {phase}"] == pytest.approx(value, abs=SAME), name
    # the last points, where the foot is on the ground, are left to touchdown and lift-off
    tau = getattr(orbits, phase).tau
    clearance = rows[f"sole height / (1 - t2), {phase}"]
    heights = clearance.values[:-2].reshape(2, -1)[:, 1.0 - tau[:-1] ** 2 > LIFTED]
    assert margins[f"swing foot clearance, {phase}"] == pytest.approx(np.min(heights) / clearance.scale, rel=1e-6)


def test_at_the_impact(biped, gait, margins, constraints):
    rows, width, spec = constraints[1], biped.sole[1] - biped.sole[0], gait.specification
    touchdown, lift_off = rows["touchdown speed of both sole ends"], rows["lift-off speed of the old stance sole"]
    impulse = rows["normal impulse / m"]
    expected = {
        "touchdown speed": (room(touchdown) + spec.touchdown_speed) / touchdown.scale,
        "normal impulse": room(impulse) / impulse.scale,
        "impulse in the friction cone": room(rows["L_h / L_v"]),
        "impulse in the sole": room(rows["impulse in the sole"]) / width,
        "lift-off of the old stance foot": room(lift_off) / lift_off.scale,
    }
    for name, value in expected.items():
        assert margins[name] == pytest.approx(value, abs=SAME), name


def test_every_margin_is_held(margins):
    assert len(margins) == 5 + 5 + 5


def test_load_is_one_less_the_room(biped, gait, energies, margins):
    """The largest share of friction or a motor's torque that the rising phase of the orbit takes."""
    energy, spec = energies[0], gait.specification
    zeta = 0.5 * (energy.start_inertia * gait.orbit.beta_dot_after_impact) ** 2
    used = max(1.0 - margins["torque, rising"], 1.0 - margins["friction, rising"] / spec.friction)
    assert ContactMargins(biped, gait).load(energy, zeta) == pytest.approx(used, abs=1e-4)


def test_ground_that_would_have_to_pull_is_infinite_load(biped, gait, energies):
    """Ten times as fast, the robot leaves the ground."""
    energy = energies[0]
    zeta = 0.5 * (energy.start_inertia * 10.0 * gait.orbit.beta_dot_after_impact) ** 2
    assert ContactMargins(biped, gait).load(energy, zeta) == float("inf")


@pytest.mark.parametrize("change", [{"fri_margin": 0.02}, {"swing_clearance": 0.05}, {"touchdown_speed": 0.2}])
def test_reserves_of_a_plan_are_no_limits_of_the_contact(biped, gait, energies, margins, change):
    other = replace(gait, specification=replace(gait.specification, **change))
    found = ContactMargins(biped, other).falling(energies[1], gait.beta_reversal)
    assert {margin.name: margin.value for margin in found}.items() <= margins.items()


@pytest.mark.filterwarnings("error")
def test_a_robot_that_turns_back_where_it_begins_has_a_room(biped, gait, energies):
    """Its foot never lifts: nothing is asked of the swing foot, and everything else of the one point there is."""
    rising, _ = energies
    at_once = ContactMargins(biped, gait).rising(rising, gait.orbit.beta_dot_after_impact, rising.start)
    rooms = {margin.name: margin.value for margin in at_once}
    assert rooms.pop("swing foot clearance, rising") == np.inf
    assert np.isfinite(list(rooms.values())).all()
