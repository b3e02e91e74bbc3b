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
``basin``       speeds after the impact that return under the stabiliser named, without looking ahead: ``low`` and
                ``high`` relative to the orbit's, ball ``factor`` of the energy error in a step, verdict ``proved``,
                ``looking_ahead``: low and high of "adaptive"; and what it rests on, ``beyond``, ``alike`` and ``tiles``
                [rad]; ``limited_by``: what stood in the way of lower and of higher speeds
``choices``     speeds after the impact that return under the answers of the gait's table, ``look_ahead``: ``low`` and
                ``high``, ball ``factor``, verdict ``proved``, "undecided" where there is no table; and what it rests
                on, ``tiles``: of intervals of the table, by their place, reversals before the end of the stretched
                rising phase [rad]; ``limited_by`` as of ``basin``
``ankle_basin`` those that return under "ankle": ``low`` and ``high``, ``at_once``: the high of those that one step
                brings to the orbit, ``steps`` after which all of them are there, verdict ``proved``; and what it rests
                on, ``outwards`` and ``inwards`` as shares of the room in the sole, ``stretched`` [rad]; ``limited_by``
``sha256``      of all the rest
==============  ====================================================================================================

A ball is {"mid": "m*2^e", "rad": "m*2^e"}, exactly; one that is not known is null. From before they were proved there
are files without ``imposed``, ``attraction``, ``limits``, ``basin``, ``choices`` and ``ankle_basin``, which make no
such statements.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

from frontal_biped.analysis.proof_content import REMEDY, evidence_from_dict, proof_to_dict, require_same
from frontal_biped.analysis.proof_inputs import ANKLE_RULE, asked_bounds, choices, perturbed_steps
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
from frontal_biped.zero_dynamics.proof.balls import ORDER, PRECISION, working
from frontal_biped.zero_dynamics.proof.decimals import decimal_chain
from frontal_biped.zero_dynamics.proof.gait_proof import Asked, Evidence, GaitProof, Regions, prove_parameters
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.theorems import Proof
from frontal_biped.zero_dynamics.reversal.problem import ReversalProblem
from frontal_biped.zero_dynamics.reversal.zeros import imposed_regions, regular_region

VERSION = 1
"""Of the file format."""


MOST_ROWS = 7
"""Of the statements that a certificate names where it is only shown."""


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
        verdicts = "\n".join(f"  {name}: {text.split(':')[0]}" for name, text in self.proof.rows[:MOST_ROWS])
        return f"{type(self).__name__} of {self.gait.robot.name!r}\n{verdicts}"

    def __str__(self) -> str:
        return "\n".join(f"{name:26} {text}" for name, text in self.proof.rows)

    def as_dict(self, folder: Path | None = None) -> dict[str, Any]:
        """Content of a certificate file in a folder; without one the robot is named as in memory."""
        gait: Mapping[str, Any] = gait_to_dict(self.gait)
        if folder is not None:
            gait = with_stored_description(gait, folder)
        content: dict[str, Any] = {
            "format": PROOF,
            "version": VERSION,
            "software": software_versions() | {"python-flint": version("python-flint")},
            "settings": {"precision": PRECISION, "order": ORDER},
            "gait": gait,
            **proof_to_dict(self.proof),
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
            steps = partial(perturbed_steps, biped, gait)
            asked = Asked(asked_bounds(biped, gait), biped.sole, steps, choices(biped, gait), ANKLE_RULE)
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
        again = _proved(biped, own, *evidence_from_dict(path, stored))
        require_same(path, stored, again.as_dict())
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise ProofError(f"{path}: not what a certificate holds ({error}); {REMEDY}") from None
    return again


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


def _steps(table: dict[str, Any]) -> Any:
    return table.get("steps")


def _digest(content: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True, allow_nan=False).encode()).hexdigest()
