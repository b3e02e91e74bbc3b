"""What a proof says and what it rests on, as JSON, and back; the keys: `analysis.proof`."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from frontal_biped.exceptions import ProofError
from frontal_biped.zero_dynamics.proof.ankle_basin import AnkleTiles, ProvedAnkleBasin
from frontal_biped.zero_dynamics.proof.attraction import Tiles
from frontal_biped.zero_dynamics.proof.balls import Ball, as_text, from_text
from frontal_biped.zero_dynamics.proof.basin import BasinTiles, ProvedBasin
from frontal_biped.zero_dynamics.proof.choices import ChoiceTiles, ProvedChoices
from frontal_biped.zero_dynamics.proof.gait_proof import Evidence, GaitProof, Regions
from frontal_biped.zero_dynamics.proof.imposed_zeros import Partition
from frontal_biped.zero_dynamics.proof.limits import Cuts, ProvedLimits
from frontal_biped.zero_dynamics.proof.signs import Kind, Piece
from frontal_biped.zero_dynamics.proof.taylor_model import ORDERS
from frontal_biped.zero_dynamics.proof.theorems import Proof

REMEDY = "prove the gait again with `frontal-biped analyze GAIT --prove`"

VERDICTS = {
    "fixed": "counted",
    "reversal": "proved",
    "convergence": "proved",
    "imposed": "counted",
    "attraction": "proved",
    "limits": "proved",
    "basin": "proved",
    "choices": "proved",
    "ankle_basin": "proved",
}
"""Parts of a file that make statements, and one of the verdicts of each."""

OPTIONAL = ("imposed", "attraction", "limits", "basin", "choices", "ankle_basin")
"""Those that a file from before they were proved does not have."""

NO_IMPOSED: dict[str, Any] = {"regions": [], "discs": [], "pieces": [], "zeros": []}
NO_ATTRACTION: dict[str, Any] = {"share": None}
NO_LIMITS: dict[str, Any] = {"cuts": None}
NO_BASIN: dict[str, Any] = {"tiles": None}
NO_ANKLE_BASIN: dict[str, Any] = {"stretched": None}


def proof_to_dict(proof: GaitProof) -> dict[str, Any]:
    """Statements and what they rest on, by the parts of a certificate file."""
    fixed, zero, near = proof.fixed, proof.zero, proof.convergence
    imposed, far = proof.imposed, proof.attraction
    return {
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
        "limits": _limits_listed(proof.limits),
        "basin": _basin_listed(proof.basin),
        "choices": _choices_listed(proof.choices),
        "ankle_basin": _ankle_basin_listed(proof.ankle_basin),
    }


def evidence_from_dict(path: Path, stored: dict[str, Any]) -> tuple[Regions, Evidence]:
    """What a certificate rests on.

    Args:
        path: of the file, for messages.
        stored: its content.

    Raises:
        ProofError: it does not cover the regions.
        KeyError: a part is missing, as TypeError, ValueError and AttributeError where it is none.
    """
    fixed, imposed, far = stored["fixed"], stored.get("imposed", NO_IMPOSED), stored.get("attraction", NO_ATTRACTION)
    for group in groups_of(stored):
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
    basin = stored.get("basin", NO_BASIN)
    if basin["tiles"] is not None:
        limited_by = str(basin["limited_by"][0]), str(basin["limited_by"][1])
        tiles_of = tuple(float(end) for end in basin["tiles"])
        basin = BasinTiles(float(basin["beyond"]), tiles_of, limited_by, float(basin["alike"]))
    else:
        basin = None
    choices = _choices_read(stored["choices"]) if "choices" in stored else None
    ankle = _ankle_tiles_read(stored.get("ankle_basin", NO_ANKLE_BASIN))
    radius = float(stored["convergence"]["radius"])
    return regions, Evidence(pieces, partition, radius, tiles, cuts, basin, choices, ankle)


def require_same(path: Path, stored: dict[str, Any], again: dict[str, Any]) -> None:
    """Statements must be the same, balls must have a number in common."""
    for group in groups_of(stored):
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


def groups_of(stored: dict[str, Any]) -> list[str]:
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


def _basin_listed(basin: ProvedBasin) -> dict[str, Any]:
    return {
        "proved": basin.proved.value,
        "stabiliser": "re-anchored",
        "low": basin.low,
        "high": basin.high,
        "looking_ahead": list(basin.looking_ahead),
        "factor": _ball(basin.factor),
        "beyond": basin.beyond,
        "alike": basin.alike,
        "tiles": list(basin.tiles),
        "limited_by": [basin.low_limited_by, basin.high_limited_by],
    }


def _choices_listed(choices: ProvedChoices) -> dict[str, Any]:
    return {
        "proved": choices.proved.value,
        "low": choices.low,
        "high": choices.high,
        "factor": _ball(choices.factor),
        "tiles": {str(place): list(ends) for place, ends in choices.tiles.items()},
        "limited_by": [choices.low_limited_by, choices.high_limited_by],
    }


def _choices_read(stored: dict[str, Any]) -> ChoiceTiles:
    tiles = {int(place): tuple(float(end) for end in ends) for place, ends in stored["tiles"].items()}
    low, high = (str(why) for why in stored["limited_by"])
    return ChoiceTiles(tiles, (low, high))


def _ankle_basin_listed(basin: ProvedAnkleBasin) -> dict[str, Any]:
    return {
        "proved": basin.proved.value,
        "low": basin.low,
        "high": basin.high,
        "at_once": basin.at_once,
        "steps": basin.steps,
    } | {name: list(own) for name, own in basin.tiles._asdict().items()}


def _ankle_tiles_read(table: dict[str, Any]) -> AnkleTiles | None:
    if table["stretched"] is None:
        return None
    outwards, inwards, stretched = (
        tuple(float(end) for end in table[name]) for name in ("outwards", "inwards", "stretched")
    )
    below, above = table["limited_by"]
    return AnkleTiles(outwards, inwards, stretched, (str(below), str(above)))


def _ball(ball: Ball) -> dict[str, str] | None:
    return as_text(ball) if ball.is_finite() else None
