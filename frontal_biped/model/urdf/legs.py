"""Find the legs of a robot by looking at its joints: axes, sides and order, at the zero configuration.

Nothing is taken from names but left and right, and those only to tell forward from backward.
"""

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import HypothesisError

NEARLY_ALONG = np.radians(25.0)
"""A joint whose axis is this close to X rolls, whose axis is this close to Y pitches; g1 builds its roll axes 10
degrees off at zero."""

MIRRORED = 0.03
"""Two legs are a pair if their joints are mirror images to this fraction of the leg's length."""

MOST_JOINTS = 200
"""Movable joints that are looked at, two chains by two; a humanoid with fingers has 80."""

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


def find_legs(full: pin.Model, where: str) -> Legs:
    """The legs of a robot: the mirrored pair of joint chains that reaches lowest.

    Args:
        full: 3D model with a free-flyer root.
        where: the URDF, for messages.

    Raises:
        HypothesisError: there is no such pair, there are several, or its feet cannot roll.
    """
    if full.njoints > MOST_JOINTS:
        raise HypothesisError(
            "HR1",
            f"{where}: {full.njoints - 2} movable joints, at most {MOST_JOINTS} are looked at;"
            ' make those that do not matter type="fixed"',
        )
    found: list[tuple[float, int, Legs]] = []
    deepest = 0.0
    data = full.createData()
    for preference, upright in enumerate(_rotations()):
        for depth, legs in _pairs(full, data, upright):
            found.append((depth, preference, legs))
            deepest = max(deepest, depth)
    if not found:
        raise HypothesisError(
            "HR3",
            f"{where}: no two mirrored chains of joints hang below the root link; a biped has a left and a right leg",
        )
    # the first rotation among those that reach about equally deep: identity, where it will do
    lowest = [entry for entry in found if entry[0] > 0.9 * deepest]
    # names decide between forward and backward
    lowest.sort(key=lambda entry: (not entry[2].sides_named, entry[1]))
    best = lowest[0]
    rivals = {frozenset(entry[2].left + entry[2].right) for entry in lowest if entry[1] == best[1]}
    if len(rivals) > 1:
        raise HypothesisError("HR1", f"{where}: {len(rivals)} pairs of legs reach the ground; a biped has one")
    legs = best[2]
    if len(legs.roll) < 2:
        have = f"only {legs.left[legs.roll[0]]!r}" if legs.roll else "none"
        raise HypothesisError(
            "HR5",
            f"{where}: a leg needs a roll joint at the hip and one at the ankle, of {', '.join(legs.left)} there is"
            f" {have}; point and line feet cannot hold the frontal plane",
        )
    return legs


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


def _pairs(full: pin.Model, data: pin.Data, upright: FloatArray) -> Iterator[tuple[float, Legs]]:
    """Mirrored pairs of chains that hang down, and how deep, with the root turned upright."""
    q = pin.neutral(full)
    q[3:7] = pin.Quaternion(upright).coeffs()
    pin.forwardKinematics(full, data, q)
    pin.computeJointJacobians(full, data, q)
    children = {full.parents[joint] for joint in range(2, full.njoints)}
    chains = [_chain(full, joint) for joint in range(2, full.njoints) if joint not in children]
    for a, b in itertools.combinations(chains, 2):
        left, right = _without_common(a, b)
        if len(left) != len(right) or not left:
            continue
        p_left = np.array([data.oMi[joint].translation for joint in left])
        p_right = np.array([data.oMi[joint].translation for joint in right])
        if p_left[-1, 1] < p_right[-1, 1]:
            left, right, p_left, p_right = right, left, p_right, p_left
        depth = -float(p_left[-1, 2] - p_left[0, 2])
        size = float(np.linalg.norm(p_left[-1] - p_left[0]))
        off = np.abs(p_left - p_right * [1.0, -1.0, 1.0]).max()
        if depth < 0.5 * size or off > MIRRORED * size or p_left[-1, 1] < MIRRORED * size:
            continue
        ends = -float(p_left[-1, 2])
        if ends <= 0.0:
            continue  # above the root link: arms
        axes = [_axis(full, data, joint) for joint in left]
        names = tuple(full.names[joint] for joint in left), tuple(full.names[joint] for joint in right)
        yield (
            ends,
            Legs(
                upright,
                *names,
                roll=tuple(i for i, axis in enumerate(axes) if _along(axis, 0)),
                pitch=tuple(i for i, axis in enumerate(axes) if _along(axis, 1)),
                sides_named=all(_LEFT.search(n) for n in names[0]) and all(_RIGHT.search(n) for n in names[1]),
            ),
        )


def _chain(full: pin.Model, leaf: int) -> list[int]:
    chain = [leaf]
    while full.parents[chain[0]] > 1:
        chain.insert(0, full.parents[chain[0]])
    return chain


def _without_common(a: list[int], b: list[int]) -> tuple[list[int], list[int]]:
    shared = next((i for i, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), min(len(a), len(b)))
    return a[shared:], b[shared:]


def _axis(full: pin.Model, data: pin.Data, joint: int) -> FloatArray | None:
    if full.joints[joint].nv != 1 or not full.joints[joint].shortname().startswith("JointModelR"):
        return None
    return pin.getJointJacobian(full, data, joint, pin.LOCAL_WORLD_ALIGNED)[3:, full.joints[joint].idx_v].copy()


def _along(axis: FloatArray | None, direction: int) -> bool:
    return axis is not None and bool(abs(axis[direction]) > np.cos(NEARLY_ALONG))
