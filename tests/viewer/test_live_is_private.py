"""The live viewer shows its scene to the page at the printed address, and to nobody else."""

from urllib.parse import urlsplit

import pytest
from foreign_page import HARMLESS, RESOLVED, rebound, tried
from raw_requests import UPGRADE, get, malformed, refusals, status

from frontal_biped.viewer import LiveViewer
from frontal_biped.viewer.guard import HEADERS, REFUSED
from frontal_biped.viewer.headless import CHROMIUM_OPTIONS

SECRET_OF_THE_SCENE = "the-scene-of-this-robot"
NO_REQUEST = "HTTP/1.1 400 Bad Request\r\n\r\n"
"""Tornado's answer to a host that is none."""


@pytest.fixture
def viewer():
    import meshcat

    with LiveViewer(title=SECRET_OF_THE_SCENE) as viewer:
        meshcat.Visualizer(window=viewer)[SECRET_OF_THE_SCENE].set_property("visible", True)
        yield viewer


def test_the_page_and_its_web_socket_are_served(viewer):
    port = urlsplit(viewer.url).port
    for host in (f"127.0.0.1:{port}", f"localhost:{port}", "localhost:1"):
        page = get(viewer.url, f"Host: {host}")
        assert status(page) == 200 and SECRET_OF_THE_SCENE in page
        for name, value in HEADERS.items():
            assert f"{name}: {value}" in page
        assert "tornado" not in page[:2000].lower()
        scene = get(viewer.url, f"Host: {host}", f"Origin: http://{host}", *UPGRADE.split("\r\n")[:-1])
        assert status(scene) == 101 and SECRET_OF_THE_SCENE in scene


def test_nobody_else_is_told_anything(viewer, capfd):
    for name, answer in refusals(viewer.url).items():
        assert answer == NO_REQUEST or (status(answer) == 403 and answer.endswith(f"\r\n\r\n{REFUSED}")), name
        assert SECRET_OF_THE_SCENE not in answer, name
    assert capfd.readouterr() == ("", "")


def test_what_is_no_request_gets_nothing_and_does_no_harm(viewer, capfd):
    for name, answer in malformed(viewer.url).items():
        assert status(answer) in (0, 400, 403, 405, 431), name
        assert SECRET_OF_THE_SCENE not in answer and "back" not in answer, name
    page = get(viewer.url, f"Host: 127.0.0.1:{viewer.port}")
    assert status(page) == 200 and SECRET_OF_THE_SCENE in page
    assert capfd.readouterr() == ("", "")


def test_what_is_not_there_is_not_served(viewer):
    path = urlsplit(viewer.url).path
    for below in ("x", "../../etc/passwd", "%2e%2e/%2e%2e/etc/passwd", "/etc/passwd", "..%5c..", "%00", "favicon.ico"):
        answer = get(viewer.url, f"Host: 127.0.0.1:{viewer.port}", path=path + below)
        assert status(answer) == 403 and "root:" not in answer, below


@pytest.mark.browser
@pytest.mark.slow
def test_pages_of_others_get_nothing(chromium, viewer):
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=[*CHROMIUM_OPTIONS, RESOLVED])
        for how, address, got in tried(browser, viewer.url):
            assert got in HARMLESS, (how, address, got)
        assert rebound(browser, viewer.url) == [(403, REFUSED.strip())] * 3
        assert viewer._clients == set()
        page = browser.new_page()  # the page itself works beside them
        page.goto(viewer.url)
        page.wait_for_function(
            f"window.viewer && {SECRET_OF_THE_SCENE!r} in viewer.scene_tree.children.meshcat.children"
        )
        browser.close()
