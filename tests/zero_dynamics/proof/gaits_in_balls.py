"""A gait's orbit in balls, and shapes in balls beside measured motions."""

from frontal_biped.virtual_constraints.invariance import free_parameters
from frontal_biped.zero_dynamics.proof.ball_gait import BallGait
from frontal_biped.zero_dynamics.proof.balls import arb
from frontal_biped.zero_dynamics.proof.chain import BallChain
from frontal_biped.zero_dynamics.proof.limits import BallOrbit
from frontal_biped.zero_dynamics.proof.theorems import nearest_zero

ROUNDING = 1e-7
"""Of curves from columns as the file rounded them, relative to one more than their size."""


def orbit_in_balls(biped, gait):
    """The orbit through the zero nearest to the planned reversal."""
    balls = BallGait.of(BallChain.of(biped.chain), free_parameters(gait.rising, gait.falling, gait.step_width))
    return BallOrbit.of(balls, nearest_zero(balls).reversal, biped.sole)


def agree(ball_shape, motion, faster=1.0):
    """A shape in balls and a measured motion at one point, whose beta takes so many times the shape's variable."""
    pairs = [
        *zip(ball_shape.q, motion.q[0], strict=True),
        *zip(ball_shape.slopes, motion.dq[0] * faster, strict=True),
        *zip(ball_shape.bends, motion.ddq[0] * faster**2, strict=True),
        (ball_shape.p_fri, motion.p_fri[0]),
        (ball_shape.dp_fri, motion.dp_fri[0] * faster),
    ]
    for ball, number in pairs:
        assert ball.overlaps(arb(number, ROUNDING * (1.0 + abs(number))))
