"""What the pages hold, read from their text: the scene's commands, and nothing that asks a network."""

import base64
import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import meshcat
import numpy as np
import pytest
import umsgpack
from meshcat.geometry import Box

from frontal_biped.exceptions import RobotError
from frontal_biped.visualisation import animation_page, report_page
from frontal_biped.visualisation.meshcat_page import SceneRecorder, recorded_scene, timeline
from frontal_biped.visualisation.scene import visual_model
from frontal_biped.visualisation.world import world_motion

FPS = 30.0


@pytest.fixture(scope="module")
def page(biped, orbit):
    return animation_page(biped, orbit, title="Walk <1> & more")


@pytest.fixture(scope="module")
def commands(page):
    texts = json.loads(re.search(r"^const commands = (\[.*\]);$", page, re.MULTILINE).group(1))
    return [umsgpack.unpackb(base64.b64decode(text)) for text in texts]


@pytest.fixture(scope="module")
def clips(commands):
    animation = [command for command in commands if command["type"] == "set_animation"]
    assert len(animation) == 1
    assert commands[-1] is animation[0]
    assert animation[0]["options"]["play"] is True
    assert animation[0]["options"]["repetitions"] > 1000
    return {clip["path"]: clip["clip"] for clip in animation[0]["animations"]}


class Links(HTMLParser):
    """Collects what a browser would load."""

    def __init__(self):
        super().__init__()
        self.loaded, self.frames = [], []

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.loaded += [attrs[key] for key in ("src", "href", "data", "xlink:href") if key in attrs and tag != "a"]
        if tag == "iframe":
            self.frames.append(attrs["srcdoc"])


def assert_offline(page):
    links = Links()
    links.feed(page)
    assert all(link.startswith(("data:", "#")) for link in links.loaded), links.loaded
    styles = "".join(re.findall(r"<style>(.*?)</style>", page, re.DOTALL))
    assert "url(" not in styles.replace("url(#", "")
    assert "@import" not in styles
    assert "Content-Security-Policy" in page
    return links


def test_scene_names_its_nodes(biped, commands):
    drawn = {command["path"] for command in commands if command["type"] == "set_object"}
    for shape in visual_model(biped).geometryObjects:
        body = biped.spatial_model.names[shape.parentJoint]
        assert f"/meshcat/robot/{body}/{shape.name}" in drawn
    for name in ("ground/slab", "contact/left/fri", "contact/right/force/head", "centre_of_mass/marker"):
        assert f"/meshcat/{name}" in drawn
    hidden = {
        c["path"] for c in commands if c["type"] == "set_property" and c["property"] == "visible" and not c["value"]
    }
    assert {"/Grid", "/Axes"} <= hidden


def test_every_body_and_marker_is_animated(biped, clips):
    bodies = {f"/meshcat/robot/{name}" for name in biped.spatial_model.names[1:]}
    markers = {f"/meshcat/contact/{foot}{part}" for foot in ("left", "right") for part in ("", "/force")}
    assert bodies | markers | {"/meshcat/centre_of_mass", "/meshcat/centre_of_mass/plumb"} == set(clips)


def test_key_times_are_monotone_and_cover_four_steps(orbit, clips):
    frames = int(np.floor(orbit.t[-1] * FPS)) + 2
    assert orbit.steps_completed == 4
    for clip in clips.values():
        assert clip["fps"] == FPS
        for track in clip["tracks"]:
            times = np.array([key["time"] for key in track["keys"]])
            assert len(times) in (frames, frames - 1)
            assert np.all(np.diff(times) > 0.0)
            assert times[0] == 0.0
            assert times[-1] / FPS == pytest.approx(orbit.t[-1])


def test_keys_hold_the_motion(biped, orbit, clips):
    motion = world_motion(biped, orbit)
    com = next(t for t in clips["/meshcat/centre_of_mass"]["tracks"] if t["name"] == ".position")
    np.testing.assert_allclose(com["keys"][0]["value"], motion.com[0])
    np.testing.assert_allclose(com["keys"][-1]["value"], motion.com[-1])
    shown = {
        foot: [
            key["value"]
            for t in clips[f"/meshcat/contact/{foot}"]["tracks"]
            if t["name"] == ".visible"
            for key in t["keys"]
        ]
        for foot in ("left", "right")
    }
    assert all(left is not right for left, right in zip(shown["left"], shown["right"], strict=True))
    quaternions = clips["/meshcat/robot/left_hip"]["tracks"][1]["keys"]
    np.testing.assert_allclose([np.linalg.norm(key["value"]) for key in quaternions], 1.0)


def test_animation_page_asks_no_network(page):
    assert_offline(page)
    assert "<title>Walk &lt;1&gt; &amp; more</title>" in page
    # the viewer's own text names web addresses in comments and namespaces; none of ours does
    own = page.replace(page[page.index("<!-- The viewer") : page.index("const commands")], "")
    assert not re.findall(r"https?://", own)


def test_page_stays_small(page):
    assert len(page) < 1_500_000


def test_timeline_tells_the_phases(biped, orbit):
    about = timeline(biped, orbit)
    assert about["duration"] == pytest.approx(orbit.t[-1])
    assert [(p["step"], p["stance"], p["phase"]) for p in about["phases"][:3]] == [
        (1, "left", "rising"),
        (1, "left", "falling"),
        (2, "right", "rising"),
    ]


def test_report_escapes_text_and_asks_no_network(biped, orbit):
    report = report_page(
        biped,
        orbit,
        [("torques", "<svg id='a'></svg>"), ("own <caption>", "<svg id='b'></svg>")],
        numbers=[
            ("multiplier <m>", 0.7553, "-"),
            ("residual", 1.5e-13, "rad"),
            ("steps", 4, ""),
            ("bad", float("nan"), ""),
        ],
        constraints=[
            ("C01", "a & b", 1.0, 2.0, 1.0, "-"),
            ("C02", "short", 0.1, 0.2, -0.1, "rad"),
            ("C03", "unknown", "nan", "1", "nan", "-"),
        ],
        notes=["<script>alert(1)</script>"],
        title="A <title>",
    )
    links = assert_offline(report)
    assert len(links.frames) == 1
    assert_offline(links.frames[0])
    for text in ("multiplier &lt;m&gt;", "a &amp; b", "&lt;script&gt;alert(1)", "<title>A &lt;title&gt;</title>"):
        assert text in report
    assert "Joint torques over two steps." in report
    assert "own &lt;caption&gt;" in report
    assert "1.5 × 10<sup>−13</sup>" in report
    assert report.count('class="violated"') == 2
    assert report.count('class="kept"') == 1


def test_report_without_tables(biped, orbit):
    report = report_page(biped, orbit, [])
    assert "<table" not in report.split("</iframe>")[1]


def test_recorder_keeps_the_latest_and_deletes_below():
    recorder = SceneRecorder()
    visualizer = meshcat.Visualizer(window=recorder)
    visualizer["a"]["b"].set_object(Box([1.0, 1.0, 1.0]))
    for k in range(3):
        visualizer["a"].set_transform(np.eye(4) * (1.0 + k))
        visualizer["a"].set_property("visible", bool(k % 2))
    assert [c["type"] for c in recorder.commands].count("set_transform") == 1
    assert [c["type"] for c in recorder.commands].count("set_property") == 1
    assert "MeshCat" in visualizer.static_html()
    visualizer["a"].delete()
    assert recorder.commands == []


def test_a_robot_without_shapes_is_drawn_as_bars(raised_ankle, orbit):
    assert visual_model(raised_ankle).ngeoms == 0
    drawn = {c["path"] for c in recorded_scene(raised_ankle, orbit).commands if c["type"] == "set_object"}
    assert {"/meshcat/robot/left_hip/leg", "/meshcat/robot/right_ankle/foot"} <= drawn


def test_missing_mesh_is_named(biped, tmp_path):
    text = biped.description.urdf.read_text(encoding="utf-8")
    urdf = tmp_path / "meshy.urdf"
    mesh = '<mesh filename="package://nowhere/torso.stl"/>'
    urdf.write_text(text.replace('<sphere radius="0.10"/>', mesh), encoding="utf-8")

    class Described:
        spatial_model = biped.spatial_model
        description = replace(biped.description, urdf=urdf)

    with pytest.raises(RobotError, match=r"meshy\.urdf.*nowhere"):
        visual_model(Described())
