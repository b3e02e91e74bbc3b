"""A gait: two phases, a step width, and the numbers of its periodic orbit. Read and written as JSON."""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import GaitFileError
from frontal_biped.files import write_text
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.poincare import HybridZeroDynamics, StepOrbit, step_orbit
from frontal_biped.toml_fields import as_finite
from frontal_biped.virtual_constraints.invariance import invariance_residuals
from frontal_biped.virtual_constraints.phase import Phase

FORMAT, VERSION = "frontal-biped-gait", 1

QUADRATURE_ACCURACY = 1e-11
"""Relative change of zeta at the impact, duration and cost on doubling the nodes that counts as converged."""

MIN_NODES, MAX_NODES = 16, 128


@dataclass(frozen=True)
class RobotReference:
    """Which robot a gait was designed for.

    Attributes:
        name: of the description.
        description: its file name.
        fingerprint: SHA-256 of URDF and description.
    """

    name: str
    description: str
    fingerprint: str


@dataclass(frozen=True)
class OrbitNumbers:
    """The periodic orbit in five numbers.

    Attributes:
        beta_dot_after_impact: dbeta_r+ [rad/s].
        zeta_f_star: fixed point of the Poincare map [kg^2 m^4/s^2].
        step_duration: [s].
        cost: J [N^2 m s].
        multiplier: slope of the Poincare map [-].
    """

    beta_dot_after_impact: float
    zeta_f_star: float
    step_duration: float
    cost: float
    multiplier: float


@dataclass(frozen=True)
class Gait:
    """A gait, ready for the controller.

    Attributes:
        robot: which robot.
        rising: virtual constraints from impact to reversal.
        falling: virtual constraints from reversal to impact.
        step_width: distance between the ankles [m].
        orbit: the periodic orbit.
        specification: what it was designed for, as in a specification file.
        provenance: versions, seed, solver status, residuals.
    """

    robot: RobotReference
    rising: Phase
    falling: Phase
    step_width: float
    orbit: OrbitNumbers
    specification: Mapping[str, Any] = field(default_factory=dict)
    provenance: Mapping[str, Any] = field(default_factory=dict)

    @property
    def beta_reversal(self) -> float:
        """beta_r- [rad]."""
        return self.rising.beta_end

    def step(self, biped: FrontalBiped, nodes: int | None = None) -> StepOrbit:
        """The step of the zero dynamics; by default on as many nodes as `converged_nodes` finds necessary."""
        size = converged_nodes(biped, self.rising, self.falling, self.step_width) if nodes is None else nodes
        return step_orbit(biped, self.rising, self.falling, self.step_width, size)

    def state_after_impact(self) -> tuple[FloatArray, FloatArray]:
        """(q, dq) at the start of the rising phase on the periodic orbit, (4,) [rad] and (4,) [rad/s]."""
        motion = self.rising.motion(np.array([self.rising.beta_start]))
        return motion.q[0], motion.dq[0] * self.orbit.beta_dot_after_impact

    def residuals(self, biped: FrontalBiped, step: StepOrbit | None = None) -> dict[str, float]:
        """How far the gait is from being one; every entry should be below 1e-9.

        Invariance at impact and reversal (see `invariance_residuals`), the energy balance of a step (the fixed point
        against the energy integrated from the reversal, relative) and the stored orbit against a new integration.

        Args:
            biped: the robot.
            step: the integrated step, where it is at hand.
        """
        step = step or self.step(biped)
        hzd = HybridZeroDynamics(biped, step)
        zeta_f = hzd.rho_f(0.0)  # released at rest from the reversal
        residuals = invariance_residuals(biped, self.rising, self.falling, self.step_width)
        residuals["energy_balance"] = abs(hzd.rho_r(zeta_f)) / abs(hzd.barrier_r)
        fresh = orbit_numbers(biped, step)
        residuals["stored_orbit"] = max(
            abs(a - b) / abs(b) for a, b in zip(asdict(self.orbit).values(), asdict(fresh).values(), strict=True)
        )
        return residuals


def orbit_numbers(biped: FrontalBiped, step: StepOrbit) -> OrbitNumbers:
    """The periodic orbit of a step in five numbers."""
    hzd = HybridZeroDynamics(biped, step)
    return OrbitNumbers(hzd.speed_after_impact, hzd.fixed_point, float(step.duration), float(step.cost), hzd.multiplier)


def quadrature_error(biped: FrontalBiped, rising: Phase, falling: Phase, step_width: float, nodes: int) -> float:
    """Largest relative change of zeta at both ends, duration, cost and multiplier from ``nodes`` to twice as many."""

    def figures(size: int) -> FloatArray:
        step = step_orbit(biped, rising, falling, step_width, size)
        return np.array([step.rising.z[-1], step.falling.z[-1], step.duration, step.cost, step.multiplier])

    coarse, fine = figures(nodes), figures(2 * nodes)
    error = float(np.max(np.abs(coarse - fine) / np.abs(fine)))
    return error if math.isfinite(error) else math.inf


def converged_nodes(biped: FrontalBiped, rising: Phase, falling: Phase, step_width: float) -> int:
    """Fewest quadrature nodes a phase, from 16 up in steps of 8, whose measured error is below `QUADRATURE_ACCURACY`.

    Where rounding keeps the error above that, or the orbit does not exist, `MAX_NODES`.
    """
    for nodes in range(MIN_NODES, MAX_NODES, 8):
        if quadrature_error(biped, rising, falling, step_width, nodes) < QUADRATURE_ACCURACY:
            return nodes
    return MAX_NODES


# ---------------------------------------------------------------------- file
def save_gait(gait: Gait, path: Path | str) -> None:
    """Write a gait file (JSON); numbers round-trip exactly, and the file appears whole or not at all."""
    write_text(Path(path), json.dumps(gait_to_dict(gait), indent=1, allow_nan=False) + "\n")


def gait_to_dict(gait: Gait) -> dict[str, Any]:
    """Content of a gait file."""
    return {
        "format": FORMAT,
        "version": VERSION,
        "robot": asdict(gait.robot),
        "rising": _phase_to_dict(gait.rising),
        "falling": _phase_to_dict(gait.falling),
        "step_width": gait.step_width,
        "orbit": asdict(gait.orbit),
        "specification": dict(gait.specification),
        "provenance": dict(gait.provenance),
    }


def load_gait(path: Path | str) -> Gait:
    """Read a gait file.

    Raises:
        GaitFileError: the file is missing, not JSON, of another format or version, or a field is absent, unknown, of
            the wrong type or shape, or not finite. The message names file, field, value and remedy.
    """
    return gait_from_dict(_load_json(Path(path)), str(path))


def gait_from_dict(table: Any, where: str) -> Gait:
    """Gait from the content of a gait file; ``where`` begins every complaint.

    Raises:
        GaitFileError: as `load_gait`.
    """
    if not isinstance(table, dict) or table.get("format") != FORMAT:
        raise GaitFileError(
            f'{where}: not a gait file, "format" is not {FORMAT!r}; write one with `frontal-biped design`'
        )
    if isinstance(table.get("version"), bool) or table.get("version") != VERSION:  # JSON's true equals 1 in Python
        raise GaitFileError(
            f'{where}: "version" is {table.get("version")!r}, this program reads {VERSION}; design it again'
        )
    reader = _Reader(where)
    known = ("format", "version", "robot", "rising", "falling", "step_width", "orbit", "specification", "provenance")
    reader.no_others("", table, known)
    robot = reader.table(table, "robot", ("name", "description", "fingerprint"))
    orbit = reader.table(table, "orbit", tuple(OrbitNumbers.__dataclass_fields__))
    rising, falling = (reader.phase(table, name) for name in ("rising", "falling"))
    if not rising.beta_start < rising.beta_end:
        raise GaitFileError(f"{where}: rising: beta_start must be below beta_end, rising means dbeta > 0")
    if not falling.beta_start > falling.beta_end:
        raise GaitFileError(f"{where}: falling: beta_start must be above beta_end, falling means dbeta < 0")
    step_width = reader.number(table, "", "step_width")
    if step_width <= 0.0:
        raise GaitFileError(f"{where}: step_width = {step_width:g} m must be positive")
    return Gait(
        RobotReference(*(reader.text(robot, "robot", key) for key in ("name", "description", "fingerprint"))),
        rising,
        falling,
        step_width,
        OrbitNumbers(*(reader.number(orbit, "orbit", key) for key in OrbitNumbers.__dataclass_fields__)),
        reader.table(table, "specification", None),
        reader.table(table, "provenance", None),
    )


def _phase_to_dict(phase: Phase) -> dict[str, Any]:
    return {
        "beta_start": phase.beta_start,
        "beta_end": phase.beta_end,
        "joint_bezier": phase.joint_bezier.tolist(),
        "fri_bezier": phase.fri_bezier.tolist(),
    }


def _load_json(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise GaitFileError(
            f"{path}: no such gait file; write one with `frontal-biped design -o {path.name}`"
        ) from None
    except IsADirectoryError:
        raise GaitFileError(f"{path}: a directory; name the gait file in it") from None
    except (json.JSONDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise GaitFileError(f"{path}: not valid JSON, {error}; is the file cut off? design the gait again") from None


class _Reader:
    """Checked access to the fields of a gait file; every complaint names file, field and value."""

    def __init__(self, where: str) -> None:
        self.where = where

    def no_others(self, section: str, table: dict[str, Any], known: tuple[str, ...]) -> None:
        for key in table:
            if key not in known:
                place = f"{section}: " if section else ""
                raise GaitFileError(f"{self.where}: {place}unknown field {key!r}; known fields: {', '.join(known)}")

    def table(self, parent: dict[str, Any], key: str, known: tuple[str, ...] | None) -> dict[str, Any]:
        if not isinstance(parent.get(key), dict):
            raise GaitFileError(f"{self.where}: field {key!r} is missing or not an object; design the gait again")
        table: dict[str, Any] = parent[key]
        if known is not None:
            self.no_others(key, table, known)
        return table

    def text(self, table: dict[str, Any], section: str, key: str) -> str:
        if not isinstance(table.get(key), str):
            raise GaitFileError(f"{self.where}: {section}.{key} = {table.get(key)!r} is not text")
        return str(table[key])

    def number(self, table: dict[str, Any], section: str, key: str) -> float:
        name = f"{section}.{key}" if section else key
        value = as_finite(table.get(key))
        if value is None:
            raise GaitFileError(f"{self.where}: {name} = {_short(table.get(key))} is not a finite number")
        return value

    def phase(self, table: dict[str, Any], name: str) -> Phase:
        fields = self.table(table, name, ("beta_start", "beta_end", "joint_bezier", "fri_bezier"))
        joints, fri = self.array(fields, name, "joint_bezier"), self.array(fields, name, "fri_bezier")
        if joints.ndim != 2 or joints.shape[0] != 3 or joints.shape[1] < 4:
            raise GaitFileError(
                f"{self.where}: {name}.joint_bezier has shape {joints.shape}, not 3 rows (stance hip, swing hip,"
                " swing ankle) of at least 4 coefficients"
            )
        if fri.ndim != 1 or fri.size < 2:
            raise GaitFileError(f"{self.where}: {name}.fri_bezier has shape {fri.shape}, not one row of at least 2")
        return Phase(self.number(fields, name, "beta_start"), self.number(fields, name, "beta_end"), joints, fri)

    def array(self, table: dict[str, Any], section: str, key: str) -> FloatArray:
        name = f"{self.where}: {section}.{key}"
        value = table.get(key)
        rows = value if isinstance(value, list) else []
        nested = [row if isinstance(row, list) else [row] for row in rows]
        if not rows or len({(isinstance(row, list), len(flat)) for row, flat in zip(rows, nested, strict=True)}) != 1:
            raise GaitFileError(f"{name} is not an array of numbers with rows of equal length")
        for entry in (entry for flat in nested for entry in flat):
            if as_finite(entry) is None:
                raise GaitFileError(f"{name} holds {_short(entry)}, which is not a finite number; write plain numbers")
        return np.array(rows, dtype=float)


def _short(value: object) -> str:
    return repr(value)[:40]
