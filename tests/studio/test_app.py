"""The studio as its user meets it: started, used in a browser, ended."""

import os
import shutil
import signal
import socket
import subprocess
import sys
import time

import numpy as np
import pytest
from foreign_page import HARMLESS, RESOLVED, rebound, tried

from frontal_biped.cli import main
from frontal_biped.viewer.guard import REFUSED
from frontal_biped.viewer.headless import CHROMIUM_OPTIONS

viser = pytest.importorskip("viser")

PATIENCE = 120.0  # [s] on a busy machine


def children(pid):
    """Processes whose parent is pid."""
    out = subprocess.run(["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True, check=False).stdout
    return [int(text) for text in out.split()]


def alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_ends_cleanly(number, tmp_path):
    program = [sys.executable, "-m", "frontal_biped", "studio", "--no-open"]
    process = subprocess.Popen(program, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path)
    line = process.stdout.readline()
    assert line.startswith("Studio at http://127.0.0.1:")
    port = int(line.split(":")[2].split("/")[0])
    workers = children(process.pid)
    assert len(workers) >= 2
    time.sleep(0.5)  # while the workers start or work
    process.send_signal(number)
    out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0 and out == "" and err == ""
    end = time.monotonic() + 10.0
    while any(map(alive, workers)) and time.monotonic() < end:
        time.sleep(0.1)
    assert not any(map(alive, workers))
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        probe.bind(("127.0.0.1", port))
    assert list(tmp_path.iterdir()) == []


def test_taken_port_is_named(capsys):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert main(["studio", "--no-open", "--port", str(port)]) == 2
    assert capsys.readouterr().err == f"frontal-biped: error: port {port} is in use; name another one with --port\n"


def test_unknown_robot_is_refused(capsys):
    assert main(["studio", "--no-open", "--robot", "frontal_bipet"]) == 2
    error = capsys.readouterr().err
    assert "did you mean 'frontal_biped'?" in error and error.count("\n") == 1


def test_missing_viser_names_the_extra(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "viser", None)
    assert main(["studio", "--no-open"]) == 2
    assert capsys.readouterr().err == (
        f"frontal-biped: error: the studio needs viser: {sys.executable} -m pip install 'frontal-biped[viser]'\n"
    )


def test_a_folder_that_cannot_be_written_to_is_told_before_anything_starts(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert main(["studio", "--no-open", "-o", str(tmp_path / "file" / "below")]) == 2
    assert (
        capsys.readouterr().err == f"frontal-biped: error: {tmp_path / 'file'}: is not a folder; choose another path\n"
    )


@pytest.fixture
def chromium():
    executable = shutil.which("chromium")
    if executable is None:
        # continuous integration installs it: there its absence is a failure
        assert not os.environ.get("CI"), "no chromium on the PATH"
        pytest.skip("no chromium on the PATH")
    return executable


@pytest.mark.slow
@pytest.mark.browser
def test_pages_of_others_read_nothing_write_nothing_and_change_nothing(chromium, tmp_path):
    from playwright.sync_api import sync_playwright

    from frontal_biped.studio.app import Studio

    with Studio("frontal_biped", 0, tmp_path) as studio, sync_playwright() as playwright:
        end = time.monotonic() + PATIENCE
        while studio.workbench.state.gait is None and time.monotonic() < end:
            time.sleep(0.1)
        before = studio.workbench.state
        assert before.gait is not None
        browser = playwright.chromium.launch(executable_path=chromium, args=[*CHROMIUM_OPTIONS, RESOLVED])
        for how, address, got in tried(browser, studio.url, [f"viser-v{viser.__version__}"]):
            assert got in HARMLESS, (how, address, got)
        assert rebound(browser, studio.url) == [(403, REFUSED.strip())] * 3
        browser.close()
        after = studio.workbench.state
        assert studio.server.get_clients() == {}
        assert (after.specification, after.gait, after.robot) == (before.specification, before.gait, before.robot)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
@pytest.mark.browser
def test_slider_push_and_save_in_the_browser(chromium, tmp_path):
    from playwright.sync_api import sync_playwright

    from frontal_biped.studio.app import Studio

    complaints = []
    with Studio("frontal_biped", 0, tmp_path) as studio, sync_playwright() as playwright:
        studio.speed(0.0)  # software rendering is slow enough without motion
        options = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        browser = playwright.chromium.launch(executable_path=chromium, args=options)
        page = browser.new_page(viewport={"width": 900, "height": 900})
        page.on("console", lambda m: complaints.append(m.text) if m.type == "error" else None)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda request: outside(request.url, studio.url, complaints))
        page.set_default_timeout(1000.0 * PATIENCE)
        page.goto(studio.url)

        def wait_for(text):
            page.wait_for_function(f"document.body.innerText.includes({text!r})", polling=500)

        wait_for("J = 210.22")
        thumb = page.get_by_role("slider").first
        thumb.focus()
        page.keyboard.press("Home")  # the pelvis within 2 degrees
        wait_for("(before: 210.2)")
        cost = studio.workbench.state.gait.orbit.cost
        wait_for(f"J = {cost:.2f}")
        assert cost > 210.3 and studio.workbench.state.specification.max_pelvis_roll < 0.036
        wait_for("certified in closed form")
        page.get_by_role("button", name="Push").click()
        wait_for("push of 10 N s outwards")
        page.get_by_role("button", name="Save gait and page").click()
        wait_for(".html in")
        browser.close()
    assert complaints == []
    assert sorted(path.name for path in tmp_path.iterdir()) == ["frontal_biped-1.gait.json", "frontal_biped-1.html"]


@pytest.mark.slow
@pytest.mark.browser
def test_arrow_keys_steer_the_whole_robot_and_it_answers_within_a_step(chromium, tmp_path):
    from playwright.sync_api import sync_playwright

    from frontal_biped.studio.app import Studio

    pytest.importorskip("mujoco")
    complaints = []
    with Studio("talos_full", 0, tmp_path) as studio, sync_playwright() as playwright:
        walk = studio.walk

        def until(done):
            end = time.monotonic() + 4.0 * PATIENCE
            while not done():
                assert time.monotonic() < end and not walk.news.startswith("fell"), (walk.picture, walk.news)
                time.sleep(0.05)

        options = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        browser = playwright.chromium.launch(executable_path=chromium, args=options)
        page = browser.new_page(viewport={"width": 900, "height": 700})
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda request: outside(request.url, studio.url, complaints))
        page.set_default_timeout(1000.0 * PATIENCE)
        page.goto(studio.url)
        page.wait_for_function("document.body.innerText.includes('J = ')", polling=500)
        page.get_by_role("button", name="Walk", exact=True).click()
        until(lambda: walk.picture is not None and walk.picture.steps >= 1)
        page.mouse.click(200, 400)
        page.mouse.move(200, 300)
        for key, order in (("ArrowUp", (0.1, 0.0, 0.0)), ("ArrowLeft", (0.1, 0.0, 0.15))):
            page.keyboard.press(key)
            until(lambda order=order: tuple(walk.picture.order) == order)
            until(lambda: walk.picture.answered[1] >= 0)
            given, answered = walk.picture.answered
            assert answered == given + 1
        begun = walk.picture
        until(lambda: walk.picture.steps >= begun.steps + 3)
        assert walk.picture.yaw > begun.yaw + 0.1
        assert np.hypot(*(walk.picture.com - begun.com)[:2]) > 0.05
        page.wait_for_function("document.body.innerText.includes('turning left by 9 degrees')", polling=500)
        page.keyboard.press("Space")
        until(lambda: not any(walk.picture.order))
        page.get_by_role("button", name="Back to the gait").click()
        until(lambda: not walk.walks)
        browser.close()
    assert complaints == []
    assert list(tmp_path.iterdir()) == []


def outside(url, home, complaints):
    if not url.startswith((home, home.replace("http", "ws"), "data:", "blob:")):
        complaints.append(f"request to {url}")
