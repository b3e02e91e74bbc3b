"""What the page of a walk in space holds: what moves, what is told, and nothing that asks a network."""

import base64
import re
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from swept_walk import swept_walk

from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.simulation.orbit import orbit_trajectory
from frontal_biped.viewer.channels import MOST_FRAMES
from frontal_biped.viewer.page import recording
from frontal_biped.viewer.space_data import SPACE_PANELS, space_page_data
from frontal_biped.viewer.space_motion import ShownPush, motion, spatial_pushes
from frontal_biped.viewer.space_page import space_page
from frontal_biped.viewer.space_robot import body_drivers, node_paths
from frontal_biped.viewer.space_scene import FOOTSTEPS, TRIANGLES, draw_space_scene

SINGLE = 1e-5
"""Accuracy of single precision for lengths of metres and angles of a turn, with room."""


@pytest.fixture(scope="module")
def free(biped):
    return FreeRobot(biped.robot)


@pytest.fixture(scope="module")
def spot(biped, gait):
    """The Table I robot has no knees: it walks on the spot."""
    return swept_walk(biped, gait, steps=3, step_length=0.0)


@pytest.fixture(scope="module")
def orbit(biped, gait):
    return orbit_trajectory(biped, gait, 1)


@pytest.fixture(scope="module")
def about(free, spot, orbit):
    return space_page_data(free, spot, orbit)


def unpacked(table):
    return {
        name: np.frombuffer(base64.b64decode(text), dtype="<f4").astype(float)
        for name, text in table["channels"].items()
    }


def test_tree_of_nodes_is_the_kinematic_tree(free, spot):
    """Placements down the tree, turned as the drivers say, are Pinocchio's forward kinematics."""
    model, data = free.model, free.model.createData()
    paths, drivers = node_paths(model), body_drivers(free)
    channels = unpacked(motion(free, spot))
    frame = 17
    pin.forwardKinematics(model, data, spot_at(spot, channels["t"][frame]))
    for joint in range(2, model.njoints):
        place = pin.SE3.Identity()
        for above in model.supports[joint]:
            if above == 0:
                continue
            driver = next(d for d in drivers if d["node"] == paths[above].split("/"))
            values = [channels[name][frame] for name in driver["from"]]
            if driver["how"] == "pose":
                place = pin.XYZQUATToSE3(np.array(values))
            else:
                assert driver["how"] == "turn"
                turn = pin.AngleAxis(values[0], np.array(driver["axis"])).matrix()
                place = place * model.jointPlacements[above] * pin.SE3(turn, np.zeros(3))
        np.testing.assert_allclose(place.homogeneous, data.oMi[joint].homogeneous, atol=1e-4)


def spot_at(run, time):
    k = int(np.argmin(np.abs(run.t - run.t[0] - time)))
    left, right = (k, k + 1) if run.t[k] - run.t[0] <= time else (k - 1, k)
    weight = (time + run.t[0] - run.t[left]) / (run.t[right] - run.t[left])
    return (1.0 - weight) * run.q[left] + weight * run.q[right]


def test_every_driver_moves_a_node_by_channels_that_are_there(free, spot):
    recorder, visualizer = recording()
    pushes = [ShownPush(0.1, 0.1, np.array([3.0, 0.0, 0.0]), "", np.zeros(3))]
    draw_space_scene(visualizer, free, spot, len(pushes))
    table = motion(free, spot, pushes)
    channels = unpacked(table)
    assert all(len(values) == table["count"] and np.isfinite(values).all() for values in channels.values())
    drawn = {command["path"] for command in recorder.commands}
    for driver in table["drivers"]:
        node = "/".join(["/meshcat/first", *driver["node"]])
        assert any(path == node or path.startswith(node + "/") for path in drawn), node
        assert set(driver["from"]) <= set(channels)


def test_plots_have_their_channels(about, spot):
    table = about["runs"][0]["samples"]
    channels = unpacked(table)
    used = {line[key] for panel in SPACE_PANELS for line in panel["lines"] for key in ("y", "wanted") if key in line}
    assert used | {panel["x"] for panel in SPACE_PANELS} <= set(channels)
    assert all(len(values) == table["count"] and np.isfinite(values).all() for values in channels.values())
    assert {panel["key"] for panel in SPACE_PANELS} >= set(about["runs"][0]["limits"])
    worst = 100.0 * np.abs(spot.tau).max()
    assert channels["u_0"].max() < worst
    np.testing.assert_allclose(channels["v1"], spot.frontal_dq[:, 0], atol=SINGLE)


def test_closed_form_lies_below_the_phase_portrait(free, spot, about, orbit):
    closed = about["runs"][0]["reference"]["portrait"]
    assert closed["x"].count(None) == 2 == closed["y"].count(None)
    beta = np.array([value for value in closed["x"] if value is not None])
    assert beta.min() == pytest.approx(orbit.q[:, 0].min())
    assert beta.max() == pytest.approx(orbit.q[:, 0].max())
    assert about["inset"] == "portrait"
    assert space_page_data(free, spot)["runs"][0]["reference"] == {}


def test_footsteps_are_drawn_once_and_shown_as_they_land(free, spot, about):
    recorder, visualizer = recording()
    draw_space_scene(visualizer, free, spot)
    told = about["runs"][0]["footsteps"]
    for side in ("left", "right"):
        assert told["times"][side] == sorted(told["times"][side])
        for name, each in told["triangles"].items():
            path = f"/meshcat/first/{FOOTSTEPS}/{side}/{name}"
            (command,) = [c for c in recorder.commands if c["path"] == path and c["type"] == "set_object"]
            (geometry,) = command["object"]["geometries"]
            count = geometry["data"]["index"]["array"].data
            assert len(count) == 4 * 3 * each * len(told["times"][side])  # four bytes a number
    assert sum(told["triangles"].values()) == TRIANGLES


def test_pushes_are_told_and_those_told_badly_are_not(free, spot):
    good = {"start": 0.2, "duration": 0.1, "impulse": [5.0, -2.0, 0.0], "link": "torso", "point": [0.0, 0.0, 0.3]}
    link = next(frame.name for frame in free.model.frames if frame.type == pin.FrameType.BODY)
    pushes = [good | {"link": link}, good | {"link": "nowhere"}, good | {"impulse": 3.0}, {"start": "early"}]
    seen = spatial_pushes(free, replace(spot, settings={"pushes": pushes}))
    assert [push.text for push in seen] == [f"push of (5, -2, 0) N s on {link}"]
    channels = unpacked(motion(free, spot, seen))
    shown = channels["push0_on"] > 0.5
    assert channels["t"][shown][0] == pytest.approx(0.2, abs=0.04)
    along = np.stack([channels[f"push0_along_{axis}"] for axis in "xyz"], axis=1)
    np.testing.assert_allclose(along[0], np.array([5.0, -2.0, 0.0]) / np.hypot(5.0, 2.0), atol=SINGLE)


def test_long_walks_have_fewer_frames_a_second(free, spot):
    slow = replace(spot, t=1000.0 * spot.t)
    assert motion(free, slow)["count"] <= MOST_FRAMES + 2


def test_page_asks_no_network_and_survives_gaps(free, spot, orbit):
    wrench = spot.wrench.copy()
    wrench[:20] = 0.0
    q = spot.q.copy()
    q[-30:] = np.nan
    page = space_page(free, replace(spot, wrench=wrench, q=q, outcome="blew up"), orbit, title="a <walk>")
    assert len(page) < 1_600_000
    assert "NaN" not in page.split("const about = ")[1].split("\n")[0]
    assert "a &lt;walk&gt;" in page and "<title>a <" not in page
    own = page.replace(page[page.index("<!-- The viewer") : page.index("const commands")], "")
    assert not re.findall(r"https?://", own)


def test_the_asked_path_is_a_line_on_the_ground(free, spot):
    """One strip a way, one square a corner; none where there is none."""
    path = f"/meshcat/first/{FOOTSTEPS}/path"
    corners = {"path": {"corners": [[0.5, 0.0, 0.0], [0.5, 0.2, 0.0]]}}
    for settings, strips in ((corners, 2 + 3), ({}, 0)):
        recorder, visualizer = recording()
        draw_space_scene(visualizer, free, replace(spot, settings={**spot.settings, **settings}))
        drawn = [c for c in recorder.commands if c["path"] == path and c["type"] == "set_object"]
        assert len(drawn) == bool(strips)
        if strips:
            (geometry,) = drawn[0]["object"]["geometries"]
            assert len(geometry["data"]["index"]["array"].data) == 4 * 3 * 2 * strips  # four bytes a number
