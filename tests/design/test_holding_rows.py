"""Designs that bound what the ground must hold in space: exact derivatives, and gaits that keep the bounds."""

from dataclasses import replace

import numpy as np
import pytest
from random_states import assert_close

from frontal_biped.design import optimise_gait
from frontal_biped.design.forward_mode import Dual
from frontal_biped.design.plane_derivatives import plane_dynamics
from frontal_biped.design.problem import DesignProblem
from frontal_biped.exceptions import RobotError
from frontal_biped.gait import GaitSpecification, default_specification
from frontal_biped.gait.file import load_gait
from frontal_biped.model import FrontalBiped, Stance, load_robot, models_dir
from frontal_biped.model.space.plane_masses import PlaneMasses
from frontal_biped.virtual_constraints import ConstrainedMotion

STEP = 2e-6
"""Step of differences, in units of the variables' scales."""

GRADIENT_TOLERANCE = 1e-6
"""As of the other rows: `test_problem`."""

IN_SPACE = ("cop_margin_x", "yaw_friction")


@pytest.fixture(scope="module", params=["g1", "talos_full"])
def humanoid(request) -> FrontalBiped:
    return load_robot(request.param)


def test_derivatives_against_differences(humanoid):
    """At the stored gait, where all rows are smooth: no centre of pressure is in the middle of the sole at a node."""
    gait = load_gait(models_dir() / f"{humanoid.name}.gait.json")
    spec = replace(gait.specification, cop_margin_x=0.01, yaw_friction=0.3)
    problem = DesignProblem(humanoid, spec, 16)
    x = problem.variables(gait) + 0.01 * problem.scale() * np.random.default_rng(0).normal(size=problem.size)
    point = problem.evaluate(x)
    picked = np.concatenate(
        [np.arange(row.entries.start, row.entries.stop) for row in problem.rows() if row.code in IN_SPACE]
    )
    # centre of pressure between two bounds, friction plus and minus between two: 16 nodes, two phases, two feet
    assert len(picked) == 16 * 2 * 2 * (2 + 4)
    scale = problem.scale()
    for i in range(0, problem.size, 3):
        shift = STEP * scale[i] * np.eye(problem.size)[i]
        above, below = problem.evaluate(x + shift).margins[picked], problem.evaluate(x - shift).margins[picked]
        exact = point.margins_jacobian[picked, i] * scale[i]
        assert_close((above - below) / (2.0 * STEP), exact, GRADIENT_TOLERANCE, floor=1.0)


def test_existing_designs_see_no_row_of_it(humanoid):
    problem = DesignProblem(humanoid, default_specification(humanoid), 16)
    problem.evaluate(problem.start())
    assert not any(row.code in IN_SPACE for row in problem.rows())


def test_differentiated_dynamics_are_the_plain_ones(humanoid):
    """By each node's own variables, then by all, is what one pass over arrays with all derivatives yields."""
    rng = np.random.default_rng(1)
    blocks = [rng.normal(size=(6, 5, 4)) for _ in range(3)]
    blocks[1][:, :, 0], blocks[2][:, :, 0] = 0.0, 0.0  # beta is the variable of the curve
    blocks[1][0, :, 0] = 1.0
    whole = [Dual(block) for block in blocks]
    motions = [ConstrainedMotion(*(part[rows] for part in whole), None, None) for rows in (slice(0, 2), slice(2, 5))]
    masses = PlaneMasses.of(humanoid, Stance.RIGHT)
    expected = masses.along(*whole)
    for found, rows in zip(plane_dynamics(masses, motions), (slice(0, 2), slice(2, 5)), strict=True):
        for part, reference in zip(found, expected, strict=True):
            assert_close(part.block, reference.block[:, :, rows], 1e-12)


def test_a_sole_of_unknown_length_is_told(raised_ankle):
    with pytest.raises(RobotError, match=r"length of the sole .* give \[sole\] front, back"):
        optimise_gait(raised_ankle, GaitSpecification(cop_margin_x=0.0))


@pytest.mark.slow
@pytest.mark.parametrize(("name", "bounds"), [("g1", {"yaw_friction": 0.6}), ("romeo", {"yaw_friction": 0.25})])
def test_gaits_keep_the_bounds_and_pay_for_them(name, bounds):
    robot = load_robot(name)
    free = optimise_gait(robot, default_specification(robot))
    result = optimise_gait(robot, replace(default_specification(robot), **bounds))
    assert result.success, result.message
    used = [check for check in result.report.checks if check.code == "yaw_friction"]
    assert len(used) == 2 and all(check.satisfied for check in used)
    # the bound is what the gait is up against
    assert min(check.margin for check in used) < 1e-3
    assert result.gait.orbit.cost > free.gait.orbit.cost
