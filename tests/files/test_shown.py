"""What a notebook shows: every public object in a few lines, robots, gaits and runs as pages, reports as tables."""

import inspect
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import frontal_biped as fb
from frontal_biped.design.optimise import DesignResult
from frontal_biped.files.shown import PLOTTER, VIEWER, html_table
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.scenarios.expectations import Finding
from frontal_biped.scenarios.run import TrialResult
from frontal_biped.simulation.orbit import orbit_trajectory
from frontal_biped.simulation.space.run import SAMPLED, SpatialRun
from frontal_biped.zero_dynamics.proof.ankle_basin import no_ankle_basin
from frontal_biped.zero_dynamics.proof.attraction import Attraction, Tiles
from frontal_biped.zero_dynamics.proof.balls import arb
from frontal_biped.zero_dynamics.proof.basin import no_basin
from frontal_biped.zero_dynamics.proof.choices import no_choices
from frontal_biped.zero_dynamics.proof.gait_proof import GaitProof
from frontal_biped.zero_dynamics.proof.imposed_zeros import ImposedZeros
from frontal_biped.zero_dynamics.proof.limits import ProvedLimits
from frontal_biped.zero_dynamics.proof.signs import ProvedCount
from frontal_biped.zero_dynamics.proof.theorems import Convergence, FixedZeros, NearestZero, Proof

FEW_LINES, FEW_LETTERS = 8, 900

PROOF = GaitProof(
    FixedZeros((-1.6, -1.5), ProvedCount((), ((-1.56, -1.55),), ())),
    NearestZero(-1.55, arb(-1.55), arb(-20), arb(0.5), Proof.PROVED),
    Convergence(1e-6, arb(0.3), Proof.PROVED),
    ImposedZeros(((-1.6, -1.5),), (ProvedCount((), ((-1.56, -1.55),), ()),), ((-1.56, -1.55),), ((-1.6, -1.5),)),
    Attraction(Tiles(0.0, (), ((-1.56, -1.55),), ()), Proof.PROVED),
    ProvedLimits((), None),
    no_basin("the orbit is not enclosed"),
    no_choices("there is no table"),
    no_ankle_basin("the orbit is not enclosed"),
)


@pytest.fixture(scope="module")
def shown(biped, gait):
    """One of every public class, and of what public functions return."""
    run = orbit_trajectory(biped, gait, 2)
    analysis = fb.analyze(biped, gait, certify=False, in_space=False)
    zeros = {name: np.zeros((3, *{"q": (11,), "v": (10,), "tau": (4,), "com": (3,)}.get(name, ()))) for name in SAMPLED}
    joints = tuple(biped.description.joints.values())
    walk = SpatialRun(
        **zeros, event_t=np.zeros(0), event_kind=(), event_step=np.zeros(0), event_frontal=np.zeros((0, 8)),
        robot=biped.name, joint_names=joints, locked=(), outcome="completed", steps_completed=0,
    )  # fmt: skip
    finding = Finding("outcome", True, "outcome = completed, as expected", 0.0)
    objects = (
        biped, biped.robot, FreeRobot(biped.robot), gait, gait.specification, run, walk, fb.whole_motion(biped, run),
        analysis, analysis.constraints, DesignResult(gait, analysis.constraints, True, "found", 3, 4, 0.5),
        DesignResult(None, None, False, "no gait was found", 3, 4, 0.5), fb.view(biped),
        TrialResult("pushed", 0, 0, "ours", "completed", (finding,), {}, {}, 0.1, run), run.torques,
        fb.Scenario("pushed", Path("pushed.scenario.toml"), "A push."), fb.ProofCertificate(gait, PROOF),
    )  # fmt: skip
    return {type(thing).__name__: thing for thing in objects}


def test_every_public_object_says_what_it_is_in_a_few_lines(shown, biped):
    classes = {name for name in fb.__all__ if inspect.isclass(getattr(fb, name)) and not name.endswith("Error")}
    assert classes <= set(shown)
    for name, thing in shown.items():
        text = repr(thing)
        assert len(text.splitlines()) <= FEW_LINES and len(text) <= FEW_LETTERS, text
        assert "array(" not in text and " at 0x" not in text, text
        assert name in text or name in ("View", "Columns"), text
        assert str(biped.path.parent) not in text  # no path of this machine in a stored notebook


def test_a_specification_tells_what_was_asked_for_and_is_read_back():
    for spec in (fb.GaitSpecification(), fb.GaitSpecification(friction=0.5, max_torque=(9.0, 8.0, 8.0, 9.0))):
        assert eval(repr(spec), {"GaitSpecification": fb.GaitSpecification}) == spec
    assert repr(fb.GaitSpecification()) == "GaitSpecification()"


def test_robot_and_run_show_their_pages_drawn_once(shown):
    for name in ("Trajectory", "View"):
        frame = shown[name]._repr_html_()
        assert frame.startswith('<iframe srcdoc="&lt;!DOCTYPE html&gt;')
        assert 'sandbox="allow-scripts"' in frame
        assert 500_000 < len(frame) < 6_000_000
    assert shown["Trajectory"]._repr_html_() is shown["Trajectory"]._repr_html_()


def test_a_gait_shows_its_orbit_only_on_the_robot_it_was_designed_for(biped, gait):
    own = replace(gait, robot=replace(gait.robot, fingerprint=biped.fingerprint))
    assert "srcdoc" in own._repr_html_()
    other = replace(gait, robot=replace(gait.robot, fingerprint="of another"))
    assert other._repr_html_() is None  # the repr is shown
    with pytest.raises(fb.FrontalBipedError, match=r"with another URDF or description.*view\(gait, robot"):
        fb.view(other)
    assert fb.view(other, biped).title == "frontal_biped"


def test_a_run_of_a_robot_that_is_not_there_shows_its_repr(biped, gait):
    lost = replace(orbit_trajectory(biped, gait, 1), robot="nobody")
    assert lost._repr_html_() is None
    with pytest.raises(KeyError, match="no joint 'left_hip_joint'; did you mean 'left_hip'"):
        lost.torques["left_hip_joint"]


def test_reports_show_tables(shown):
    for name, words in (
        ("GaitAnalysis", "certificate"), ("ConstraintReport", "step width"), ("DesignResult", "no gait was found"),
        ("TrialResult", "as expected"),
    ):  # fmt: skip
        table = shown[name]._repr_html_()
        assert table.startswith("<table>") and words in table
        assert table.count("<tr>") == table.count("</tr>") >= 1
    rows = shown["ConstraintReport"]._repr_html_().count("<tr>")
    assert rows == 1 + len(shown["ConstraintReport"].checks)


def test_a_table_shows_texts_not_markup():
    assert "<td" in html_table([("a < b", "c")]) and "a &lt; b" in html_table([("a < b", "c")])


def test_what_is_looked_up_by_name_is_there():
    assert callable(import_module(VIEWER).view)
    assert callable(import_module(PLOTTER).plot)
