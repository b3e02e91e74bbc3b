"""The reversal point: the paper's iteration, Newton's method, and a certificate of how many there are.

The paper imposes invariance at a guess of the reversal, finds the zero of Z, and repeats. That is a fixed-point
iteration; it contracts by a factor Phi' that is known in closed form. Newton's method on the self-consistent function S
needs no luck. Chebyshev interpolation with a measured error bound counts all zeros of S on the regular region of the
bracket, where I_P keeps a fiftieth of its least on the gait; here that leaves out the first 7 mrad after the impact.

You should see:

    bracket        ]-1.6621, -1.4494[ rad, planned -1.642085
    Newton         4 steps, error below 1e-10: True
    the paper's    70 steps or a few more, converged: True
    contraction    predicted 0.785, measured 0.785
    existence      certified
    uniqueness     refuted: zeros at -1.6421, -1.6086 rad
    to the barrier 304 % of the post-impact energy

Leave out max_pelvis_roll: Phi' grows to 0.96, and the iteration takes hundreds of steps.
"""

import frontal_biped as fb
from frontal_biped.zero_dynamics.reversal.certificate import certify_reversal
from frontal_biped.zero_dynamics.reversal.problem import ReversalProblem
from frontal_biped.zero_dynamics.reversal.solver import solve_reversal, successive_approximation

GUESS = 2e-4  # [rad] off the planned reversal
NODES = 24


def main() -> None:
    """Find the reversal in two ways, and certify it."""
    robot = fb.load_robot("frontal_biped")
    gait = fb.design_gait(robot, fb.GaitSpecification(max_pelvis_roll=0.0873), quick=True).gait  # 5 degrees
    assert gait is not None
    problem = ReversalProblem.of_phases(robot, gait.rising, gait.falling, gait.step_width, NODES)
    low, high = problem.bracket
    print(f"bracket        ]{low:.4f}, {high:.4f}[ rad, planned {problem.planned:.6f}")

    newton = solve_reversal(problem, problem.planned + GUESS)
    paper = successive_approximation(problem, problem.planned + GUESS)
    print(f"Newton         {newton.count} steps, error below 1e-10: {abs(newton.beta - problem.planned) < 1e-10}")
    print(f"the paper's    {paper.count // 10 * 10} steps or a few more, converged: {paper.converged}")
    predicted, measured = problem.contraction(problem.planned), paper.contraction(newton.beta)
    print(f"contraction    predicted {predicted:.3f}, measured {measured:.3f}")
    assert abs(predicted - measured) < 1e-3

    certificate = certify_reversal(problem)
    zeros = certificate.self_consistent
    print(f"existence      {zeros.existence.value}")
    print(f"uniqueness     {zeros.uniqueness.value}: zeros at {', '.join(f'{z.place:.4f}' for z in zeros.zeros)} rad")
    print(f"to the barrier {100.0 * certificate.barrier_margin:.0f} % of the post-impact energy")
    assert certificate.planned_is_a_zero


if __name__ == "__main__":
    main()
