"""The page of a walk in space in Chromium: every link where Pinocchio has it, and everything that can be clicked."""

import io

import numpy as np
import pinocchio as pin
import pytest
from PIL import Image
from swept_walk import swept_walk

from frontal_biped.gait.file import load_gait
from frontal_biped.model import load_robot, models_dir
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.simulation.orbit import orbit_trajectory
from frontal_biped.simulation.space.resampling import resample_spatial
from frontal_biped.viewer.space_page import space_page
from frontal_biped.viewer.space_robot import node_paths

pytestmark = pytest.mark.browser

SINGLE = 2e-5
"""Single precision of positions of metres, through a chain of ten joints, and frames 1/30 s apart [m]."""

MOST_BYTES = {"frontal_biped": 1.6e6, "talos_full": 5e6}

SEEN = 24  # of 255: a change of colour that is seen


class Opened:
    """A page, what it was made of, and what it complained about."""

    def __init__(self, page, robot, run, complaints, size):
        self.page, self.robot, self.run, self.complaints, self.size = page, robot, run, complaints, size

    def at(self, time):
        self.page.evaluate("(t) => window.page.seek(t)", time)
        self.page.evaluate("new Promise((f) => requestAnimationFrame(() => requestAnimationFrame(() => f())))")

    def place(self, path):
        """Where a node is, in the room's axes: the viewer's own have y up."""
        return self.page.evaluate(
            "(path) => { const o = viewer.scene_tree.find(path).object; o.updateWorldMatrix(true, false);"
            " const [x, y, z] = o.matrixWorld.elements.slice(12, 15); return [x, -z, y]; }",
            ["meshcat", "first", *path],
        )

    def pixels(self):
        return np.asarray(Image.open(io.BytesIO(self.page.locator("#scene").screenshot())).convert("RGB")).astype(int)


@pytest.fixture(scope="module", params=["frontal_biped", pytest.param("talos_full", marks=pytest.mark.slow)])
def opened(request, browser, gait, tmp_path_factory):
    name = request.param
    biped = load_robot(name)
    own = gait if name == "frontal_biped" else load_gait(models_dir() / f"{name}.gait.json")
    run = swept_walk(biped, own, steps=4, step_length=0.0 if name == "frontal_biped" else 0.2)
    robot = FreeRobot(biped.robot)
    html = space_page(robot, run, orbit_trajectory(biped, own, 1))
    path = tmp_path_factory.mktemp("page") / f"{name}.html"
    path.write_text(html, encoding="utf-8")
    complaints = []
    page = browser.new_page(viewport={"width": 1240, "height": 820}, color_scheme="light")
    page.on("console", lambda message: complaints.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: complaints.append(f"error: {error}"))
    page.on("request", lambda asked: complaints.append(f"request: {asked.url}"))
    page.goto(path.as_uri())
    complaints.remove(f"request: {path.as_uri()}")
    page.wait_for_function("window.page && viewer.animator.duration > 0", timeout=90_000)
    yield Opened(page, robot, run, complaints, path.stat().st_size)
    page.close()


def test_size(opened):
    assert 0.5e6 < opened.size < MOST_BYTES[opened.robot.name]


@pytest.mark.parametrize("share", [0.0, 0.4, 0.99])
def test_every_link_is_where_pinocchio_has_it(opened, share):
    """The browser's own forward kinematics, from one number a joint, against Pinocchio's."""
    robot, run = opened.robot, opened.run
    frame = round(share * (run.t[-1] - run.t[0]) * 30.0) / 30.0
    opened.at(frame)
    q = resample_spatial(run, np.array([run.t[0] + frame])).q[0]
    model, data = robot.model, robot.model.createData()
    pin.forwardKinematics(model, data, q)
    for joint, path in enumerate(node_paths(model)):
        if joint:
            there = opened.place(["robot", *path.split("/")])
            np.testing.assert_allclose(there, data.oMi[joint].translation, atol=SINGLE)


def test_markers_are_where_they_should_be(opened):
    run = opened.run
    frame = round(0.3 * run.t[-1] * 30.0) / 30.0
    opened.at(frame)
    seen = resample_spatial(run, np.array([frame]))
    np.testing.assert_allclose(opened.place(["centre_of_mass"]), seen.com[0], atol=SINGLE)
    below = opened.place(["centre_of_mass", "plumb", "below", "disc"])
    np.testing.assert_allclose(below, [*seen.com[0, :2], 0.0], atol=1e-4)
    side, other = ("left", "right") if seen.stance[0] > 0.0 else ("right", "left")
    visible = "(path) => viewer.scene_tree.find(path).object.visible"
    for foot, stands in ((side, True), (other, False)):
        assert opened.page.evaluate(visible, ["meshcat", "first", "contact", foot]) is stands
        assert opened.page.evaluate(visible, ["meshcat", "first", "foothold", foot]) is not stands
    foot = 0 if side == "left" else 1
    pressure = opened.place(["contact", side])
    arm = np.array(pressure) - seen.sole_position[0, foot]
    moment = seen.wrench[0, foot, 3:] - np.cross(arm, seen.wrench[0, foot, :3])
    np.testing.assert_allclose(moment[:2], 0.0, atol=1e-2 * opened.robot.weight * 0.1)
    np.testing.assert_allclose(opened.place(["foothold", other])[:2], seen.foothold[0, :2], atol=SINGLE)


def test_footsteps_stay_behind(opened):
    count = (
        "(path) => { let found = 0; viewer.scene_tree.find(path).object.traverse((mesh) => {"
        " if (mesh.geometry) found = mesh.geometry.drawRange.count; }); return found / 6; }"
    )
    left = ["meshcat", "first", "footsteps", "left", "inside"]
    starts = [opened.run.t[opened.run.step == step][0] for step in (0, 2)]
    for before, shown in ((starts[1] - 0.05, 1), (starts[1] + 0.05, 2)):
        opened.at(float(before))
        assert opened.page.evaluate(count, left) == shown


def test_camera_goes_along_and_can_be_told_not_to(opened):
    page, run = opened.page, opened.run
    x = "viewer.controls.target.x"
    opened.at(0.0)
    start = page.evaluate(x)
    opened.at(float(run.t[-1]))
    went = run.com[-1, 0] - run.com[0, 0]
    assert page.evaluate(x) - start == pytest.approx(went, abs=0.1)
    box = page.locator("#toggles input[data-part=follow]")
    box.click()
    held = page.evaluate(x)
    opened.at(0.0)
    assert page.evaluate(x) == held
    box.click()
    assert page.evaluate(x) == pytest.approx(start, abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("part", ["force", "fri", "com", "footsteps", "foothold"])
def test_every_toggle_hides_and_shows_its_part(opened, part):
    opened.at(0.45 * float(opened.run.t[-1]))
    box = opened.page.locator(f"#toggles input[data-part={part}]")
    before = opened.pixels()
    box.click()
    opened.at(0.45 * float(opened.run.t[-1]))
    hidden = opened.pixels()
    box.click()
    opened.at(0.45 * float(opened.run.t[-1]))
    assert (np.abs(before - hidden).max(axis=-1) > SEEN).sum() > 5
    assert (np.abs(before - opened.pixels()).max(axis=-1) > SEEN).sum() == 0


def test_phase_portrait_runs_along_beside_the_robot(opened):
    inset = opened.page.locator("#inset")
    assert inset.locator(".curve.closed").count() == 1
    places = []
    for share in (0.1, 0.3):
        opened.at(share * float(opened.run.t[-1]))
        box = inset.locator(".dot").bounding_box()
        places.append((box["x"], box["y"]))
    assert np.hypot(*np.subtract(*places)) > 5.0
    scene, own = opened.page.locator("#scene").bounding_box(), inset.bounding_box()
    assert scene["x"] <= own["x"] and own["x"] + own["width"] <= scene["x"] + scene["width"]
    assert own["y"] + own["height"] <= scene["y"] + scene["height"]


@pytest.mark.parametrize("width", [640, 420])
def test_a_narrow_picture_says_the_step_in_one_line_and_its_legend_stands_in_rows(opened, width):
    """As a GIF takes it; the words of a caption change with time, and its height must not."""
    page, wide = opened.page, opened.page.viewport_size
    page.evaluate("document.body.classList.add('still')")
    page.set_viewport_size({"width": width, "height": 480})
    heights = set()
    for time in np.linspace(0.0, float(opened.run.t[-1]), 5):
        opened.at(time)
        heights.add(page.evaluate("document.querySelector('#captions p').getClientRects()[0].height"))
    line = page.evaluate("parseFloat(getComputedStyle(document.querySelector('#captions p')).lineHeight)")
    rows = page.evaluate(
        "[...document.querySelectorAll('#toggles label:not([hidden])')].map((label) => {"
        " const { y, height } = label.getBoundingClientRect(); return y + height / 2; })"
    )
    page.evaluate("document.body.classList.remove('still')")
    page.set_viewport_size(wide)
    assert len(heights) == 1
    assert heights.pop() < 1.5 * line
    apart = np.diff(rows)
    assert ((apart < 0.5) | (apart > 10.0)).all()  # beside the one before, or in the next row


def test_every_plot_can_be_chosen(opened):
    plot = opened.page.locator("#plots .plot").nth(1)
    choice = plot.locator("select")
    for title in choice.locator("option").all_inner_texts():
        choice.select_option(label=title)
        assert "[" in plot.locator(".ylabel").text_content()
        assert plot.locator(".curve").count() >= 1
        assert "NaN" not in plot.inner_html()


def test_nothing_was_asked_and_nothing_complained(opened):
    assert opened.complaints == []
