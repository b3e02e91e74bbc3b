r"""Paths of a step whose rising phase is stretched, and whose falling phase begins wherever that reverses, in balls.

What `control.stabilisers.look_ahead` chooses from. The step that reverses at the end of the stretched phase is in
`stretched_step`.

**Rescaled**, from any other reversal, its inner columns are moved along with its start. With y the share of the way, M
the degree, Lambda the way and h, Lambda_f those of the planned phase, slope the rising phase's at the reversal,

.. math:: q = h(y) + \delta (1 - y) + e_1 B_1^M(y) + e_2 B_{M-1}^M(y),

delta the pose there less the planned one, h_k the planned columns, and what the columns 1 and M - 1 differ by from a
line through those of delta,

.. math:: e_1 = h_0 - h_1 + \frac{\delta - \Lambda\, slope}{M}, \qquad
          e_2 = (h_{M-1} - h_M) (\frac{\Lambda}{\Lambda_f} - 1) - \frac{\delta}{M}.

delta, e_1 and e_2 are polynomials in how early the reversal is. They are small, and so are their balls: those of q''
are not blown up by second differences of columns that move together.
"""

from dataclasses import dataclass

from frontal_biped.zero_dynamics.proof.balls import ORDER, Ball, Number, arb, coefficient, series, value_of
from frontal_biped.zero_dynamics.proof.chain import sums
from frontal_biped.zero_dynamics.proof.half_path import HalfPath, Path, Shape, combined
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError, bernstein
from frontal_biped.zero_dynamics.proof.reversals import LatePath, Tapers, derived, polynomial_at
from frontal_biped.zero_dynamics.proof.stretched_step import joint_columns


@dataclass(frozen=True)
class LowerPart(Path):
    """What is left of a path from a point on it down.

    Attributes:
        whole: the path.
        missing: share of its way above the point.
    """

    whole: Path
    missing: Ball

    @classmethod
    def of(cls, whole: Path, above: float) -> "LowerPart":
        """From so far below its beginning [rad]."""
        return cls(whole.chain, whole.sole, whole.span - arb(above), whole, arb(above) / whole.span)

    def shape(self, y: Number) -> Shape:
        """The path's own."""
        return self.whole.shape(y * (1 - self.missing) + self.missing)


@dataclass(frozen=True)
class RescaledPath(Path):
    """From any reversal down to the impact, rescaled as a whole.

    Attributes:
        falling: the planned falling half.
        end: beta at the impact [rad].
        moved: (3,) delta of the joints after the first [rad].
        columns: (3, M + 1) of e_1 and e_2, from the reversal on [rad].
        fri_moved: FRI target at the reversal less the planned one [m].
    """

    falling: HalfPath
    end: Ball
    moved: list[Number]
    columns: list[list[Number]]
    fri_moved: Number

    @classmethod
    def early(cls, rising: HalfPath, falling: HalfPath, end: Ball, way: Ball, d: Number) -> "RescaledPath":
        """Of all reversals so far before the end of a rising half.

        Args:
            rising: the half, stretched or not.
            falling: the planned falling half.
            end: beta at the impact [rad].
            way: beta at the end of the rising half, minus that [rad].
            d: how far [rad], a ball or a `Jet`.

        Raises:
            NotEnclosedError: the degree is too high for a series.
        """
        if max(len(angle.columns) for angle in (*rising.half.angles, rising.half.fri)) > ORDER:
            raise NotEnclosedError("degree")
        middle = value_of(d).mid()
        x = series([arb(0), arb(1)])
        shape = rising.shape((x + middle) / rising.span)
        parts = cls._parts(falling, shape, way - middle - x)
        moved, first, last, fri = (
            [polynomial_at([coefficient(p, k) for k in range(ORDER + 1)], d - middle) for p in part] for part in parts
        )
        return cls._with(falling, end, way - d, moved, first, last, fri)

    @classmethod
    def late(cls, rising: HalfPath, tapers: Tapers, falling: HalfPath, end: Ball, way: Ball, x: Ball) -> "RescaledPath":
        """Of all reversals so far beyond the end of a rising half [rad], on its continuation."""
        shape = LatePath(rising.chain, rising.sole, x, tapers, rising.shape(arb(0))).shape(arb(0))
        return cls._with(falling, end, way + x, *cls._parts(falling, shape, way + x))

    @staticmethod
    def _parts(falling: HalfPath, at: Shape, way: Number) -> tuple[list[Number], ...]:
        """delta, e_1 and e_2 of the joints after the first, and the FRI target's part."""
        moved: list[Number] = []
        first: list[Number] = []
        last: list[Number] = []
        for columns, q, slope in zip(joint_columns(falling.half), at.q[1:], at.slopes[1:], strict=True):
            degree = len(columns) - 1
            delta = q - columns[-1]
            moved.append(delta)
            first.append((delta - slope * way) / degree + (columns[-1] - columns[-2]))
            last.append((way / falling.span - 1) * (columns[1] - columns[0]) - delta / degree)
        return moved, first, last, [at.p_fri - falling.half.fri.columns[-1]]

    @classmethod
    def _with(
        cls,
        falling: HalfPath,
        end: Ball,
        way: Number,
        moved: list[Number],
        first: list[Number],
        last: list[Number],
        fri: list[Number],
    ) -> "RescaledPath":
        if not value_of(way) > 0:
            raise NotEnclosedError("way left")
        between = [arb(0)] * (len(falling.half.angles[0].columns) - 4)
        columns = [[arb(0), e_1, *between, e_2, arb(0)] for e_1, e_2 in zip(first, last, strict=True)]
        return cls(falling.chain, falling.sole, way, falling, end, moved, columns, fri[0])

    def shape(self, y: Number) -> Shape:
        """The planned phase at the same share of its way, and what was moved."""
        planned, way = self.falling.shape(y), self.span
        degree, of_fri = len(self.columns[0]) - 1, len(self.falling.half.fri.columns) - 1
        bases = [bernstein(degree - k, 1 - y) for k in range(3)]
        shorter = self.falling.span / way
        q: list[Number] = [(1 - y) * way + self.end]
        slopes: list[Number] = [y * 0 + 1]
        bends: list[Number] = [y * 0]
        for i, (delta, columns) in enumerate(zip(self.moved, self.columns, strict=True), start=1):
            # from the impact on, as the bases have it
            value, slope, bend = (combined(derived(columns[::-1], k), bases[k]) for k in range(3))
            q.append(planned.q[i] + (1 - y) * delta + value)
            slopes.append(planned.slopes[i] * shorter + (slope + delta) / way)
            bends.append(planned.bends[i] * (shorter * shorter) + bend / (way * way))
        quarter = arb.pi() / 2
        steep = bernstein(of_fri - 1, 1 - y)[-1]
        return Shape(
            sums([angle + quarter for angle in q]),
            sums(slopes),
            sums(bends),
            q,
            slopes,
            bends,
            planned.p_fri + bernstein(of_fri, 1 - y)[-1] * self.fri_moved,
            planned.dp_fri * shorter + steep * (self.fri_moved * of_fri / way),
        )
