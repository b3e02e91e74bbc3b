"""The report, opened from a file in Chromium: it shows the robot, moves, stops, and asks for nothing else."""

import io

import numpy as np
import pytest
from PIL import Image

from frontal_biped.visualisation import LiveViewer, report_page
from frontal_biped.visualisation.figures import figure_svg, torques
from frontal_biped.visualisation.meshcat_page import timeline
from frontal_biped.visualisation.scene import animate, draw_scene

pytestmark = pytest.mark.browser

SETTLE = 400  # [ms] for a software renderer to draw what it was told


@pytest.fixture(scope="module")
def complaints():
    return []


@pytest.fixture(scope="module")
def report(browser, biped, orbit, tmp_path_factory, complaints):
    path = tmp_path_factory.mktemp("page") / "report.html"
    figure = figure_svg(torques(biped, orbit))
    path.write_text(report_page(biped, orbit, [("torques", figure)], [("steps", 4, "-")]), encoding="utf-8")
    page = browser.new_page(viewport={"width": 1200, "height": 760})
    page.on("console", lambda message: complaints.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: complaints.append(f"error: {error}"))
    page.on("request", lambda request: complaints.append(f"request: {request.url}"))
    page.goto(path.as_uri())
    complaints.remove(f"request: {path.as_uri()}")
    frame = page.frames[1]
    frame.wait_for_function("window.viewer && viewer.animator.duration > 0")
    yield page, frame
    page.close()


def pixels(frame):
    picture = Image.open(io.BytesIO(frame.locator("#scene").screenshot())).convert("RGB")
    return np.asarray(picture).astype(int)


def moved(before, after):
    """Share of the pixels that changed visibly."""
    return float(np.mean(np.abs(before - after).max(axis=-1) > 24))


def slide(frame, time):
    frame.locator("#slider").evaluate("(s, t) => { s.value = t; s.dispatchEvent(new Event('input')); }", time)
    frame.page.wait_for_timeout(SETTLE)


def pause(frame):
    if frame.locator("#play").inner_text() == "Pause":
        frame.locator("#play").click()
    frame.page.wait_for_timeout(SETTLE)


def test_plays_by_itself_and_loops(report):
    _, frame = report
    first = frame.evaluate("viewer.animator.time")
    frame.page.wait_for_timeout(SETTLE)
    assert frame.evaluate("viewer.animator.playing")
    assert frame.evaluate("viewer.animator.time") != first
    frame.evaluate("viewer.animator.seek(viewer.animator.duration - 0.05)")
    frame.page.wait_for_timeout(2 * SETTLE)
    assert frame.evaluate("viewer.animator.playing")
    assert frame.evaluate("viewer.animator.time < viewer.animator.duration - 0.1")


def test_robot_is_visible_and_stands_on_the_ground(report, orbit):
    _, frame = report
    pause(frame)
    slide(frame, 0.0)
    everything = pixels(frame)
    image = everything[:, int(0.4 * everything.shape[1]) : int(0.6 * everything.shape[1])]  # beside the caption
    red, blue = image[..., 0], image[..., 2]
    left_leg = (blue > red + 60) & (blue > 100)
    right_leg = (red > blue + 80) & (red > 120)
    height, width = left_leg.shape
    for leg in (left_leg, right_leg):
        assert 0.005 < leg.mean() < 0.2
    # seen from the front, the robot's left leg is on the right of the picture
    assert np.nonzero(left_leg)[1].mean() > 0.5 * width > np.nonzero(right_leg)[1].mean()
    for leg in (left_leg, right_leg):
        rows = np.nonzero(leg)[0]
        assert 0.3 * height < rows.min() < rows.max() < 0.95 * height
    assert "step 1, left foot stands" in frame.locator("#phase").inner_text()


def test_slider_moves_the_robot(report, orbit):
    _, frame = report
    pause(frame)
    slide(frame, 0.0)
    start = pixels(frame)
    reversal = float(orbit.event_t[1])
    slide(frame, reversal + 0.05)
    middle = pixels(frame)
    assert moved(start, middle) > 0.01
    assert "falling" in frame.locator("#phase").inner_text()
    slide(frame, 0.0)
    assert moved(start, pixels(frame)) < 1e-4


def test_play_moves_and_pause_stops(report):
    _, frame = report
    pause(frame)
    slide(frame, 0.1)
    still = pixels(frame)
    frame.locator("#play").click()
    frame.page.wait_for_timeout(SETTLE)
    assert frame.locator("#play").inner_text() == "Pause"
    assert moved(still, pixels(frame)) > 0.002
    frame.locator("#play").click()
    frame.page.wait_for_timeout(SETTLE)
    stopped = pixels(frame)
    frame.page.wait_for_timeout(SETTLE)
    np.testing.assert_array_equal(stopped, pixels(frame))


def test_figures_are_inline(report):
    page, _ = report
    box = page.locator("figure svg").bounding_box()
    assert box is not None
    assert box["width"] > 300
    assert box["height"] > 100


def test_nothing_was_asked_and_nothing_complained(report, complaints):
    assert complaints == []


def test_live_viewer_draws_and_follows(browser, biped, orbit):
    import meshcat

    with LiveViewer("live", timeline(biped, orbit)) as viewer:
        visualizer = meshcat.Visualizer(window=viewer)
        draw_scene(visualizer, biped)
        page = browser.new_page(viewport={"width": 500, "height": 400})
        page.goto(viewer.url)
        page.wait_for_function("window.viewer && viewer.num_messages_received > 20")
        assert page.evaluate("viewer.animator.duration") == 0
        animate(visualizer, biped, orbit)  # the open page is told
        page.wait_for_function("viewer.animator.duration > 0")
        assert page.evaluate("viewer.animator.duration") == pytest.approx(orbit.t[-1], abs=1e-4)
        page.close()
