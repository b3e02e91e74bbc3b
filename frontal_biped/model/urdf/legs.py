"""Find the legs of a robot by looking at its joints: axes, sides and order, at the zero configuration.

Nothing is taken from names but left and right, and those only to tell forward from backward.
"""

import itertools
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import HypothesisError

NEARLY_ALONG = np.radians(25.0)
"""A joint whose axis is this close to X rolls, whose axis is this close to Y pitches; g1 builds its roll axes 10
degrees off at zero."""

MIRRORED = 0.03
"""Two legs are a pair if the axes of their joints are mirror images to this fraction of the leg's length."""

NEARLY_PARALLEL = 0.02
"""Sine of the angle between two axes that count as parallel where lines are compared."""

ROUNDING = 1e-9  # [m]

MOST_JOINTS = 200
"""Movable joints that are looked at, two chains by two; a humanoid with fingers has 80."""

MOST_CHAINS = 25
"""Ends of the tree of movable joints, which are looked at two by two; talos with its grippers has 13."""

_LEFT = re.compile(r"(^|_)(l|left)(_|$)|left|^fl_|^l(?=[A-Z])", re.IGNORECASE)
_RIGHT = re.compile(r"(^|_)(r|right)(_|$)|right|^fr_|^r(?=[A-Z])", re.IGNORECASE)


@dataclass(frozen=True)
class Legs:
    """Two mirrored legs.

    Attributes:
        upright: (3, 3) rotation that turns the root link upright: X forward, Y left, Z up.
        left: joints of the left leg from pelvis to foot, by name.
        right: their mirror images.
        roll: indices into ``left`` of the joints that roll.
        pitch: indices of the joints that pitch.
        sides_named: do the names say which side is left? If not, the root link's X is taken for forward.
    """

    upright: FloatArray
    left: tuple[str, ...]
    right: tuple[str, ...]
    roll: tuple[int, ...]
    pitch: tuple[int, ...]
    sides_named: bool


def find_legs(full: pin.Model, where: str, mimics: Collection[str] = ()) -> Legs:
    """The legs of a robot: the mirrored pair of joint chains that reaches lowest.

    The root link may be anywhere. Arms are passed over where there are legs; see `look_like_arms`.

    Args:
        full: 3D model with a free-flyer root.
        where: the URDF, for messages.
        mimics: joints that mimic others: of two pairs the one with fewer of them is the legs.

    Raises:
        HypothesisError: there is no such pair, there are several, or its feet cannot roll.
    """
    if full.njoints > MOST_JOINTS:
        raise HypothesisError(
            "HR1",
            f"{where}: {full.njoints - 2} movable joints, at most {MOST_JOINTS} are looked at;"
            ' make those that do not matter type="fixed"',
        )
    children = {full.parents[joint] for joint in range(2, full.njoints)}
    chains = [_chain(full, joint) for joint in range(2, full.njoints) if joint not in children]
    if len(chains) > MOST_CHAINS:
        raise HypothesisError(
            "HR1",
            f"{where}: {len(chains)} chains of movable joints, at most {MOST_CHAINS} are looked at;"
            ' make the joints that do not matter type="fixed"',
        )
    pairs = [_without_common(a, b) for a, b in itertools.combinations(chains, 2)]
    found = list(_mirrored_pairs(full, pairs))
    if not found:
        raise HypothesisError(
            "HR3",
            f"{where}: no two mirrored chains of joints hang down; a biped has a left and a right leg. If it has, name"
            " their roll joints in a description written by hand",
        )
    found = [pair for pair in found if not look_like_arms(full, pair.legs)] or found
    # the first rotation among those that reach about equally deep: identity, where it will do
    deepest = max(pair.reach for pair in found)
    lowest = [pair for pair in found if pair.reach > 0.9 * deepest]
    # names decide between forward and backward
    best = min(lowest, key=lambda pair: (not pair.legs.sides_named, pair.turn))
    rivals = [pair.legs for pair in lowest if pair.turn == best.turn]
    legs = _preferred(rivals, where, mimics)
    if len(legs.roll) < 2:
        have = f"only {legs.left[legs.roll[0]]!r}" if legs.roll else "none"
        raise HypothesisError(
            "HR5",
            f"{where}: a leg needs a roll joint at the hip and one at the ankle, of {', '.join(legs.left)} there is"
            f" {have}; point and line feet cannot hold the frontal plane. A joint rolls if its axis is within"
            f" {np.degrees(NEARLY_ALONG):.0f} degrees of X: one that is not can be named in a description with"
            " virtual_legs = true",
        )
    return legs


def named_legs(full: pin.Model, roll_joints: Mapping[str, str], where: str) -> Legs:
    """The legs whose hip and ankle roll joints somebody has named, whatever else hangs beside them.

    Args:
        full: 3D model with a free-flyer root.
        roll_joints: left_ankle, left_hip, right_hip, right_ankle.
        where: that names them, for messages.

    Raises:
        HypothesisError: an ankle does not hang from its hip, or the legs are no mirror images.
    """
    joint_id = {key: full.getJointId(name) for key, name in roll_joints.items()}
    left, right = _without_common(*(_chain(full, joint_id[f"{side}_ankle"]) for side in ("left", "right")))
    for side, chain in (("left", left), ("right", right)):
        for part in ("ankle", "hip"):
            joint = joint_id[f"{side}_{part}"]
            if joint not in chain or joint_id[f"{side}_hip"] not in _chain(full, joint):
                raise HypothesisError(
                    "HR1",
                    f"{where}: [joints] {side}_{part} = {roll_joints[f'{side}_{part}']!r} is not of the {side} leg:"
                    f" {', '.join(full.names[j] for j in chain)}; the ankle hangs from the hip, and neither moves the"
                    " other leg",
                )
    found = [pair for pair in _mirrored_pairs(full, [(left, right)]) if pair.legs.left[-1] == roll_joints["left_ankle"]]
    if not found:
        raise HypothesisError(
            "HR3",
            f"{where}: with all joints at zero, the joints down to {roll_joints['left_ankle']!r} and"
            f" {roll_joints['right_ankle']!r} are no mirror images that hang down, left on the left; check [joints]",
        )
    return max(found, key=lambda pair: (pair.reach, -pair.turn)).legs


def look_like_arms(full: pin.Model, legs: Legs) -> bool:
    """Do two chains hang above the centre of mass of all the rest, which outweighs them, as shoulders do?

    Legs that begin above it, below a pelvis with nothing on it, are heavier than what they carry.

    Args:
        full: 3D model with a free-flyer root.
        legs: the chains.
    """
    data = full.createData()
    q = _upright(full, legs.upright)
    pin.forwardKinematics(full, data, q)
    first = [full.getJointId(names[0]) for names in (legs.left, legs.right)]
    moved = {joint for hip in first for joint in full.subtrees[hip]}
    rest = [joint for joint in range(1, full.njoints) if joint not in moved]
    weight, carried = (sum(full.inertias[joint].mass for joint in joints) for joints in (rest, moved))
    if weight <= carried:
        return False
    height = sum(full.inertias[j].mass * data.oMi[j].act(full.inertias[j].lever)[2] for j in rest) / weight
    return bool(min(data.oMi[hip].translation[2] for hip in first) > height)


class _Pair(NamedTuple):
    """Two chains that are mirror images, the root turned upright by one of `_rotations`.

    Attributes:
        reach: of their ends below the centre of mass [m].
        turn: place of the rotation.
        legs: the chains.
    """

    reach: float
    turn: int
    legs: Legs


def _preferred(rivals: Sequence[Legs], where: str, mimics: Collection[str]) -> Legs:
    """Of pairs that reach equally low, those with an ankle that rolls, then those whose joints are motors.

    Raises:
        HypothesisError: several are left that differ in hip or ankle roll joint.
    """

    def rank(legs: Legs) -> tuple[bool, int]:
        return len(legs.roll) < 2, sum(name in mimics for name in legs.left + legs.right)

    best = min(map(rank, rivals))
    left = [legs for legs in rivals if rank(legs) == best]
    # toes beyond one ankle, several to a foot, make several chains of one leg
    ends = {
        frozenset(names[i] for names in (legs.left, legs.right) for i in (*legs.roll[:1], *legs.roll[-1:]))
        or frozenset(legs.left + legs.right)
        for legs in left
    }
    if len(ends) > 1:
        shown = " and ".join(f"{legs.left[0]} to {legs.left[-1]}" for legs in left)
        raise HypothesisError(
            "HR1",
            f"{where}: {len(ends)} pairs of legs reach the ground, {shown}; a biped has one: make the joints of the"
            ' other type="fixed", or name the four roll joints in a description and give it to'
            " `frontal-biped robots --posture`",
        )
    return left[0]


def _rotations() -> Iterator[FloatArray]:
    """The 24 turns of a cube; first none, about the vertical, and Y up, the usual ways to draw a robot."""
    quarter = [pin.rpy.rpyToMatrix(0.0, 0.0, 0.5 * np.pi * k) for k in (0, 2, 1, 3)]
    ups = [
        np.zeros(3),
        [0.5 * np.pi, 0, 0],
        [-0.5 * np.pi, 0, 0],
        [np.pi, 0, 0],
        [0, 0.5 * np.pi, 0],
        [0, -0.5 * np.pi, 0],
    ]
    for up, turn in itertools.product(ups, quarter):
        yield np.round(turn @ pin.rpy.rpyToMatrix(*np.asarray(up, dtype=float)))


def nearest_upright(rotation: FloatArray) -> FloatArray:
    """Of the 24 turns of a cube the one nearest to a (3, 3) rotation: a leaning root link, upright again."""
    return max(_rotations(), key=lambda turn: float(np.trace(turn.T @ rotation)))


def _upright(full: pin.Model, turn: FloatArray) -> FloatArray:
    """(nq,) all joints at zero, the root link turned."""
    q = pin.neutral(full)
    q[3:7] = pin.Quaternion(turn).coeffs()
    return q


def _mirrored_pairs(full: pin.Model, pairs: Sequence[tuple[list[int], list[int]]]) -> Iterator[_Pair]:
    """Of pairs of chains those that hang down as mirror images, for every way to turn the root upright.

    The middle plane is that between the chains, not that of the root link. It must lie nearer to the centre of mass
    than the feet do: so two fingers of one hand are no pair.
    """
    data = full.createData()
    for turn, upright in enumerate(_rotations()):
        q = _upright(full, upright)
        com = pin.centerOfMass(full, data, q)[:].copy()
        pin.computeJointJacobians(full, data, q)
        every = _Lines.of(full, data)
        for a, b in pairs:
            if len(a) != len(b) or not a:
                continue
            left, right = (b, a) if data.oMi[a[-1]].translation[1] < data.oMi[b[-1]].translation[1] else (a, b)
            lines = every.of_chain(left), every.of_chain(right)
            first, last = lines[0].points[0], lines[0].points[-1]
            middle = _middle(*lines)
            size = float(np.linalg.norm(last - first))
            half = float(last[1]) - middle
            reach = float(com[2] - last[2])
            if first[2] - last[2] < 0.5 * size or reach <= 0.0 or half < MIRRORED * size or abs(com[1] - middle) > half:
                continue
            if _off_mirror(*lines, middle) > MIRRORED * size + ROUNDING:
                continue
            names = tuple(full.names[joint] for joint in left), tuple(full.names[joint] for joint in right)
            axes = lines[0].axes
            yield _Pair(
                reach,
                turn,
                Legs(
                    upright,
                    *names,
                    roll=tuple(i for i, axis in enumerate(axes) if _along(axis, 0)),
                    pitch=tuple(i for i, axis in enumerate(axes) if _along(axis, 1)),
                    sides_named=all(_LEFT.search(n) for n in names[0]) and all(_RIGHT.search(n) for n in names[1]),
                ),
            )


class _Lines(NamedTuple):
    """The axes of joints.

    Attributes:
        points: (n, 3) the origins of the joints, one point of each axis.
        axes: (n, 3) unit vectors; zeros where a joint is no revolute one.
    """

    points: FloatArray
    axes: FloatArray

    @classmethod
    def of(cls, full: pin.Model, data: pin.Data) -> "_Lines":
        """Of all joints of a model, where its Jacobians have been computed."""
        joints = range(full.njoints)
        return cls(
            np.array([data.oMi[joint].translation for joint in joints]),
            np.array([_axis(full, data, joint) for joint in joints]),
        )

    def of_chain(self, chain: Sequence[int]) -> "_Lines":
        """Of some of the joints, in their order."""
        return _Lines(self.points[chain], self.axes[chain])


_MIRROR = np.array([1.0, -1.0, 1.0])


def _middle(left: _Lines, right: _Lines) -> float:
    """Y of the plane between two chains; where a pitch axis has its origin does not tell."""
    across = np.abs(left.axes[:, 1]) > np.cos(NEARLY_ALONG)
    told = ~across if not across.all() else across
    return 0.5 * float(np.mean((left.points + right.points)[told, 1]))


def _off_mirror(left: _Lines, right: _Lines, middle: float) -> float:
    """Largest distance between a joint of the left chain and the mirror image of the right one [m].

    Of two parallel axes that of the lines: wherever on its axis a joint has its origin, it turns the same.
    """
    offset = left.points - (right.points * _MIRROR + [0.0, 2.0 * middle, 0.0])
    axes = left.axes
    parallel = np.linalg.norm(np.cross(axes, right.axes * _MIRROR), axis=1) < NEARLY_PARALLEL
    along = np.where(parallel, np.sum(offset * axes, axis=1), 0.0)
    return float(np.linalg.norm(offset - along[:, None] * axes, axis=1).max())


def _chain(full: pin.Model, leaf: int) -> list[int]:
    chain = [leaf]
    while full.parents[chain[0]] > 1:
        chain.insert(0, full.parents[chain[0]])
    return chain


def _without_common(a: list[int], b: list[int]) -> tuple[list[int], list[int]]:
    shared = next((i for i, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), min(len(a), len(b)))
    return a[shared:], b[shared:]


def _axis(full: pin.Model, data: pin.Data, joint: int) -> FloatArray:
    if full.joints[joint].nv != 1 or not full.joints[joint].shortname().startswith("JointModelR"):
        return np.zeros(3)
    return pin.getJointJacobian(full, data, joint, pin.LOCAL_WORLD_ALIGNED)[3:, full.joints[joint].idx_v].copy()


def _along(axis: FloatArray, direction: int) -> bool:
    return bool(abs(axis[direction]) > np.cos(NEARLY_ALONG))
