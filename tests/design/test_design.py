"""Designed gaits: what they cost, what they satisfy on a dense grid, and what is said where none exists."""

import numpy as np
import pytest

from frontal_biped.design import optimise_gait
from frontal_biped.design.optimise import OPTIMISER_NODES
from frontal_biped.exceptions import SpecificationError, UnreachablePoseError
from frontal_biped.gait import GaitSpecification, check_constraints
from frontal_biped.gait.check import DENSER
from frontal_biped.virtual_constraints.phase import StepPhase
from frontal_biped.zero_dynamics.orbit import phase_orbit, resample
from frontal_biped.zero_dynamics.poincare import step_orbit

REFERENCE_COST = 210.5
"""J of the default specification that the default start must reach [N^2 m s]; local minima nearby cost 215 and more."""

LEVEL_COST = 406.0
"""The same with the pelvis level to five degrees [N^2 m s]."""

RESIDUAL = 1e-9
"""What a gait may be off from being one."""

CODES = [f"C{i:02}" for i in range(1, 10)]


@pytest.fixture(params=["reference_design", "level_design"])
def result(request):
    return request.getfixturevalue(request.param)


class TestDesignedGait:
    def test_reference_cost(self, reference_design):
        assert reference_design.success, reference_design.message
        assert reference_design.gait.orbit.cost <= REFERENCE_COST

    def test_level_cost(self, level_design):
        assert level_design.success, level_design.message
        assert level_design.gait.orbit.cost <= LEVEL_COST

    def test_everything_is_satisfied(self, result):
        assert result.report.satisfied
        assert result.report.violated == ()
        assert "\n" not in result.message

    def test_residuals(self, biped, result):
        residuals = result.gait.residuals(biped)
        assert max(residuals.values()) < RESIDUAL, residuals
        assert result.gait.provenance["residuals"] == residuals

    def test_every_constraint_of_the_paper_is_reported(self, result):
        codes = [check.code for check in result.report.checks]
        assert [code for code in CODES if code not in codes] == []
        assert codes[: len(codes)] == sorted(codes)

    def test_grid_is_as_dense_as_is_said(self, result):
        assert result.report.points - 1 == DENSER * OPTIMISER_NODES

    def test_report_as_text_and_data(self, result):
        data = result.report.as_dict()
        assert data["satisfied"] is True
        assert len(data["checks"]) == len(result.report.checks)
        text = str(result.report)
        assert "VIOLATED" not in text
        for code in CODES:
            assert code in text

    def test_specification_travels_with_the_gait(self, result):
        specification = result.gait.specification
        expected = 0.0 if specification.max_pelvis_roll is None else np.radians(5.0)
        assert (specification.max_pelvis_roll or 0.0) == pytest.approx(expected)


@pytest.mark.parametrize("kind", list(StepPhase))
def test_constraints_by_hand_on_a_random_grid(biped, level_design, kind):
    """C05, C06 and the pelvis, from positions and inverse dynamics at points no grid contains."""
    gait = level_design.gait
    spec = gait.specification
    phase = gait.rising if kind is StepPhase.RISING else gait.falling
    tau = np.sort(np.random.default_rng(int(kind.sign) + 1).uniform(0.0, 1.0, 200))
    orbit = resample(biped, phase, phase_orbit(biped, phase, kind, 40), tau)
    # a constraint may dip between two points of the dense grid by the square of their distance
    dip = 1e-5
    for i in range(tau.size):
        q, dq = orbit.motion.q[i], orbit.motion.dq[i] * orbit.dbeta[i]
        ddq = orbit.motion.ddq[i] * orbit.dbeta[i] ** 2 + orbit.motion.dq[i] * orbit.ddbeta[i]
        F_h, F_v, N_0, *u = biped.inverse_dynamics(q, dq, ddq)
        assert F_v >= spec.min_normal_force * biped.weight - dip
        assert abs(F_h) <= spec.friction * F_v + dip
        assert biped.sole[0] + spec.fri_margin - dip <= N_0 / F_v <= biped.sole[1] - spec.fri_margin + dip
        assert np.all(np.abs(u) <= biped.max_torque + dip)
        assert abs(biped.pelvis_roll(q)) <= spec.max_pelvis_roll + dip
        assert np.all(biped.swing_sole(q)[:, 1] >= spec.swing_clearance * (1.0 - tau[i] ** 2) - dip)


def test_impact_constraints_by_hand(biped, reference_design):
    """C04, C07 and C08 from the full impact at the state before it."""
    from frontal_biped.model import impact

    gait = reference_design.gait
    spec = gait.specification
    orbit = phase_orbit(biped, gait.falling, StepPhase.FALLING, 40)
    q, dq = orbit.motion.q[-1], orbit.motion.dq[-1] * orbit.dbeta[-1]
    rounding = 1e-8
    descent = -biped.swing_sole_jacobian(q)[:, 1] @ dq
    assert np.all(descent >= spec.touchdown_speed - rounding)
    landing = impact(biped, q, dq)
    L_h, L_v, moment = landing.impulse
    assert L_v > 0.0
    assert abs(L_h) <= spec.friction * L_v
    assert -biped.sole[1] <= moment / L_v <= -biped.sole[0]
    assert np.all(landing.lift_off >= -rounding)


def check_of(report, code, word=""):
    return [check for check in report.checks if check.code == code and word in check.name]


@pytest.mark.parametrize(
    ("code", "word", "change"),
    [
        ("C02", "range of beta, rising", {"min_phase_range": 0.1}),
        ("C04", "touchdown", {"touchdown_speed": 1.0}),
        ("C05", "sole height", {"swing_clearance": 0.2}),
        ("C06", "F_v", {"min_normal_force": 1.5}),
        ("C06", "F_h / F_v", {"friction": 0.01}),
        ("C06", "FRI", {"fri_margin": 0.049}),
        ("C06", "stance hip torque", {"max_torque": (150.0, 10.0, 150.0, 150.0)}),
        ("C07", "L_h / L_v", {"friction": 0.001}),
        ("C09", "duration", {"step_duration": (0.1, 0.2)}),
        ("C09", "width", {"step_width": (0.5, 0.6)}),
        ("max_pelvis_roll", "pelvis", {"max_pelvis_roll": 0.001}),
    ],
)
def test_report_finds_a_violation(biped, reference_design, code, word, change):
    """The same gait under a harder bound: exactly that constraint is named, with a negative margin."""
    gait = reference_design.gait
    step = gait.step(biped, 40)
    report = check_constraints(biped, GaitSpecification(**change), gait.rising, gait.falling, step)
    assert not report.satisfied
    broken = [check for check in report.violated if check.code == code and word in check.name]
    assert broken, [check.name for check in report.violated]
    assert all(check.margin < 0.0 for check in broken)
    assert "VIOLATED" in str(report)


def test_dense_grid_and_coarse_grid_agree(biped, reference_design):
    gait = reference_design.gait
    spec = gait.specification
    step = gait.step(biped, 40)
    coarse = check_constraints(biped, spec, gait.rising, gait.falling, step, points=161)
    for dense, rough in zip(reference_design.report.checks, coarse.checks, strict=True):
        assert dense.name == rough.name
        assert dense.margin <= rough.margin + 1e-9  # a finer grid contains the coarser one
        assert dense.margin == pytest.approx(rough.margin, abs=1e-2 * max(1.0, abs(dense.bound)))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["low_torso", "raised_ankle"])
def test_other_robots_can_be_designed_for(request, name):
    robot = request.getfixturevalue(name)
    seen = []
    result = optimise_gait(robot, GaitSpecification(), on_progress=lambda *row: seen.append(row))
    assert result.success, result.message
    assert result.report.satisfied
    iterations, costs, violations = zip(*seen, strict=True)
    assert list(iterations) == sorted(iterations) and iterations[-1] <= result.iterations
    assert costs[-1] == pytest.approx(result.gait.orbit.cost, rel=1e-3)
    assert violations[-1] < 1e-6
    residuals = result.gait.residuals(robot)
    assert max(residuals.values()) < RESIDUAL, residuals
    assert 0.0 < result.gait.orbit.multiplier < 1.0


@pytest.mark.slow
def test_infeasible_specification_is_a_result_not_an_exception(biped):
    """A step of twenty milliseconds: no gait, and a message that names a constraint."""
    assert_refused(optimise_gait(biped, GaitSpecification(step_duration=(0.01, 0.02))))


def test_sole_too_short_for_its_margins(biped):
    """Margins of 0.06 m at both ends of a sole of 0.1 m leave no room for the FRI."""
    with pytest.raises(SpecificationError, match="leaves no room in a sole"):
        optimise_gait(biped, GaitSpecification(fri_margin=0.06))


def assert_refused(result):
    assert not result.success
    assert result.gait is None
    assert result.report is None or not result.report.satisfied
    assert any(code in result.message for code in CODES), result.message
    assert "\n" not in result.message


def test_unreachable_width_raises(biped):
    with pytest.raises(UnreachablePoseError, match="step_width"):
        optimise_gait(biped, GaitSpecification(step_width=(3.0, 4.0)))


@pytest.mark.parametrize("degree", [4, 5, 7])
def test_design_can_start_from_a_gait(biped, reference_gait, degree):
    """From its own answer the optimiser stays there; a lower degree costs more, a higher one less."""
    result = optimise_gait(biped, GaitSpecification(degree=degree), start=reference_gait)
    assert result.success, result.message
    change = result.gait.orbit.cost / reference_gait.orbit.cost - 1.0
    if degree == 5:
        assert abs(change) < 1e-5
    else:
        assert np.sign(change) == (1 if degree < 5 else -1)


def test_step_of_the_gait_is_the_planned_one(biped, reference_design):
    gait = reference_design.gait
    step = step_orbit(biped, gait.rising, gait.falling, gait.step_width, 40)
    assert step.cost == pytest.approx(gait.orbit.cost, rel=1e-10)
    assert step.duration == pytest.approx(gait.orbit.step_duration, rel=1e-10)


def test_equal_input_gives_equal_bytes(biped, reference_gait, tmp_path):
    """In another process, with another number of threads, and with memory laid out differently."""
    import os
    import subprocess
    import sys

    from frontal_biped.gait.file import save_gait

    save_gait(reference_gait, tmp_path / "here.json")
    code = (
        "import sys, numpy as np; kept = [np.zeros(n) for n in range(1, 300, 7)]\n"
        "import frontal_biped as fb\n"
        "from frontal_biped.design import optimise_gait\n"
        "result = optimise_gait(fb.load_robot('frontal_biped'), fb.GaitSpecification())\n"
        "fb.save_gait(result.gait, sys.argv[1])\n"
    )
    for threads in ("1", "2"):
        environment = {**os.environ, "OMP_NUM_THREADS": threads, "OPENBLAS_NUM_THREADS": threads}
        path = tmp_path / f"{threads}.json"
        subprocess.run([sys.executable, "-c", code, str(path)], env=environment, check=True, timeout=120)
        assert path.read_bytes() == (tmp_path / "here.json").read_bytes()


def test_several_starts_keep_the_cheapest(biped, reference_gait):
    result = optimise_gait(biped, GaitSpecification(seed=3), attempts=2)
    assert result.success
    assert result.gait.orbit.cost <= reference_gait.orbit.cost * (1.0 + 1e-5)


def test_a_start_that_leads_nowhere_falls_back(biped):
    """Far outside every bound; the default start stands in."""
    from frontal_biped.design.problem import DesignProblem

    problem = DesignProblem(biped, GaitSpecification(), OPTIMISER_NODES)
    start = problem.start() + 0.8 * np.sin(7.0 * np.arange(problem.size))
    assert optimise_gait(biped, GaitSpecification(), start=start).success


def test_no_attempts_are_refused(biped):
    with pytest.raises(SpecificationError, match="attempts = 0"):
        optimise_gait(biped, attempts=0)
