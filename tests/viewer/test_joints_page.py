"""A robot without a run: its sliders are its joints, and what they move is where Pinocchio has it."""

import urllib.request

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped.cli import main
from frontal_biped.model import load_robot
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.viewer.joints_page import joints_data, joints_page
from frontal_biped.viewer.live import serve_page
from frontal_biped.viewer.space_robot import node_paths

SINGLE = 2e-5
"""Single precision of positions of metres through a chain of ten joints [m]."""


@pytest.fixture(scope="module", params=["frontal_biped", pytest.param("g1", marks=pytest.mark.slow)])
def robot(request):
    return FreeRobot(load_robot(request.param).robot)


def test_a_slider_for_every_joint_within_its_limits(robot):
    joints = joints_data(robot)["joints"]
    assert tuple(joint["name"] for joint in joints) == robot.joint_names
    for i, joint in enumerate(joints):
        assert joint["lower"] == pytest.approx(robot.limits.lower[i]) and joint["lower"] <= joint["value"]
        assert joint["upper"] == pytest.approx(robot.limits.upper[i]) and joint["value"] <= joint["upper"]
        assert joint["value"] == robot.posture[7 + i]
    parts = {joint["part"]: joint["name"] for joint in joints if joint["part"]}
    assert parts == {key.replace("_", " "): name for key, name in robot.robot.description.joints.items()}


@pytest.mark.browser
def test_what_the_sliders_move_is_where_pinocchio_has_it(robot, browser, tmp_path):
    (tmp_path / "robot.html").write_text(joints_page(robot), encoding="utf-8")
    page = browser.new_page(viewport={"width": 900, "height": 600})
    complaints = []
    page.on("console", lambda message: complaints.append(message.text))
    page.on("request", lambda request: complaints.append(request.url) if request.url.startswith("http") else None)
    page.goto((tmp_path / "robot.html").as_uri())
    q, data, paths = np.array(robot.posture), robot.model.createData(), node_paths(robot.model)

    def check():
        pin.forwardKinematics(robot.model, data, q)
        for joint in range(1, robot.model.njoints):
            seen = page.evaluate(
                "(path) => { const o = viewer.scene_tree.find(path).object; o.updateWorldMatrix(true, false);"
                " const [x, y, z] = o.matrixWorld.elements.slice(12, 15); return [x, -z, y]; }",
                ["meshcat", "first", "robot", *paths[joint].split("/")],
            )
            assert seen == pytest.approx(data.oMi[joint].translation, abs=SINGLE)

    check()
    for i, name in enumerate(robot.joint_names):
        q[7 + i] = 0.7 * robot.limits.upper[i] + 0.3 * robot.limits.lower[i]
        page.evaluate(
            "([name, value]) => { const s = document.querySelector(`input[name='${name}']`); s.value = value;"
            " s.dispatchEvent(new Event('input')); }",
            [name, q[7 + i]],
        )
    check()
    page.locator("#reset").click()
    q = np.array(robot.posture)
    check()
    assert complaints == []
    page.close()


def test_served_and_gone(capsys):
    with serve_page("<p>here</p>", open_browser=False, wait=False) as viewer:
        with urllib.request.urlopen(viewer.url, timeout=5) as answer:
            assert answer.read().decode() == "<p>here</p>"
        assert viewer.url in capsys.readouterr().out
    with pytest.raises(OSError):
        urllib.request.urlopen(viewer.url, timeout=1)


def test_command_takes_names_and_files_of_robots(tmp_path, capsys):
    for source in ("frontal_biped", str(load_robot("frontal_biped").path)):
        assert main(["view", source, "--html", str(tmp_path / "robot.html")]) == 0
        assert "Back to the posture" in (tmp_path / "robot.html").read_text(encoding="utf-8")
    capsys.readouterr()
    for words, remedy in ((["--ghost"], "--ghost"), (["g.json"], "a second file"), (["--robot", "g1"], "--robot")):
        assert main(["view", "frontal_biped", *words]) == 2
        error = capsys.readouterr().err
        assert "a robot is shown alone" in error and remedy in error and error.count("\n") == 1
    assert main(["view", "nobody.toml", "--html", str(tmp_path / "none.html")]) == 2
    assert "nobody.toml: no such file" in capsys.readouterr().err


@pytest.mark.browser
@pytest.mark.parametrize(("width", "scheme"), [(400, "dark"), (400, "light"), (1000, "dark")])
def test_nothing_is_cut_or_covered_and_it_is_as_dark_as_wished(biped, browser, tmp_path, width, scheme):
    (tmp_path / "robot.html").write_text(joints_page(FreeRobot(biped.robot)), encoding="utf-8")
    page = browser.new_page(viewport={"width": width, "height": 800}, color_scheme=scheme)
    page.goto((tmp_path / "robot.html").as_uri())
    page.wait_for_function("window.viewer && document.querySelectorAll('#joints input').length > 0")
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    caption, scene, joints = (page.locator(part).bounding_box() for part in ("#caption", "#scene", "#joints"))
    if width == 400:  # one below the other
        assert caption["y"] + caption["height"] <= scene["y"] + 1.0
        assert scene["y"] + scene["height"] <= joints["y"] + 1.0 and scene["width"] == width
    else:
        assert max(caption["x"] + caption["width"], scene["x"] + scene["width"]) <= joints["x"] + 1.0
    slider = page.locator("#joints input").first.bounding_box()
    assert slider["x"] + slider["width"] <= width
    drawn = page.locator("#scene canvas").bounding_box()
    assert drawn["height"] == pytest.approx(scene["height"], abs=1.0)
    sky = page.evaluate("viewer.scene_tree.find(['Background']).object.top_color")
    assert (np.mean(sky) < 128.0) == (scheme == "dark")
    # bodies are seen whole: their corners are inside the picture
    furthest = page.evaluate(
        "() => { viewer.camera.updateMatrixWorld(); let most = 0; const robot = viewer.scene_tree.find(['meshcat',"
        " 'first', 'robot']).object; robot.updateWorldMatrix(true, true); robot.traverse((o) => { if (o.isMesh) {"
        " const at = o.geometry.attributes.position, p = o.position.clone(); for (let i = 0; i < at.count; i++) {"
        " p.set(at.getX(i), at.getY(i), at.getZ(i)).applyMatrix4(o.matrixWorld).project(viewer.camera);"
        " most = Math.max(most, Math.abs(p.x), Math.abs(p.y)); } } }); return most; }"
    )
    assert 0.3 < furthest < 1.0
    page.close()
