"""The exported page, used with mouse and keyboard in Chromium: four robots, everything that can be clicked."""

import io

import numpy as np
import pytest
from PIL import Image

from frontal_biped.gait.file import load_gait
from frontal_biped.model import load_robot, models_dir
from frontal_biped.simulation import orbit_trajectory
from frontal_biped.simulation.world import sole_ends, world_configurations
from frontal_biped.viewer import animation_page
from frontal_biped.viewer.headless import picture

pytestmark = pytest.mark.browser

MOST_BYTES = {"frontal_biped": 1.6e6, "talos_full": 5e6, "g1": 5e6, "romeo": 5e6}
"""The bound is 5 MB for robots of primitive shapes; those of meshes keep it too."""

ROBOTS = [name if name == "frontal_biped" else pytest.param(name, marks=pytest.mark.slow) for name in MOST_BYTES]
SEEN = 24  # of 255: a change of colour that is seen
WINDOW = {"width": 1240, "height": 640}
FRAME = 1 / 60  # [s] an arrow key


class Opened:
    """A page, what it was made of, and what it complained about."""

    def __init__(self, page, biped, run, complaints, size):
        self.page, self.biped, self.run, self.complaints, self.size = page, biped, run, complaints, size

    def now(self):
        return self.page.evaluate("window.page.now()")

    def drawn(self):
        """Two frames: the first tells the scene, the second draws it."""
        self.page.evaluate("new Promise((f) => requestAnimationFrame(() => requestAnimationFrame(() => f())))")

    def pause(self):
        if self.page.evaluate("viewer.animator.playing"):
            self.page.locator("#play").click()
        self.drawn()

    def pixels(self):
        self.drawn()
        picture = Image.open(io.BytesIO(self.page.locator("#scene").screenshot())).convert("RGB")
        return np.asarray(picture).astype(int)

    def lit(self):
        return self.page.locator(".cycle li.on").all_inner_texts()

    def at(self, time):
        """Move to a time by code, where the way there is not what is tested."""
        self.page.evaluate("(t) => window.page.seek(t)", time)
        self.drawn()


def changed(before, after):
    return np.abs(before - after).max(axis=-1) > SEEN


@pytest.fixture(scope="module", params=ROBOTS)
def opened(request, browser, gait, tmp_path_factory):
    name = request.param
    biped = load_robot(name)
    own = gait if name == "frontal_biped" else load_gait(models_dir() / f"{name}.gait.json")
    run = orbit_trajectory(biped, own)
    html = animation_page(biped, run, title=name)
    path = tmp_path_factory.mktemp("page") / f"{name}.html"
    path.write_text(html, encoding="utf-8")
    complaints = []
    page = browser.new_page(viewport=WINDOW, color_scheme="light")
    page.on("console", lambda message: complaints.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: complaints.append(f"error: {error}"))
    page.on("request", lambda asked: complaints.append(f"request: {asked.url}"))
    page.goto(path.as_uri())
    complaints.remove(f"request: {path.as_uri()}")
    page.wait_for_function("window.page && viewer.animator.duration > 0", timeout=90_000)
    yield Opened(page, biped, run, complaints, path.stat().st_size)
    page.close()


def test_size(opened):
    assert 0.5e6 < opened.size < MOST_BYTES[opened.biped.name]


def test_plays_by_itself_and_loops(opened):
    page = opened.page
    before = opened.now()
    page.wait_for_function("(t) => window.page.now() !== t", arg=before)
    page.evaluate("viewer.animator.seek(viewer.animator.duration - 0.02)")
    page.wait_for_function("window.page.now() < window.page.duration() - 0.1")
    assert page.locator("#play").inner_text() == "Pause"


@pytest.mark.slow
def test_the_button_stops_and_starts_the_robot(opened):
    page = opened.page
    opened.pause()
    opened.at(0.1)
    still = opened.pixels()
    page.locator("#play").click()
    page.wait_for_function("window.page.now() > 0.2")
    page.locator("#play").click()
    opened.drawn()
    assert page.locator("#play").inner_text() == "Play"
    assert changed(still, opened.pixels()).mean() > 1e-4
    stopped, time = opened.pixels(), opened.now()
    page.wait_for_timeout(300)
    assert opened.now() == time
    np.testing.assert_array_equal(stopped, opened.pixels())


def test_the_slider_moves_the_robot(opened):
    page = opened.page
    opened.pause()
    opened.at(0.0)
    start = opened.pixels()
    box = page.locator("#slider").bounding_box()
    middle = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + 8, middle)
    page.mouse.down()
    page.mouse.move(box["x"] + 8 + 0.3 * (box["width"] - 16), middle, steps=4)
    page.mouse.up()
    assert opened.now() == pytest.approx(0.3 * opened.run.t[-1], abs=0.01 * opened.run.t[-1])
    assert changed(start, opened.pixels()).mean() > 1e-4
    opened.at(0.0)
    assert changed(start, opened.pixels()).mean() < 1e-4


def test_marks_lead_to_the_events_and_the_phase_is_said(opened):
    page, run = opened.page, opened.run
    opened.pause()
    marks = page.locator(".strip .mark")
    assert marks.count() == len(run.event_t)
    for k in range(4):
        marks.nth(k).click(force=True)  # marks of short steps stand close
        assert opened.now() == pytest.approx(run.event_t[k], abs=1e-5)
        opened.drawn()
        assert opened.lit() == [run.event_kind[k].lower()]
    for k, phase in ((0, "rising"), (1, "falling"), (2, "rising")):
        opened.at(0.5 * (run.event_t[k] + run.event_t[k + 1]))
        assert opened.lit() == [phase]
        foot = "left" if k < 2 else "right"
        assert (
            page.locator(".run p").first.inner_text()
            == f"step {1 + k // 2} of {run.steps_completed}, {foot} foot stands"
        )
    assert page.locator("#clock").inner_text() == f"{opened.now():.2f} / {run.t[-1]:.2f} s"


@pytest.mark.parametrize("part", ["force", "fri", "com", "trace"])
def test_every_toggle_hides_and_shows_its_part(opened, part):
    opened.pause()
    opened.at(0.45 * opened.run.t[-1])
    box = opened.page.locator(f"#toggles input[data-part={part}]")
    before = opened.pixels()
    box.click()
    hidden = opened.pixels()
    box.click()
    # the box itself is in the picture, at its foot
    above = slice(0, int(0.88 * len(before)))
    assert changed(before, hidden)[above].sum() > 10
    assert changed(before, opened.pixels())[above].sum() == 0


def test_cursors_follow_and_plots_are_labelled(opened):
    page, run = opened.page, opened.run
    opened.pause()
    plots = page.locator(".plot")
    assert plots.count() == 4
    for k in range(4):
        plot = plots.nth(k)
        for axis in ("xlabel", "ylabel"):
            label = plot.locator(f".{axis}")
            assert "[" in label.text_content()
        field = plot.locator(".field").bounding_box()
        for text in plot.locator(".field text").all():
            box = text.bounding_box()
            assert field["x"] - 1 <= box["x"] and box["x"] + box["width"] <= field["x"] + field["width"] + 1
            assert field["y"] - 1 <= box["y"] and box["y"] + box["height"] <= field["y"] + field["height"] + 1
    cursors = page.locator(".cursor")
    assert cursors.count() == 3
    places = []
    for time in (0.25 * run.t[-1], 0.75 * run.t[-1]):
        opened.at(time)
        places.append([cursor.bounding_box()["x"] for cursor in cursors.all()])
    for k, (early, late) in enumerate(zip(*places, strict=True)):
        box = plots.nth(k).locator("svg").last.bounding_box()
        inner = box["width"] - 62  # margins of the axes
        assert late - early == pytest.approx(0.5 * inner, abs=2.0)
    opened.at(float(run.t[200]))
    said = [text.replace("−", "-") for text in plots.nth(0).locator("output").all_inner_texts()]
    assert [float(text) for text in said] == pytest.approx(run.q[200].tolist(), abs=2e-3)


def test_dragging_in_a_plot_moves_the_robot(opened):
    page = opened.page
    opened.pause()
    opened.at(0.0)
    start = opened.pixels()
    box = page.locator(".plot .field").nth(1).bounding_box()
    left, inner, y = box["x"] + 52, box["width"] - 62, box["y"] + 0.4 * box["height"]
    page.mouse.move(left + 0.1 * inner, y)
    page.mouse.down()
    for share in (0.2, 0.4, 0.63):
        page.mouse.move(left + share * inner, y)
    assert opened.now() == pytest.approx(0.63 * opened.run.t[-1], abs=0.01 * opened.run.t[-1])
    page.mouse.up()
    page.mouse.move(left + 0.9 * inner, y)
    assert opened.now() == pytest.approx(0.63 * opened.run.t[-1], abs=0.01 * opened.run.t[-1])
    assert changed(start, opened.pixels()).mean() > 1e-4


@pytest.mark.slow
def test_dragging_in_the_phase_portrait_finds_the_nearest_state(opened):
    page = opened.page
    opened.pause()
    opened.at(0.0)
    field = page.locator(".plot .field").nth(3)
    target = 0.3 * opened.run.t[-1]
    opened.at(target)
    dot = field.locator(".dot").bounding_box()
    opened.at(target + 0.05)  # from nearby: steps repeat, and the nearest in time is meant
    page.mouse.move(dot["x"] + 8, dot["y"] + 8)
    page.mouse.down()
    page.mouse.up()
    opened.drawn()
    found = field.locator(".dot").bounding_box()
    assert np.hypot(found["x"] - dot["x"], found["y"] - dot["y"]) < 5.0
    assert opened.now() == pytest.approx(target, abs=0.05)


@pytest.mark.slow
def test_a_plot_shows_what_is_chosen(opened):
    page = opened.page
    plot = page.locator(".plot").nth(2)
    choice = plot.locator("select")
    titles = choice.locator("option").all_inner_texts()
    for title in titles:
        choice.select_option(label=title)
        assert "[" in plot.locator(".ylabel").text_content()
        assert plot.locator(".curve").count() >= 1
        assert "NaN" not in plot.inner_html()
    choice.select_option(label="Torques")
    page.locator("#window").select_option("1")
    assert len(plot.locator(".rise").all()) >= 1
    page.locator("#window").select_option("0")


@pytest.mark.slow
def test_slow_motion(opened):
    page = opened.page
    opened.at(0.0)
    speed = page.locator("#speed")
    speed.select_option("0.1")
    page.locator("#play").click()
    begun, clock = opened.now(), page.evaluate("performance.now()")
    page.wait_for_function("(t) => window.page.now() > t + 0.08", arg=begun)
    ratio = 1e3 * (opened.now() - begun) / (page.evaluate("performance.now()") - clock)
    page.locator("#play").click()
    speed.select_option("1")
    assert 0.04 < ratio < 0.2  # 0.1 within the patience of a busy machine; at full speed it is 1


def test_keyboard(opened):
    page, run = opened.page, opened.run
    opened.pause()
    page.locator("h1").evaluate("(h) => document.activeElement.blur()")
    page.keyboard.press("Home")
    assert opened.now() == 0.0
    page.keyboard.press("ArrowRight")
    assert opened.now() == pytest.approx(FRAME)
    page.keyboard.press("ArrowLeft")
    assert opened.now() == 0.0
    for k in (1, 2, 3):
        page.keyboard.press("Shift+ArrowRight")
        assert opened.now() == pytest.approx(run.event_t[k], abs=2e-3)
    page.keyboard.press("Shift+ArrowLeft")
    assert opened.now() == pytest.approx(run.event_t[2], abs=2e-3)
    page.keyboard.press("End")
    assert opened.now() == pytest.approx(run.t[-1], abs=1e-4)
    page.keyboard.press("Home")
    page.keyboard.press("Space")
    page.wait_for_function("window.page.now() > 0")
    opened.drawn()
    assert page.locator("#play").inner_text() == "Pause"
    page.keyboard.press("Space")
    opened.drawn()
    assert page.locator("#play").inner_text() == "Play"
    page.keyboard.press("-")
    assert page.locator("#speed").input_value() == "0.5"
    page.keyboard.press("+")
    assert page.locator("#speed").input_value() == "1"


@pytest.mark.slow
def test_plots_fold_and_the_room_gets_dark(opened):
    page = opened.page
    opened.pause()
    height = page.locator("#scene").bounding_box()["height"]
    page.locator("#fold").click()
    assert page.locator("#scene").bounding_box()["height"] > height + 100
    page.locator("#fold").click()
    light = opened.pixels().mean()
    page.locator("#theme").click()
    assert opened.pixels().mean() < 0.5 * light
    assert page.locator("#theme").inner_text() == "Light"
    page.locator("#theme").click()


def test_the_robot_stands_upright_on_the_ground(opened):
    """What changes when the robot is taken away is the robot: its lowest pixels are where the stance sole is."""
    page, run = opened.page, opened.run
    opened.pause()
    opened.at(0.0)
    with_robot = opened.pixels()
    robot = "viewer.scene_tree.find(['meshcat', 'first']).object"
    page.evaluate(f"{robot}.visible = false; viewer.set_dirty()")
    mask = changed(with_robot, opened.pixels())
    page.evaluate(f"{robot}.visible = true; viewer.set_dirty()")
    ends = sole_ends(opened.biped, world_configurations(opened.biped, run))[0].reshape(-1, 3)

    def row(point):
        x, y, z = point
        share = page.evaluate(f"viewer.camera.position.clone().set({x}, {z}, {-y}).project(viewer.camera).y")
        return 0.5 * (1.0 - share) * len(mask)

    rows = np.nonzero(mask.sum(axis=1) > 2)[0]
    front = ends[:, 0].mean() + 0.35  # [m] toes in front of the ankle, and shadows
    assert row([ends[0, 0] - 0.1, 0.0, 0.0]) < rows.max() < row([front, 0.0, 0.0])
    assert 0.02 * len(mask) < rows.min() < 0.4 * len(mask)
    # upright: taller than wide, and the head's rows are in the middle
    height, width = np.ptp(rows), np.ptp(np.nonzero(mask.sum(axis=0) > 2)[0])
    assert height > 1.1 * width
    head = np.nonzero(mask[rows.min() : rows.min() + height // 12])[1]
    assert abs(head.mean() / mask.shape[1] - 0.5) < 0.06


@pytest.mark.slow
def test_a_picture_is_of_the_time_asked_for(opened):
    early, late = (Image.open(io.BytesIO(picture(opened.page, t))).convert("RGB") for t in (0.0, 0.6))
    assert early.size == (WINDOW["width"], WINDOW["height"])
    assert changed(np.asarray(early).astype(int), np.asarray(late).astype(int)).mean() > 1e-4


def test_nothing_was_asked_and_nothing_complained(opened):
    assert opened.complaints == []
