"""The report and the live viewer in Chromium: they show the robot, move, and ask for nothing else."""

import pytest

from frontal_biped.demo.page import report_page
from frontal_biped.figures.write import figure_svg, torques
from frontal_biped.viewer import LiveViewer
from frontal_biped.viewer.page_data import page_data
from frontal_biped.viewer.scene import animate, cast, draw_scene

pytestmark = pytest.mark.browser


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


def test_live_viewer_draws_and_follows(browser, biped, orbit):
    # before the report is open: without a graphics card, two pages that draw keep each other waiting
    import meshcat

    actors = cast(biped, orbit)
    with LiveViewer("live", page_data(actors)) as viewer:
        visualizer = meshcat.Visualizer(window=viewer)
        draw_scene(visualizer, actors)
        page = browser.new_page(viewport={"width": 500, "height": 400})
        page.goto(viewer.url)
        page.wait_for_function("window.viewer && viewer.num_messages_received > 20")
        assert page.evaluate("viewer.animator.duration") == 0
        animate(visualizer, actors)  # the open page is told
        page.wait_for_function("viewer.animator.duration > 0")
        assert page.evaluate("viewer.animator.duration") == pytest.approx(orbit.t[-1], abs=1e-4)
        page.close()


@pytest.mark.slow
def test_plays_by_itself_and_loops(report):
    _, frame = report
    assert frame.evaluate("viewer.animator.playing")
    frame.wait_for_function("(t) => viewer.animator.time !== t", arg=frame.evaluate("viewer.animator.time"))
    frame.evaluate("viewer.animator.seek(viewer.animator.duration - 0.05)")
    frame.wait_for_function("viewer.animator.time < viewer.animator.duration - 0.1")
    assert frame.evaluate("viewer.animator.playing")
    frame.locator("#play").click()
    frame.wait_for_function("!viewer.animator.playing")


def test_figures_are_inline(report):
    page, _ = report
    box = page.locator("figure svg").bounding_box()
    assert box is not None
    assert box["width"] > 300
    assert box["height"] > 100


def test_nothing_was_asked_and_nothing_complained(report, complaints):
    assert complaints == []
