"""Gait files: exact round trips, atomic writing, and every malformed file refused in one line."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from frontal_biped.exceptions import GaitFileError
from frontal_biped.gait.file import load_gait, save_gait
from frontal_biped.gait.gait import converged_nodes, quadrature_error
from frontal_biped.gait.ranges import GAIT as RANGES
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.zero_dynamics.poincare import step_orbit

RESIDUAL = 1e-9
"""What a gait may be off from being one."""


@pytest.fixture
def gait_file(reference_gait, tmp_path):
    path = tmp_path / "gait.json"
    save_gait(reference_gait, path)
    return path


class TestRoundTrip:
    def test_every_number_is_kept_exactly(self, reference_gait, gait_file):
        loaded = load_gait(gait_file)
        for name in ("rising", "falling"):
            before, after = getattr(reference_gait, name), getattr(loaded, name)
            assert (after.beta_start, after.beta_end) == (before.beta_start, before.beta_end)
            assert np.array_equal(after.joint_bezier, before.joint_bezier)
            assert np.array_equal(after.fri_bezier, before.fri_bezier)
        assert loaded.step_width == reference_gait.step_width
        assert loaded.orbit == reference_gait.orbit
        assert loaded.robot == reference_gait.robot
        assert loaded.specification == reference_gait.specification
        assert dict(loaded.provenance) == dict(reference_gait.provenance)

    def test_saved_again_byte_for_byte(self, gait_file, tmp_path):
        again = tmp_path / "again.json"
        save_gait(load_gait(gait_file), again)
        assert again.read_bytes() == gait_file.read_bytes()

    def test_awkward_numbers(self, reference_gait, tmp_path):
        """Neighbours of round numbers, the smallest and the largest: text must not round them."""
        largest = np.nextafter(RANGES["fri_bezier"].high, 0.0)
        awkward = np.array([np.nextafter(0.1, 1.0), 1.0 / 3.0, 5e-324, -largest, -0.0])
        rising = replace(reference_gait.rising, fri_bezier=awkward)
        path = tmp_path / "awkward.json"
        save_gait(replace(reference_gait, rising=rising), path)
        loaded = load_gait(path).rising.fri_bezier
        assert loaded.tobytes() == awkward.tobytes()

    @pytest.mark.parametrize(
        ("table", "expected"),
        [({}, GaitSpecification()), ({"friction": 0.3, "degree": 6}, GaitSpecification(friction=0.3, degree=6))],
    )
    def test_what_a_specification_leaves_out_is_the_default(self, gait_file, table, expected):
        content = json.loads(gait_file.read_text(encoding="utf-8"))
        gait_file.write_text(json.dumps(content | {"specification": table}), encoding="utf-8")
        loaded = load_gait(gait_file)
        assert loaded.specification == expected
        save_gait(loaded, gait_file)
        assert json.loads(gait_file.read_text(encoding="utf-8"))["specification"] == expected.as_dict()

    def test_loaded_gait_is_still_one(self, biped, gait_file):
        residuals = load_gait(gait_file).residuals(biped)
        assert max(residuals.values()) < RESIDUAL, residuals

    def test_layout_of_the_file(self, gait_file, biped):
        content = json.loads(gait_file.read_text(encoding="utf-8"))
        assert list(content) == [
            "format", "version", "robot", "steps", "specification", "provenance",
        ]  # fmt: skip
        assert (content["format"], content["version"]) == ("frontal-biped-gait", 2)
        assert content["robot"]["fingerprint"] == biped.fingerprint
        (step,) = content["steps"]
        assert list(step) == ["rising", "falling", "step_width", "orbit"]
        assert len(step["rising"]["joint_bezier"]) == 3
        assert set(step["orbit"]) == {
            "beta_dot_after_impact", "zeta_f_star", "step_duration", "cost", "multiplier",
        }  # fmt: skip
        assert {"versions", "seed", "solver", "residuals"} <= set(content["provenance"])


class TestResiduals:
    @pytest.mark.parametrize("name", ["reference_gait", "level_gait"])
    def test_designed_gait_is_one(self, biped, name, request):
        residuals = request.getfixturevalue(name).residuals(biped)
        assert max(residuals.values()) < RESIDUAL, residuals

    def test_a_moved_coefficient_shows(self, biped, reference_gait):
        for phase, expected in (("rising", "impact_slope"), ("falling", "reversal_slope")):
            original = getattr(reference_gait, phase)
            moved = original.joint_bezier.copy()
            moved[1, 1] += 1e-4
            broken = replace(reference_gait, **{phase: replace(original, joint_bezier=moved)})
            assert broken.residuals(biped)[expected] > RESIDUAL

    def test_another_energy_shows(self, biped, reference_gait):
        """A free coefficient keeps the invariance but not the energy balance, nor the stored orbit."""
        moved = reference_gait.rising.joint_bezier.copy()
        moved[0, 2] += 1e-3
        residuals = replace(reference_gait, rising=replace(reference_gait.rising, joint_bezier=moved)).residuals(biped)
        assert residuals["impact_slope"] < RESIDUAL
        assert residuals["energy_balance"] > RESIDUAL
        assert residuals["stored_orbit"] > RESIDUAL

    def test_stored_orbit_is_compared(self, biped, reference_gait):
        for field in ("beta_dot_after_impact", "zeta_f_star", "step_duration", "cost", "multiplier"):
            value = getattr(reference_gait.orbit, field) * (1.0 + 1e-6)
            told = replace(reference_gait, orbit=replace(reference_gait.orbit, **{field: value}))
            assert told.residuals(biped)["stored_orbit"] == pytest.approx(1e-6, rel=1e-2)

    def test_nodes_are_as_many_as_needed(self, biped, reference_gait):
        parts = (reference_gait.rising, reference_gait.falling, reference_gait.step_width)
        nodes = converged_nodes(biped, *parts)
        assert quadrature_error(biped, *parts, nodes) < 1e-11
        assert quadrature_error(biped, *parts, 8) > 1e-11
        assert step_orbit(biped, *parts, nodes).cost == pytest.approx(reference_gait.orbit.cost, rel=1e-11)


class TestAtomic:
    """A gait file is there whole or not at all, and nothing else stays behind."""

    def test_failure_while_writing(self, reference_gait, tmp_path, monkeypatch):
        def full_disk(self, text, **_):
            with self.open("w") as stream:
                stream.write(text[:100])
            raise OSError("no space left on device")

        monkeypatch.setattr("pathlib.Path.write_text", full_disk)
        with pytest.raises(OSError, match="no space"):
            save_gait(reference_gait, tmp_path / "gait.json")
        assert list(tmp_path.iterdir()) == []

    def test_failure_while_renaming_keeps_the_old_file(self, reference_gait, gait_file, monkeypatch):
        before = gait_file.read_bytes()

        def refused(self, target):
            raise PermissionError("refused")

        monkeypatch.setattr("pathlib.Path.replace", refused)
        with pytest.raises(PermissionError):
            save_gait(replace(reference_gait, step_width=0.3), gait_file)
        assert gait_file.read_bytes() == before
        assert list(gait_file.parent.iterdir()) == [gait_file]

    def test_number_that_json_cannot_say(self, reference_gait, gait_file):
        before = gait_file.read_bytes()
        with pytest.raises(ValueError, match=r"(?i)json|nan|float"):
            save_gait(replace(reference_gait, step_width=float("nan")), gait_file)
        assert gait_file.read_bytes() == before
        assert list(gait_file.parent.iterdir()) == [gait_file]

    def test_folder_is_made(self, reference_gait, tmp_path):
        path = tmp_path / "new" / "folder" / "gait.json"
        save_gait(reference_gait, path)
        assert load_gait(path).orbit == reference_gait.orbit


STEP = ("rising", "falling", "step_width", "orbit")
"""Fields of a step, in version 1 beside the others."""


def of_version_1(content):
    """The same content as version 1 wrote it."""
    (step,) = content.pop("steps")
    return {**content, "version": 1, **step}


def edit(*keys, value=None, remove=False):
    """A change deep in the content of a gait file, of either version."""

    def change(content):
        if keys[0] in STEP and "steps" in content:
            content = content["steps"][0]
        for key in keys[:-1]:
            content = content[key]
        if remove:
            del content[keys[-1]]
        else:
            content[keys[-1]] = value

    return change


NUMBERS = [0.0, 0.1, 0.2, 0.3]

# what is wrong: (change, words of the message)
MALFORMED = {
    "another format": (edit("format", value="gait"), ("format", "frontal-biped-gait")),
    "no format": (edit("format", remove=True), ("format",)),
    "later version": (edit("version", value=3), ("version", "3", "1 and 2")),
    "version as text": (edit("version", value="1"), ("version", "'1'")),
    "version as a truth value": (edit("version", value=True), ("version", "True")),
    "unknown field": (edit("colour", value="red"), ("colour", "known fields")),
    "unknown field of the robot": (edit("robot", "height", value=1.0), ("robot", "height")),
    "unknown field of a phase": (edit("rising", "speed", value=1.0), ("rising", "speed")),
    "unknown field of the orbit": (edit("orbit", "energy", value=1.0), ("orbit", "energy")),
    "robot missing": (edit("robot", remove=True), ("robot",)),
    "robot a text": (edit("robot", value="frontal_biped"), ("robot",)),
    "name a number": (edit("robot", "name", value=3), ("robot.name", "3", "text")),
    "fingerprint missing": (edit("robot", "fingerprint", remove=True), ("robot.fingerprint", "text")),
    "phase missing": (edit("falling", remove=True), ("falling",)),
    "phase a list": (edit("rising", value=[1, 2]), ("rising",)),
    "beta missing": (edit("rising", "beta_start", remove=True), ("rising.beta_start", "finite number")),
    "beta a text": (edit("rising", "beta_end", value="-1.5"), ("rising.beta_end", "-1.5", "finite number")),
    "beta a truth value": (edit("rising", "beta_end", value=True), ("rising.beta_end", "True")),
    "rising that falls": (edit("rising", "beta_end", value=-3.0), ("rising", "below beta_end")),
    "falling that rises": (edit("falling", "beta_end", value=0.0), ("falling", "above beta_end")),
    "joints missing": (edit("rising", "joint_bezier", remove=True), ("rising.joint_bezier",)),
    "two joints": (edit("rising", "joint_bezier", value=[NUMBERS] * 2), ("rising.joint_bezier", "(2, 4)", "3 rows")),
    "four joints": (edit("falling", "joint_bezier", value=[NUMBERS] * 4), ("falling.joint_bezier", "3 rows")),
    "too few columns": (edit("rising", "joint_bezier", value=[[0.0, 1.0]] * 3), ("joint_bezier", "(3, 2)")),
    "ragged joints": (
        edit("rising", "joint_bezier", value=[NUMBERS, NUMBERS, [0.0]]),
        ("rising.joint_bezier", "equal length"),
    ),
    "flat joints": (edit("rising", "joint_bezier", value=NUMBERS), ("rising.joint_bezier", "3 rows")),
    "joints a text": (edit("rising", "joint_bezier", value="none"), ("rising.joint_bezier",)),
    "a word among the joints": (
        edit("rising", "joint_bezier", 0, 0, value="bent"),
        ("rising.joint_bezier", "numbers"),
    ),
    "a number as text among the joints": (
        edit("rising", "joint_bezier", 0, 0, value="-1.5"),
        ("rising.joint_bezier", "numbers"),
    ),
    "a hole among the joints": (edit("rising", "joint_bezier", 0, 0, value=None), ("rising.joint_bezier",)),
    "NaN among the joints": (edit("rising", "joint_bezier", 1, 2, value=float("nan")), ("joint_bezier", "finite")),
    "NaN in the FRI": (edit("falling", "fri_bezier", 0, value=float("nan")), ("falling.fri_bezier", "finite")),
    "infinite FRI": (edit("falling", "fri_bezier", 0, value=float("inf")), ("falling.fri_bezier", "finite")),
    "FRI of one number": (edit("falling", "fri_bezier", value=[0.0]), ("falling.fri_bezier", "(1,)")),
    "FRI empty": (edit("falling", "fri_bezier", value=[]), ("falling.fri_bezier",)),
    "FRI nested": (edit("falling", "fri_bezier", value=[NUMBERS]), ("falling.fri_bezier", "one row")),
    "width missing": (edit("step_width", remove=True), ("step_width", "finite number")),
    "width negative": (edit("step_width", value=-0.2), ("step_width = -0.2", "positive")),
    "width zero": (edit("step_width", value=0), ("step_width = 0", "positive")),
    "width NaN": (edit("step_width", value=float("nan")), ("step_width", "finite number")),
    "width beyond any float": (edit("step_width", value=10**400), ("step_width", "finite number")),
    "orbit missing": (edit("orbit", remove=True), ("orbit",)),
    "cost missing": (edit("orbit", "cost", remove=True), ("orbit.cost", "finite number")),
    "multiplier a text": (edit("orbit", "multiplier", value="0.7"), ("orbit.multiplier", "0.7")),
    "specification missing": (edit("specification", remove=True), ("specification",)),
    "specification a list": (edit("specification", value=[]), ("specification",)),
    "unknown key of the specification": (
        edit("specification", "frction", value=0.6),
        ("specification: unknown key 'frction'", "did you mean 'friction'"),
    ),
    "friction a text": (edit("specification", "friction", value="high"), ("specification: friction", "high")),
    "friction negative": (edit("specification", "friction", value=-0.6), ("specification: friction = -0.6",)),
    "three torque limits": (
        edit("specification", "max_torque", value=[40.0, 90.0, 90.0]),
        ("specification: max_torque", "list of 4 numbers"),
    ),
    "a width that is no range": (edit("specification", "step_width", value=[0.3, 0.2]), ("step_width", "range")),
    "provenance missing": (edit("provenance", remove=True), ("provenance",)),
}


def refusal(path):
    with pytest.raises(GaitFileError) as caught:
        load_gait(path)
    message = str(caught.value)
    assert "\n" not in message
    assert path.name in message
    return message


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("case", MALFORMED)
def test_malformed_file(gait_file, case, version):
    change, words = MALFORMED[case]
    content = json.loads(gait_file.read_text(encoding="utf-8"))
    if version == 1:
        content = of_version_1(content)
    change(content)
    gait_file.write_text(json.dumps(content), encoding="utf-8")
    message = refusal(gait_file)
    for word in words:
        assert re.search(re.escape(word), message), f"{word!r} is not in {message!r}"


MALFORMED_LISTS = {
    "no list": ({}, ("'steps'", "list")),
    "nothing in it": ([], ("'steps'", "one step or of two")),
    "three": ([1, 2, 3], ("'steps'", "one step or of two")),
    "no object": ([3], ("steps[0] = 3", "object")),
    "null": (None, ("'steps'",)),
}


@pytest.mark.parametrize("case", MALFORMED_LISTS)
def test_malformed_list_of_steps(gait_file, case):
    value, words = MALFORMED_LISTS[case]
    content = json.loads(gait_file.read_text(encoding="utf-8"))
    gait_file.write_text(json.dumps(content | {"steps": value}), encoding="utf-8")
    message = refusal(gait_file)
    for word in words:
        assert word in message


def test_version_1_says_the_same(reference_gait, gait_file):
    content = json.loads(gait_file.read_text(encoding="utf-8"))
    gait_file.write_text(json.dumps(of_version_1(content)), encoding="utf-8")
    loaded = load_gait(gait_file)
    assert loaded.orbit == reference_gait.orbit
    assert loaded.specification == reference_gait.specification
    assert loaded.rising.joint_bezier.tobytes() == reference_gait.rising.joint_bezier.tobytes()
    assert loaded.falling.fri_bezier.tobytes() == reference_gait.falling.fri_bezier.tobytes()
    assert loaded.step_width == reference_gait.step_width


@pytest.mark.parametrize("content", ["", "{", "[]", "3", "null", '"gait"', "not json", "[" * 100_000])
def test_not_a_gait(tmp_path, content):
    path = tmp_path / "gait.json"
    path.write_text(content)
    refusal(path)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.999])
def test_truncated_file(gait_file, share):
    text = gait_file.read_text(encoding="utf-8")
    gait_file.write_text(text[: int(share * len(text.rstrip()))], encoding="utf-8")
    assert "cut off" in refusal(gait_file)


def test_missing_file(tmp_path):
    assert "no such gait file" in refusal(tmp_path / "gait.json")


def test_folder_instead_of_file(tmp_path):
    assert "directory" in refusal(tmp_path)


def test_not_text(tmp_path):
    path = tmp_path / "gait.json"
    path.write_bytes(b"\xff\xfe\x00\x01")
    refusal(path)
