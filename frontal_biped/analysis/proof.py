"""Proofs of a gait in ball arithmetic, on file with everything they rest on, to be checked without the search.

What is proved, under which hypotheses, and how: `zero_dynamics.proof.theorems`. ::

    certificate = prove("talos_full", "talos_full")
    certificate.save("talos.proof.json")
    verify("talos.proof.json")

A certificate is a JSON file:

==============  ====================================================================================================
``format``      "frontal-biped-proof"
``version``     1
``software``    versions of everything, python-flint's among them
``settings``    ``precision`` in bits, ``order`` of the Taylor polynomials
``gait``        the gait, as its file has it; its robot by name, description and fingerprint
``fixed``       zeros of Z at fixed parameters: ``region`` and ``zeros`` [rad], the partition ``pieces`` with the kind
                of each, verdicts ``counted`` and ``unique``
``reversal``    the zero of S near the plan: balls ``reversal`` [rad], ``slope``, ``multiplier``, verdicts ``proved``
                and ``stable``
``convergence`` of successive approximation: ``radius`` [rad], ball ``factor``, verdict ``proved``
``imposed``     all zeros of S: ``orders`` of the models, ``regions``, ``discs``, ``zeros`` and ``undecided`` [rad], the
                partition ``pieces`` of each region, verdicts ``counted`` and ``unique``
``attraction``  of successive approximation, from far: ``reach`` [rad], verdict ``proved``, and what it rests on,
                ``share`` and the intervals ``left``, ``middle`` and ``right`` [rad]; null where nothing was found
``limits``      C01 to C09 on the orbit: verdict ``proved``, ``cuts`` of the panels of the ``rising`` and the
                ``falling`` half, shares of the way from the reversal, null where there are none; and ``bounds``, each
                with ``code``, ``name``, ``unit``, ``lower``, ``upper``, ``strict`` and ``tolerance`` as it was asked,
                the ball ``margin``, and verdicts ``proved``, within the tolerance, and ``exactly``, without
``sha256``      of all the rest
==============  ====================================================================================================

A ball is {"mid": "m*2^e", "rad": "m*2^e"}, exactly; one that is not known is null. From before they were proved there
are files without ``imposed``, ``attraction``, ``limits`` and ``basin``, which make no such statements.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from frontal_biped.analysis.limits_proof import asked_bounds
from frontal_biped.exceptions import ProofError
from frontal_biped.files.atomic import write_json
from frontal_biped.files.kinds import PROOF
from frontal_biped.files.provenance import software_versions
from frontal_biped.files.reading import load_json
from frontal_biped.gait.file import gait_from_dict, gait_to_dict
from frontal_biped.gait.gait import Gait, converged_nodes
from frontal_biped.gait.given import GaitLike, gait_of
from frontal_biped.gait.robot_path import description_file, with_found_description, with_stored_description
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import RobotLike, biped_of
from frontal_biped.virtual_constraints.invariance import free_parameters
from frontal_biped.zero_dynamics.proof.attraction import Tiles
from frontal_biped.zero_dynamics.proof.balls import ORDER, PRECISION, Ball, as_text, from_text, working
from frontal_biped.zero_dynamics.proof.decimals import decimal_chain
from frontal_biped.zero_dynamics.proof.gait_proof import Asked, Evidence, GaitProof, Regions, prove_parameters
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.imposed_zeros import Partition
from frontal_biped.zero_dynamics.proof.limits import Cuts, ProvedLimits
from frontal_biped.zero_dynamics.proof.signs import Kind, Piece
from frontal_biped.zero_dynamics.proof.taylor_model import ORDERS
from frontal_biped.zero_dynamics.proof.theorems import Proof
from frontal_biped.zero_dynamics.reversal.problem import ReversalProblem
from frontal_biped.zero_dynamics.reversal.zeros import imposed_regions, regular_region

VERSION = 1
"""Of the file format."""

REMEDY = "prove the gait again with `frontal-biped analyze GAIT --prove`"


@dataclass(frozen=True)
class ProofCertificate:
    """What was proved of a gait, with the gait.

    Attributes:
        gait: the gait.
        proof: the statements.
    """

    gait: Gait
    proof: GaitProof

    def __repr__(self) -> str:
        return f"{type(self).__name__} of {self.gait.robot.name!r}\n{self}"

    def __str__(self) -> str:
        return "\n".join(f"{name:26} {text}" for name, text in self.proof.rows)

    def as_dict(self, folder: Path | None = None) -> dict[str, Any]:
        """Content of a certificate file in a folder; without one the robot is named as in memory."""
        gait: Mapping[str, Any] = gait_to_dict(self.gait)
        if folder is not None:
            gait = with_stored_description(gait, folder)
        fixed, zero, near = self.proof.fixed, self.proof.zero, self.proof.convergence
        imposed, far = self.proof.imposed, self.proof.attraction
        content: dict[str, Any] = {
            "format": PROOF,
            "version": VERSION,
            "software": software_versions() | {"python-flint": version("python-flint")},
            "settings": {"precision": PRECISION, "order": ORDER},
            "gait": gait,
            "fixed": {
                "region": list(fixed.region),
                "pieces": _pieces_listed(fixed.found.pieces),
                "zeros": _listed(fixed.found.zeros),
                "counted": fixed.counted.value,
                "unique": fixed.unique.value,
            },
            "reversal": {
                "reversal": _ball(zero.reversal),
                "slope": _ball(zero.slope),
                "multiplier": _ball(zero.multiplier),
                "proved": zero.proved.value,
                "stable": zero.stable.value,
            },
            "convergence": {"radius": near.radius, "factor": _ball(near.factor), "proved": near.proved.value},
            "imposed": {
                "orders": list(ORDERS),
                "regions": _listed(imposed.regions),
                "discs": _listed(imposed.discs),
                "pieces": [_pieces_listed(found.pieces) for found in imposed.found],
                "zeros": _listed(imposed.places),
                "undecided": _listed(imposed.undecided),
                "counted": imposed.counted.value,
                "unique": imposed.unique.value,
            },
            "attraction": {"proved": far.proved.value} | _tiles_listed(far.tiles),
            "limits": _limits_listed(self.proof.limits),
        }
        return content | {"sha256": _digest(content)}

    def converges_from(self, start: float) -> Proof:
        """Does the successive approximation of [O] Sec. III-D converge to this gait from a start [rad]?

        Each time the zero of Z is taken that is met first (`zero_dynamics.proof.attraction`).
        """
        return self.proof.attraction.converges_from(start)

    def save(self, path: Path | str) -> None:
        """Write the certificate file; whole or not at all."""
        write_json(Path(path), self.as_dict(Path(path).parent))


def prove(robot: RobotLike, gait: GaitLike) -> ProofCertificate:
    """Prove of a gait what `theorems` states.

    Args:
        robot: the robot, in any of its views, or by name or path.
        gait: the gait, a design's result, or by name or path.

    Raises:
        MissingExtraError: python-flint is not installed.
        ProofError: its final pose, or the impact there, is not known to exist.
        ReversalError: it has no bracket in which a reversal can lie.
        RobotError: there is no such robot.
        GaitFileError: there is no such gait.
    """
    biped, own = biped_of(robot), gait_of(gait)
    phases = own.rising, own.falling, own.step_width
    # the regions of the measured certificate: found by quadrature, then taken as exact
    problem = ReversalProblem.of_phases(biped, *phases, converged_nodes(biped, *phases))
    return _proved(biped, own, Regions(regular_region(problem), imposed_regions(problem)))


def _proved(biped: FrontalBiped, gait: Gait, regions: Regions, evidence: Evidence | None = None) -> ProofCertificate:
    free = free_parameters(gait.rising, gait.falling, gait.step_width)
    try:
        with working():
            asked = Asked(asked_bounds(biped, gait), biped.sole)
            return ProofCertificate(gait, prove_parameters(decimal_chain(biped), free, regions, asked, evidence))
    except NotEnclosedError as error:
        raise ProofError(f"{gait.robot.name}: {error}: the balls are too wide to tell whether it exists") from None


def verify(path: Path | str, robot: RobotLike | None = None, gait: GaitLike | None = None) -> ProofCertificate:
    """Check a certificate again, from the file alone: the partition is taken from it, every ball is computed afresh.

    Args:
        path: of the certificate.
        robot: the robot; default: the one that the gait in the certificate names.
        gait: must be the very gait of the certificate; default: not asked.

    Raises:
        ProofError: the certificate is none, was changed, is of another robot or gait, or does not hold.
        MissingExtraError: python-flint is not installed.
        RobotError: there is no such robot.
    """
    path = Path(path)
    stored = _read(path)
    own = gait_from_dict(with_found_description(stored["gait"], path.parent), f"{path}: gait")
    if gait is not None and _steps(gait_to_dict(gait_of(gait))) != _steps(stored["gait"]):
        raise ProofError(f"{path}: is about another gait; {REMEDY}")
    biped = biped_of(description_file(own.robot.description) if robot is None else robot)
    if biped.fingerprint != own.robot.fingerprint:
        raise ProofError(
            f"{path}: is about {own.robot.name} with another URDF or description than {biped.path.name}; {REMEDY}"
        )
    try:
        again = _proved(biped, own, *_stored_evidence(path, stored))
        _compare(path, stored, again.as_dict())
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise ProofError(f"{path}: not what a certificate holds ({error}); {REMEDY}") from None
    return again


def _stored_evidence(path: Path, stored: dict[str, Any]) -> tuple[Regions, Evidence]:
    fixed, imposed, far = stored["fixed"], stored.get("imposed", NO_IMPOSED), stored.get("attraction", NO_ATTRACTION)
    for group in _groups(stored):
        Proof(stored[group][VERDICTS[group]])
    regions = Regions(_interval(fixed["region"]), _intervals(imposed["regions"]))
    pieces = _pieces_read(fixed["pieces"])
    partition = Partition(
        _intervals(imposed["discs"]),
        tuple(_pieces_read(own) for own in imposed["pieces"]),
        _intervals(imposed["zeros"]),
    )
    _require_cover(path, "fixed", pieces, regions.fixed)
    if len(partition.pieces) != len(regions.imposed):
        raise ProofError(f"{path}: imposed.pieces are not of the regions; {REMEDY}")
    for region, own in zip(regions.imposed, partition.pieces, strict=True):
        _require_cover(path, "imposed", own, region)
    tiles = None
    if far["share"] is not None:
        tiles = Tiles(float(far["share"]), *(_intervals(far[name]) for name in ("left", "middle", "right")))
    cuts = stored.get("limits", NO_LIMITS)["cuts"]
    if cuts is not None:
        cuts = Cuts(*(tuple(float(cut) for cut in cuts[half]) for half in Cuts._fields))
    return regions, Evidence(pieces, partition, float(stored["convergence"]["radius"]), tiles, cuts)


VERDICTS = {
    "fixed": "counted",
    "reversal": "proved",
    "convergence": "proved",
    "imposed": "counted",
    "attraction": "proved",
    "limits": "proved",
    "basin": "proved",
}
"""Parts of a file that make statements, and one of the verdicts of each."""

OPTIONAL = ("imposed", "attraction", "limits", "basin")
"""Those that a file from before they were proved does not have."""

NO_IMPOSED: dict[str, Any] = {"regions": [], "discs": [], "pieces": [], "zeros": []}
NO_ATTRACTION: dict[str, Any] = {"share": None}
NO_LIMITS: dict[str, Any] = {"cuts": None}


def _groups(stored: dict[str, Any]) -> list[str]:
    """Parts that must hold."""
    return [group for group in VERDICTS if group in stored or group not in OPTIONAL]


def _require_cover(path: Path, group: str, pieces: tuple[Piece, ...], region: tuple[float, float]) -> None:
    ends = [region[0], *(piece.high for piece in pieces)]
    if [piece.low for piece in pieces] != ends[:-1] or ends[-1] != region[1]:
        raise ProofError(f"{path}: {group}.pieces do not cover the region; {REMEDY}")


def _interval(ends: Any) -> tuple[float, float]:
    low, high = ends
    return float(low), float(high)


def _intervals(listed: Any) -> tuple[tuple[float, float], ...]:
    return tuple(_interval(ends) for ends in listed)


def _listed(intervals: Iterable[tuple[float, float]]) -> list[list[float]]:
    return [list(ends) for ends in intervals]


def _pieces_read(listed: Any) -> tuple[Piece, ...]:
    return tuple(Piece(float(a), float(b), Kind(kind)) for a, b, kind in listed)


def _pieces_listed(pieces: Iterable[Piece]) -> list[list[Any]]:
    return [[a, b, kind.value] for a, b, kind in pieces]


def _tiles_listed(tiles: Tiles | None) -> dict[str, Any]:
    if tiles is None:
        return dict.fromkeys(("reach", "share", "left", "middle", "right"))
    parts = {"left": tiles.left, "middle": tiles.middle, "right": tiles.right}
    return {"reach": list(tiles.reach), "share": tiles.share} | {name: _listed(own) for name, own in parts.items()}


def _limits_listed(limits: ProvedLimits) -> dict[str, Any]:
    cuts = limits.cuts
    return {
        "proved": limits.proved.value,
        "cuts": None if cuts is None else {half: list(own) for half, own in cuts._asdict().items()},
        "bounds": [
            limit.bound._asdict()
            | {"margin": _ball(limit.margin), "proved": limit.proved.value, "exactly": limit.exactly.value}
            for limit in limits.limits
        ],
    }


def _read(path: Path) -> dict[str, Any]:
    try:
        stored = load_json(path, ProofError, REMEDY)
    except FileNotFoundError:
        raise ProofError(f"{path}: no such certificate; {REMEDY}") from None
    if not isinstance(stored, dict) or stored.get("format") != PROOF:
        raise ProofError(f'{path}: not a certificate, "format" is not {PROOF!r}; {REMEDY}')
    if stored.get("version") != VERSION:
        raise ProofError(f'{path}: "version" is not {VERSION}; {REMEDY}')
    content = {key: value for key, value in stored.items() if key != "sha256"}
    if stored.get("sha256") != _digest(content):
        raise ProofError(f"{path}: was changed since it was written (sha256); {REMEDY}")
    if content.get("settings") != {"precision": PRECISION, "order": ORDER}:
        raise ProofError(f"{path}: was proved with other settings than this program's; {REMEDY}")
    return stored


def _compare(path: Path, stored: dict[str, Any], again: dict[str, Any]) -> None:
    """Statements must be the same, balls must have a number in common."""
    for group in _groups(stored):
        for name, new in again[group].items():
            if not _same(stored[group][name], new):
                raise ProofError(f"{path}: {group}.{name} does not hold: computed again it is {_short(new)}")


def _same(value: Any, new: Any) -> bool:
    if isinstance(value, dict) and isinstance(new, dict):
        if value.keys() == new.keys() == {"mid", "rad"}:
            return bool(from_text(value).overlaps(from_text(new)))
        return value.keys() == new.keys() and all(_same(value[key], new[key]) for key in new)
    if isinstance(value, list) and isinstance(new, list):
        return len(value) == len(new) and all(_same(a, b) for a, b in zip(value, new, strict=True))
    return bool(value == new)


def _short(value: Any) -> str:
    ball = isinstance(value, dict) and value.keys() == {"mid", "rad"}
    return str(from_text(value)) if ball else str(value)[:80]


def _steps(table: dict[str, Any]) -> Any:
    return table.get("steps")


def _ball(ball: Ball) -> dict[str, str] | None:
    return as_text(ball) if ball.is_finite() else None


def _digest(content: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True, allow_nan=False).encode()).hexdigest()
