"""`view`: what it takes, what it refuses, and the file it saves."""

import pytest

import frontal_biped as fb
from frontal_biped.simulation.orbit import orbit_trajectory
from frontal_biped.simulation.trajectory import save_trajectory
from frontal_biped.viewer.page import animation_page


@pytest.fixture(scope="module")
def run(biped, gait):
    return orbit_trajectory(biped, gait, 1)


def test_the_saved_page_is_the_one_of_the_command(biped, run, tmp_path):
    shown = fb.view(run, biped)
    path = shown.save(tmp_path / "page.html")
    assert path.read_text(encoding="utf-8") == shown.html
    of_the_command = animation_page(biped, run, biped.name)
    assert len(shown.html) == len(of_the_command)  # the ids of its nodes are drawn anew
    assert shown.html.split("<body>")[0] == of_the_command.split("<body>")[0]


def test_a_run_is_taken_as_itself_and_by_the_path_of_its_file(run, tmp_path):
    save_trajectory(run, tmp_path / "run.npz")
    for given in (run, tmp_path / "run.npz", str(tmp_path / "run.npz")):
        assert repr(fb.view(given)) == "View of frontal_biped; save('page.html') writes the page"


def test_a_name_is_a_robot_and_the_name_of_a_gait_file_a_gait(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert '"joints"' in fb.view("frontal_biped").html
    assert fb.view("g1.gait.json").title == "g1"


def test_two_runs_beside_each_other(biped, gait, run):
    both = fb.view(run, biped, beside=gait, overlay=True)
    assert both.title == "frontal_biped and frontal_biped"


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda run: fb.view("nobody"), "no gait 'nobody'"),
        (lambda run: fb.view(3), "gait = int: no gait"),
        (lambda run: fb.view("frontal_biped", ghost=True), "is shown alone; leave out beside, overlay and ghost"),
        (lambda run: fb.view(fb.load_robot(), beside=run), "a FrontalBiped is shown alone"),
        (lambda run: fb.view(run, beside=fb.load_robot()), "beside = FrontalBiped: not a gait or a run in the plane"),
        (lambda run: fb.view(run, overlay=True), "overlay: lays a second run over the first"),
    ],
)
def test_what_cannot_be_shown_is_refused_in_one_line(run, ask, words):
    with pytest.raises(fb.FrontalBipedError, match=words) as refused:
        ask(run)
    assert "\n" not in str(refused.value)
