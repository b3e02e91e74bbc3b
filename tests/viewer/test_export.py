"""What leaves for other programs: CSV tables, pictures, and one line where a browser is missing."""

import builtins
import csv
import io
import shutil

import meshcat
import numpy as np
import pytest
from PIL import Image

from frontal_biped.cli import main
from frontal_biped.exceptions import FrontalBipedError, MissingExtraError
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation import save_trajectory
from frontal_biped.simulation.csv_table import run_table, write_csv
from frontal_biped.viewer import animation_page
from frontal_biped.viewer.headless import Film, opened_page, picture, write_gif, write_png

ROUNDING = 1e-12


def columns(biped, run, **options):
    header, rows = run_table(biped, run, **options)
    stream = io.StringIO()
    write_csv(stream, header, rows)
    back = list(csv.reader(io.StringIO(stream.getvalue())))
    assert back[0] == header
    return {name: [row[k] for row in back[1:]] for k, name in enumerate(header)}


def numbers(table, name):
    return np.array([float(text) for text in table[name]])


def test_header_names_the_urdf_joints_and_every_unit(biped, walk):
    header, rows = run_table(biped, walk)
    assert len(rows) == len(walk.t)
    for joint in biped.stance_map.joint_names:
        for what in ("position [rad]", "desired position [rad]", "velocity [rad/s]", "torque [N m]"):
            assert f"{joint} {what}" in header
    assert all(name.endswith("]") for name in header)
    assert len(set(header)) == len(header)


def test_urdf_columns_are_the_same_motion(biped, walk):
    """Positions back through the stance map; torque times velocity is the same power in either coordinates."""
    table = columns(biped, walk, coordinates="both")
    names = biped.stance_map.joint_names
    q = np.stack([numbers(table, f"{name} position [rad]") for name in names], axis=1)
    feet = [Stance.LEFT if foot == "left" else Stance.RIGHT for foot in table["stance [left/right]"]]
    back = np.array([biped.stance_map.positions_to_stance(row, foot) for row, foot in zip(q, feet, strict=True)])
    np.testing.assert_allclose(back, walk.q, atol=ROUNDING)
    power = sum(numbers(table, f"{name} torque [N m]") * numbers(table, f"{name} velocity [rad/s]") for name in names)
    np.testing.assert_allclose(power, np.sum(walk.u * walk.dq, axis=1), atol=1e-9)
    for k, name in enumerate(("stance_ankle", "stance_hip", "swing_hip", "swing_ankle")):
        np.testing.assert_array_equal(numbers(table, f"dq{k + 1} {name} [rad/s]"), walk.dq[:, k])
        np.testing.assert_array_equal(numbers(table, f"u{k + 1} {name} [N m]"), walk.u[:, k])


def test_fri_is_inside_the_sole_and_under_the_right_foot(biped, walk):
    table = columns(biped, walk)
    offset = numbers(table, "fri y [m]") - numbers(table, "stance ankle y [m]")
    np.testing.assert_allclose(-walk.stance * offset, walk.p_fri, atol=ROUNDING)
    assert np.all(np.sign(numbers(table, "stance ankle y [m]")) == np.where(walk.stance > 0.0, 1.0, -1.0))
    np.testing.assert_array_equal(numbers(table, "ground reaction z [N]"), walk.force[:, 1])


def test_the_exported_motion_obeys_newton(biped, orbit):
    """From the table alone: the rate of the horizontal momentum is the lateral ground reaction."""
    table = columns(biped, orbit)
    chart, foot = biped.stance_map, Stance.LEFT
    phase = slice(0, int(np.argmax(orbit.phase < 0.0)))

    def of(kind):
        return np.stack([numbers(table, f"{name} {kind}")[phase] for name in chart.joint_names], axis=1)

    q = np.array([chart.positions_to_stance(row, foot) for row in of("position [rad]")])
    dq = np.array([chart.velocities_to_stance(row, foot) for row in of("velocity [rad/s]")])
    # h points to the right while the left foot stands
    momentum = [-biped.mass * biped.com_velocity(*state)[0] for state in zip(q, dq, strict=True)]
    rate = np.gradient(momentum, numbers(table, "time [s]")[phase])[2:-2]
    force = numbers(table, "ground reaction y [N]")[phase][2:-2]
    np.testing.assert_allclose(rate, force, atol=0.01 * np.abs(force).max())  # differences of 121 samples


def test_rows_at_a_rate_are_evenly_spaced(biped, walk):
    table = columns(biped, walk, rate=200.0)
    np.testing.assert_allclose(np.diff(numbers(table, "time [s]")), 5e-3)
    with pytest.raises(ValueError, match="urdf, stance, both"):
        run_table(biped, walk, coordinates="joint")


@pytest.fixture(scope="module")
def run_file(walk, tmp_path_factory):
    path = tmp_path_factory.mktemp("export") / "run.npz"
    save_trajectory(walk, path)
    return path


def test_command_writes_a_table(run_file, tmp_path, capsys):
    target = tmp_path / "run.csv"
    assert main(["export", str(run_file), "-o", str(target), "--rate", "100", "--coordinates", "both"]) == 0
    assert str(target) in capsys.readouterr().out
    lines = target.read_text().splitlines()
    assert len(lines) > 100
    assert "left_ankle position [rad]" in lines[0] and "q1 stance_ankle [rad]" in lines[0]


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["-o", "run.mp4"], ".csv, .npz, .gif, .png, .html"),
        (["-o", "run.png", "--time", "99"], "choose a time within it"),
        (["-o", "run.png", "--size", "big"], "1280x800"),
        (["-o", "run.csv", "--coordinates", "joint"], "urdf"),
        (["-o", "run.csv", "--rate", "-3"], "not positive"),
    ],
)
def test_wrong_wishes_get_one_line(arguments, word, run_file, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["export", str(run_file), *arguments]) == 2
    assert word in capsys.readouterr().err.splitlines()[-1]
    assert list(tmp_path.iterdir()) == []


def test_missing_playwright_names_the_extra(run_file, tmp_path, capsys, monkeypatch):
    real = builtins.__import__

    def without_playwright(name, *rest, **more):
        if name.split(".")[0] == "playwright":
            raise ModuleNotFoundError(name)
        return real(name, *rest, **more)

    assert meshcat.__file__  # imported before imports are watched
    monkeypatch.setattr(builtins, "__import__", without_playwright)
    assert main(["export", str(run_file), "-o", str(tmp_path / "run.gif"), "--steps", "1"]) == 2
    error = capsys.readouterr().err
    assert "pip install 'frontal-biped[browser]'" in error.splitlines()[-1]
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(MissingExtraError):
        write_png("", tmp_path / "a.png", 0.0)


def test_missing_chromium_is_said_in_one_line(tmp_path, monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    monkeypatch.setenv("PLAYWRIGHT_BROWSERS_PATH", str(tmp_path / "none"))
    with pytest.raises(FrontalBipedError, match="no Chromium was found; `apt install chromium`"):
        write_png("<html></html>", tmp_path / "a.png", 0.0)
    assert not (tmp_path / "a.png").exists()


@pytest.mark.browser
@pytest.mark.slow
def test_pictures_show_the_robot(chromium, biped, orbit, tmp_path):
    page = animation_page(biped, orbit, plots=False, theme="light")
    target = tmp_path / "walk.gif"
    write_gif(page, target, [0.0, 0.2, 0.4], fps=10.0, size=(400, 320))
    with Image.open(target) as animation:
        assert animation.n_frames == 3
        assert animation.info["duration"] == 100
        assert animation.info["loop"] == 0
        frames = []
        for k in range(3):
            animation.seek(k)
            frames.append(np.asarray(animation.convert("RGB")).astype(int))
    blue_leg = (frames[0][..., 2] > frames[0][..., 0] + 60).mean()
    assert blue_leg > 0.002
    assert np.mean(np.abs(frames[0] - frames[2]).max(axis=-1) > 24) > 0.002


@pytest.mark.browser
@pytest.mark.slow
def test_frames_are_what_the_page_shows(chromium, biped, orbit):
    """A frame put together of scene and surroundings is the screenshot; where the walk comes back nothing is drawn."""
    html = animation_page(biped, orbit, plots=False, theme="light")
    times = [0.0, 0.3, 0.9, 2.0]
    with opened_page(html, (400, 480)) as page:
        page.evaluate("document.body.classList.add('still')")
        shots = [np.asarray(Image.open(io.BytesIO(picture(page, t, "main"))).convert("RGB")).astype(int) for t in times]
        film = Film(page)
        frames = [np.asarray(film.frame(t)).astype(int) for t in [*times, 0.3]]
    for shot, frame in zip(shots, frames[:4], strict=True):
        rows, columns = min(len(shot), len(frame)), min(shot.shape[1], frame.shape[1])
        apart = np.abs(shot[:rows, :columns] - frame[:rows, :columns]).max(axis=-1)
        assert (apart > 16).mean() < 1e-4
    assert np.array_equal(frames[1], frames[4])
    assert film.drawn == 4
