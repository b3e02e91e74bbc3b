"""`analyze --prove` and `verify`: from a gait file to a certificate, and back."""

import json

import pytest

from frontal_biped.cli.main import main
from frontal_biped.gait.file import save_gait


@pytest.fixture(scope="module")
def folder(tmp_path_factory, reference_gait):
    path = tmp_path_factory.mktemp("proved")
    save_gait(reference_gait, path / "own.gait.json")
    return path


@pytest.mark.slow
def test_prove_and_verify(folder, capsys, monkeypatch):
    monkeypatch.setattr("frontal_biped.zero_dynamics.proof.ankle_basin.MOST_STRETCHES", 2)  # that is enough to be kept
    assert main(["analyze", str(folder / "own.gait.json"), "--prove"]) == 0
    said = capsys.readouterr().out
    assert "number proved: 2" in said and str(folder / "own.proof.json") in said
    assert main(["verify", str(folder / "own.proof.json"), "--gait", str(folder / "own.gait.json"), "--json"]) == 0
    table = json.loads(capsys.readouterr().out)
    assert table == json.loads((folder / "own.proof.json").read_text(encoding="utf-8"))
    assert len(table["ankle_basin"]["stretched"]) > 1


def test_a_certificate_is_not_written_over_the_gait(folder, capsys):
    gait = folder / "own.gait.json"
    before = gait.read_bytes()
    assert main(["analyze", str(gait), "--prove", str(gait)]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert gait.read_bytes() == before


def test_verify_refuses_in_one_line(folder, capsys):
    assert main(["verify", str(folder / "own.gait.json")]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "not a certificate" in said


def test_other_commands_say_what_a_certificate_is(tmp_path, capsys):
    (tmp_path / "c.json").write_text('{"format": "frontal-biped-proof"}')
    assert main(["analyze", str(tmp_path / "c.json")]) == 2
    assert "is a certificate, not a gait" in capsys.readouterr().err
