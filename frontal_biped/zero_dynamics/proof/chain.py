r"""The planar chain in ball arithmetic: the one place where the robot's dynamics stand outside Pinocchio.

The chain is that of `model.chain`: stance foot, leg, pelvis, leg, foot, the stance foot at rest. Its numbers are those
of URDF and description (`decimals`), or given doubles taken as exact. With the absolute angles
alpha_i = sum_{j <= i} (q_j + pi/2), R the rotation and J the quarter turn,

.. math:: o_{i+1} = o_i + R(\alpha_i)\, l_i, \qquad c_i = o_i + R(\alpha_i)\, r_i, \qquad
          (R(\alpha) x)' = \alpha' J R(\alpha) x, \qquad
          (R(\alpha) x)'' = \alpha'' J R(\alpha) x - \alpha'^2 R(\alpha) x,

and by virtual work the generalized forces of a motion are those that its bodies' m (a + g) and I ddalpha ask for: F as
it is, N_0 about the ground point below the ankle, u_j about joint j of all that is further out, and the rotor of joint
j. No recursion, no matrices: a second route to the numbers that Pinocchio's algorithms give.

Numbers are balls or series of balls (`balls.Number`): with a series in the phase variable for an angle the same lines
give Taylor polynomials along the virtual constraints.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from frontal_biped.model.chain import GRAVITY, FrontalChain
from frontal_biped.zero_dynamics.proof.balls import Ball, Number, arb, arb_mat, sin_cos, within

Vector = tuple[Number, Number]
"""(h, v)."""

JOINTS = 4


class MovingBody(NamedTuple):
    """One of the four moving links.

    Attributes:
        mass: [kg].
        com: r_i, centre of mass from the joint at its root, upright [m].
        tip: l_i, next joint from there [m]; of the foot, its ground point below the ankle.
        inertia: about the centre of mass [kg m^2].
    """

    mass: Ball
    com: Vector
    tip: Vector
    inertia: Ball


class Motion(NamedTuple):
    """Angles and their derivatives by one variable, time or beta, each (4,).

    Attributes:
        q: [rad].
        dq: first.
        ddq: second.
    """

    q: list[Number]
    dq: list[Number]
    ddq: list[Number]


class Pose(NamedTuple):
    """Where the links are.

    Attributes:
        joints: o_1 to o_4 [m].
        coms: c_1 to c_4 [m].
        levers: R(alpha_i) r_i and R(alpha_i) l_i of every link [m].
    """

    joints: list[Vector]
    coms: list[Vector]
    levers: list[tuple[Vector, Vector]]


class Momentum(NamedTuple):
    """Per unit of the rate: m p_cm_h', m p_cm_v' [kg m], the moment of momentum I_0 about the ground point [kg m^2]."""

    h: Number
    v: Number
    ground: Number


class Momenta(NamedTuple):
    """What the zero dynamics is made of, at one pose and slope.

    Attributes:
        momentum: per unit of dbeta.
        moment: m p_cm_h, both feet included: the weight's moment about the ground point over g [kg m].
    """

    momentum: Momentum
    moment: Number


class Impact(NamedTuple):
    """What an impact does, per unit of the slope's rate (`model.impact.Landing`).

    Attributes:
        foot: velocity of the old stance foot after it, h, v and rotation about its ground point.
        impulse: L_h, L_v, and the moment about the ground point below the landing ankle.
    """

    foot: tuple[Ball, Ball, Ball]
    impulse: tuple[Ball, Ball, Ball]


@dataclass(frozen=True)
class BallChain:
    """The chain's numbers as balls.

    Attributes:
        ankle: o_1 [m].
        bodies: the moving links, from the stance leg to the swing foot.
        foot_mass: of the stance foot [kg].
        foot_moment: its mass times the horizontal offset of its centre of mass [kg m].
        foot_inertia: about the ground point below the ankle [kg m^2].
        foot_height: its mass times the height of its centre of mass [kg m].
        armature: (4,) reflected rotor inertias [kg m^2].
    """

    ankle: Vector
    bodies: tuple[MovingBody, ...]
    foot_mass: Ball
    foot_moment: Ball
    foot_inertia: Ball
    foot_height: Ball
    armature: tuple[Ball, ...]

    @classmethod
    def of(cls, chain: FrontalChain, error: float = 0.0) -> "BallChain":
        """The chain.

        Args:
            chain: as it was loaded.
            error: to which its numbers are known, relative [-].
        """

        def rounded(number: float | Ball) -> Ball:
            return within(number if isinstance(number, arb) else float(number), error)

        joints = [[rounded(x) for x in joint] for joint in chain.joints]
        tips = [*joints[1:], [joints[3][0], arb(0)]]
        bodies = []
        for joint, tip, body in zip(joints, tips, chain.bodies[1:], strict=True):
            com = [rounded(x) for x in body.com]
            bodies.append(
                MovingBody(
                    rounded(body.mass),
                    (com[0] - joint[0], com[1] - joint[1]),
                    (tip[0] - joint[0], tip[1] - joint[1]),
                    rounded(body.inertia),
                )
            )
        foot = chain.bodies[0]
        mass, h, v = rounded(foot.mass), rounded(foot.com[0]), rounded(foot.com[1])
        return cls(
            (joints[0][0], joints[0][1]),
            tuple(bodies),
            mass,
            mass * h,
            rounded(foot.inertia) + mass * (h * h + v * v),
            mass * v,
            tuple(rounded(rotor) for rotor in chain.armature),
        )

    @cached_property
    def mass(self) -> Ball:
        """Of the whole robot [kg]."""
        return sum((body.mass for body in self.bodies), self.foot_mass)

    @property
    def gravity(self) -> Ball:
        """g, the decimal number [m/s^2]."""
        return arb(str(GRAVITY))

    # ------------------------------------------------------------------ kinematics
    def pose(self, alphas: list[Number]) -> Pose:
        """Joints and centres of mass at absolute angles (4,) [rad]."""
        joints, coms, levers = [self.ankle], [], []
        for alpha, body in zip(alphas, self.bodies, strict=True):
            sin, cos = sin_cos(alpha)
            com, tip = _turned(sin, cos, body.com), _turned(sin, cos, body.tip)
            coms.append(_plus(joints[-1], com))
            joints.append(_plus(joints[-1], tip))
            levers.append((com, tip))
        return Pose(joints[:-1], coms, levers)

    def momenta(self, alphas: list[Number], rates: list[Number]) -> Momenta:
        """Momentum at absolute angles (4,) [rad] that change at rates (4,)."""
        pose = self.pose(alphas)
        h = v = ground = arb(0)
        moment = self.foot_moment
        root: Vector = (arb(0), arb(0))
        for i, (body, rate) in enumerate(zip(self.bodies, rates, strict=True)):
            com, tip = pose.levers[i]
            d_h, d_v = root[0] - rate * com[1], root[1] + rate * com[0]
            c_h, c_v = pose.coms[i]
            h, v = h + body.mass * d_h, v + body.mass * d_v
            ground = ground + body.mass * (c_h * d_v - c_v * d_h) + body.inertia * rate
            moment = moment + body.mass * c_h
            root = root[0] - rate * tip[1], root[1] + rate * tip[0]
        return Momenta(Momentum(h, v, ground), moment)

    # ------------------------------------------------------------------ dynamics
    def inverse_dynamics(self, motion: Motion, *, weight: bool = True) -> list[Number]:
        """(7,) rows F_h, F_v [N], N_0, u_1 to u_4 [N m] of a motion in time, as `FrontalBiped.inverse_dynamics`.

        Args:
            motion: [rad], [rad/s], [rad/s^2].
            weight: with gravity? Without, of a motion along beta, these are the coefficients of the dynamics on Z.
        """
        g = self.gravity if weight else arb(0)
        pose = self.pose(absolute(motion.q))
        accelerations = self.accelerations(pose, sums(motion.dq), sums(motion.ddq))
        asked = self.asked_by(pose, [(h, v + g) for h, v in accelerations], sums(motion.ddq), motion.ddq)
        asked[1] = asked[1] + self.foot_mass * g
        asked[2] = asked[2] + self.foot_moment * g
        return asked

    def accelerations(self, pose: Pose, rates: list[Number], turns: list[Number]) -> list[Vector]:
        """Of the centres of mass, whose links turn at absolute rates (4,) [rad/s] and accelerations (4,) [rad/s^2]."""
        found: list[Vector] = []
        root: Vector = (arb(0), arb(0))
        for (com, tip), rate, turn in zip(pose.levers, rates, turns, strict=True):
            found.append(_plus(root, _accelerated(com, rate, turn)))
            root = _plus(root, _accelerated(tip, rate, turn))
        return found

    def asked_by(
        self, pose: Pose, accelerations: list[Vector], turns: list[Number], joint_turns: list[Number]
    ) -> list[Number]:
        """(7,) rows F_h, F_v, N_0, u_1 to u_4 that the moving links ask for, by virtual work.

        Args:
            pose: where they are.
            accelerations: of their centres of mass, that of the weight included.
            turns: (4,) absolute angular accelerations.
            joint_turns: (4,) those of the joints, which the rotors take part in.
        """
        F_h: Number = arb(0)
        F_v: Number = arb(0)
        N_0: Number = arb(0)
        wanted: list[tuple[Number, Number, Number]] = []
        for body, a, turn, (c_h, c_v) in zip(self.bodies, accelerations, turns, pose.coms, strict=True):
            force = body.mass * a[0], body.mass * a[1]
            wanted.append((*force, body.inertia * turn))
            F_h, F_v = F_h + force[0], F_v + force[1]
            N_0 = N_0 + c_h * force[1] - c_v * force[0] + body.inertia * turn
        torques: list[Number] = []
        for j, (o_h, o_v) in enumerate(pose.joints):
            u: Number = self.armature[j] * joint_turns[j]
            for (c_h, c_v), (f_h, f_v, moment) in list(zip(pose.coms, wanted, strict=True))[j:]:
                u = u + (c_h - o_h) * f_v - (c_v - o_v) * f_h + moment
            torques.append(u)
        return [F_h, F_v, N_0, *torques]

    # ------------------------------------------------------------------ impact
    def landed_slopes(self, q: list[Ball], slopes: list[list[Ball]]) -> list[list[Ball]]:
        """Rigid impacts of the swing foot in one pose, the legs relabelled (`model.impact`): linear in the slope.

        Args:
            q: (4,) pose, the swing foot on the ground [rad].
            slopes: some (4,) velocities before, per unit of anything.

        Returns:
            Of each, (4,) after the impact in the new stance coordinates.

        Raises:
            ZeroDivisionError: the balls are too wide for the impact to be solved.
        """
        after = self._impacts(q, slopes)
        last = 3 + JOINTS - 1
        return [[after[last - j, column] for j in range(JOINTS)] for column in range(len(slopes))]

    def impact(self, q: list[Ball], slope: list[Ball]) -> Impact:
        """A rigid impact in full, linear in the slope; arguments and errors as of `landed_slopes`."""
        after = self._impacts(q, [slope])
        L_h, L_v, moment = (after[3 + JOINTS + k, 0] for k in range(3))
        # the multiplier's moment is about the ankle, h_a above the sole
        return Impact((after[0, 0], after[1, 0], after[2, 0]), (L_h, L_v, moment - self.ankle[1] * L_h))

    def _impacts(self, q: list[Ball], slopes: list[list[Ball]]) -> Ball:
        """(10, n) velocities of the floating robot after n impacts, and their impulses about the swing ankle."""
        M = self._floating_mass_matrix(q)
        J = self._landing_jacobian(q)
        size, rows = 3 + JOINTS, 3
        system = arb_mat(size + rows, size + rows)
        right = arb_mat(size + rows, len(slopes))
        for i in range(size):
            for j in range(size):
                system[i, j] = M[i][j]
            for k in range(rows):
                system[i, size + k] = -J[k][i]
                system[size + k, i] = J[k][i]
            for column, slope in enumerate(slopes):
                right[i, column] = sum((M[i][3 + j] * slope[j] for j in range(JOINTS)), arb(0))
        return system.solve(right)

    def _floating_mass_matrix(self, q: list[Ball]) -> list[list[Ball]]:
        """(7, 7), the stance foot free: h, v and rotation about the ground point, then q."""
        pose = self.pose(absolute(q))
        one, nothing = arb(1), arb(0)
        size = 3 + JOINTS
        M = [[nothing] * size for _ in range(size)]
        foot = [[self.foot_mass, nothing, -self.foot_height], [nothing, self.foot_mass, self.foot_moment]]
        for i, row in enumerate(foot):
            for j, value in enumerate(row):
                M[i][j] = M[j][i] = value
        M[2][2] = self.foot_inertia
        for i, body in enumerate(self.bodies):
            c_h, c_v = pose.coms[i]
            columns = [(one, nothing, nothing), (nothing, one, nothing), (-c_v, c_h, one)]
            for o_h, o_v in pose.joints[: i + 1]:
                columns.append((-(c_v - o_v), c_h - o_h, one))
            for a, (h, v, turn) in enumerate(columns):
                for b, (h_b, v_b, turn_b) in enumerate(columns):
                    M[a][b] = M[a][b] + body.mass * (h * h_b + v * v_b) + body.inertia * turn * turn_b
        for j, rotor in enumerate(self.armature):
            M[3 + j][3 + j] = M[3 + j][3 + j] + rotor
        return M

    def _landing_jacobian(self, q: list[Ball]) -> list[list[Ball]]:
        """(3, 7) of the swing ankle: h, v, rotation."""
        joints = self.pose(absolute(q)).joints
        h, v = joints[-1]
        one, nothing = arb(1), arb(0)
        return [
            [one, nothing, -v, *(-(v - o_v) for _, o_v in joints)],
            [nothing, one, h, *(h - o_h for o_h, _ in joints)],
            [nothing, nothing, one, *(4 * [one])],
        ]

    def mass_matrix(self, q: list[Ball]) -> list[list[Ball]]:
        """(4, 4), the stance foot held [kg m^2]."""
        return [row[3:] for row in self._floating_mass_matrix(q)[3:]]


def absolute(q: list[Number]) -> list[Number]:
    """alpha_1 to alpha_4 [rad], zero when upright."""
    quarter = arb.pi() / 2
    return sums([angle + quarter for angle in q])


def sums(values: list[Number]) -> list[Number]:
    """Of the first, of the first two, and so on."""
    sums = [values[0]]
    for value in values[1:]:
        sums.append(sums[-1] + value)
    return sums


def _turned(sin: Number, cos: Number, x: Vector) -> Vector:
    return cos * x[0] - sin * x[1], sin * x[0] + cos * x[1]


def _plus(x: Vector, y: Vector) -> Vector:
    return x[0] + y[0], x[1] + y[1]


def _accelerated(lever: Vector, rate: Number, turn: Number) -> Vector:
    """Acceleration of a lever's end about its root."""
    squared = rate * rate
    return -(turn * lever[1]) - squared * lever[0], turn * lever[0] - squared * lever[1]
