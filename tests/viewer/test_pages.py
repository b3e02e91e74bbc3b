"""What the pages hold, read from their text: the scene's commands, and nothing that asks a network."""

import base64
import json
import re
from dataclasses import replace

import meshcat
import numpy as np
import pinocchio as pin
import pytest
import umsgpack
from meshcat.geometry import Box
from offline import assert_offline

from frontal_biped.exceptions import RobotError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.robot import Robot
from frontal_biped.simulation import Disturbances, Push
from frontal_biped.simulation.orbit import orbit_trajectory
from frontal_biped.simulation.world import drawable, phase_spans, sole_ends, world_configurations, world_motion
from frontal_biped.viewer import animation_page
from frontal_biped.viewer.channels import MOST_FRAMES
from frontal_biped.viewer.markers import ribbon, swing_traces
from frontal_biped.viewer.page import SceneRecorder, recording
from frontal_biped.viewer.page_data import MOST_SAMPLES, PANELS, page_data, samples, told_source
from frontal_biped.viewer.robot_shapes import visual_model
from frontal_biped.viewer.scene import animate, cast, draw_scene

FPS = 30.0

MOST_ADDED = 6e6
"""What a walk, however long, adds to a page [bytes]: with the meshes of any packaged robot it stays below 10 MB."""


@pytest.fixture(scope="module")
def page(biped, orbit):
    return animation_page(biped, orbit, title="Walk <1> & more")


@pytest.fixture(scope="module")
def commands(page):
    texts = json.loads(re.search(r"^const commands = (\[.*\]);$", page, re.MULTILINE).group(1))
    return [umsgpack.unpackb(base64.b64decode(text)) for text in texts]


def recorded_scene(actors):
    """Scene and MeshCat's own animation of it, as the studio tells an open page."""
    recorder, visualizer = recording()
    draw_scene(visualizer, actors)
    animate(visualizer, actors)
    return recorder


def animation_of(commands):
    animation = [command for command in commands if command["type"] == "set_animation"]
    assert len(animation) == 1
    assert commands[-1] is animation[0]
    return animation


def test_page_has_a_clock_of_its_length(orbit, commands):
    """MeshCat only keeps the time; what moves comes in channels, which are a tenth as large."""
    (animation,) = animation_of(commands)
    assert animation["options"]["play"] is True
    assert animation["options"]["repetitions"] > 1000
    (clip,) = animation["animations"]
    assert clip["clip"]["tracks"][0]["keys"][-1]["time"] / clip["clip"]["fps"] == pytest.approx(orbit.t[-1])


@pytest.fixture(scope="module")
def clips(biped, orbit):
    animation = animation_of(recorded_scene(cast(biped, orbit)).commands)
    assert animation[0]["options"]["play"] is True
    assert animation[0]["options"]["repetitions"] > 1000
    return {clip["path"]: clip["clip"] for clip in animation[0]["animations"]}


def test_scene_names_its_nodes(biped, commands):
    drawn = {command["path"] for command in commands if command["type"] == "set_object"}
    for shape in visual_model(biped.robot, biped.spatial_model).geometryObjects:
        body = biped.spatial_model.names[shape.parentJoint]
        assert f"/meshcat/first/robot/{body}/{shape.name}" in drawn
    for name in ("contact/left/fri", "contact/right/force/head", "centre_of_mass/marker", "trace/left", "trace/right"):
        assert f"/meshcat/first/{name}" in drawn
    assert "/meshcat/ground/slab" in drawn
    hidden = {
        c["path"] for c in commands if c["type"] == "set_property" and c["property"] == "visible" and not c["value"]
    }
    assert {"/Grid", "/Axes"} <= hidden


def test_every_body_and_marker_is_animated(biped, clips):
    bodies = {f"/meshcat/first/robot/{name}" for name in biped.spatial_model.names[1:]}
    markers = {f"/meshcat/first/contact/{foot}{part}" for foot in ("left", "right") for part in ("", "/force")}
    com = {f"/meshcat/first/centre_of_mass{part}" for part in ("", "/plumb")}
    assert bodies | markers | com == set(clips)


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
    com = next(t for t in clips["/meshcat/first/centre_of_mass"]["tracks"] if t["name"] == ".position")
    np.testing.assert_allclose(com["keys"][0]["value"], motion.com[0])
    np.testing.assert_allclose(com["keys"][-1]["value"], motion.com[-1])
    shown = {
        foot: [
            key["value"]
            for t in clips[f"/meshcat/first/contact/{foot}"]["tracks"]
            if t["name"] == ".visible"
            for key in t["keys"]
        ]
        for foot in ("left", "right")
    }
    assert all(left is not right for left, right in zip(shown["left"], shown["right"], strict=True))
    quaternions = clips["/meshcat/first/robot/left_hip"]["tracks"][1]["keys"]
    np.testing.assert_allclose([np.linalg.norm(key["value"]) for key in quaternions], 1.0)


@pytest.fixture(scope="module")
def moved(biped, orbit):
    return page_data(cast(biped, orbit))["runs"][0]["motion"]


def test_channels_move_every_body_and_marker_through_the_run(biped, orbit, commands, moved):
    names = ["/".join(driver["node"]) for driver in moved["drivers"]]
    bodies = {f"robot/{name}" for name in biped.spatial_model.names[1:]}
    markers = {f"contact/{foot}{part}" for foot in ("left", "right") for part in ("", "/force")}
    assert bodies | markers | {"centre_of_mass", "centre_of_mass/plumb"} == set(names)
    drawn = {command["path"] for command in commands}
    assert all(any(path.startswith(f"/meshcat/first/{name}/") for path in drawn) for name in names)
    channels = unpacked(moved)
    assert {name for driver in moved["drivers"] for name in driver["from"]} <= set(channels)
    assert all(len(values) == moved["count"] and np.isfinite(values).all() for values in channels.values())
    assert np.all(np.diff(channels["t"]) > 0.0)
    assert channels["t"][0] == 0.0
    assert channels["t"][-1] == pytest.approx(orbit.t[-1])
    assert moved["count"] in (int(np.floor(orbit.t[-1] * FPS)) + 1, int(np.floor(orbit.t[-1] * FPS)) + 2)


def test_channels_hold_the_motion(biped, orbit, moved):
    single, motion, channels = 1e-5, world_motion(biped, orbit), unpacked(moved)

    def of(name, parts="xyz"):
        return np.stack([channels[f"{name}_{part}"] for part in parts], axis=1)

    for end in (0, -1):
        np.testing.assert_allclose(of("com")[end], motion.com[end], atol=single)
        loaded = "left" if motion.stance[end] > 0.0 else "right"
        np.testing.assert_allclose(of(f"fri_{loaded}")[end], motion.fri[end], atol=single)
        np.testing.assert_allclose(of(f"force_{loaded}")[end], motion.force[end] / biped.weight, atol=single)
    np.testing.assert_array_equal(channels["on_left"] + channels["on_right"], 1.0)
    model, data = biped.spatial_model, biped.spatial_model.createData()
    pin.forwardKinematics(model, data, motion.q[-1])
    for joint in range(1, model.njoints):
        (driver,) = [driver for driver in moved["drivers"] if driver["node"] == ["robot", model.names[joint]]]
        pose = pin.XYZQUATToSE3(np.array([channels[name][-1] for name in driver["from"]]))
        np.testing.assert_allclose(pose.homogeneous, data.oMi[joint].homogeneous, atol=single)
        # linear between frames: no quaternion changes its sign
        turns = np.stack([channels[name] for name in driver["from"][3:]], axis=1)
        assert (np.einsum("ti,ti->t", turns[1:], turns[:-1]) > 0.9).all()


def test_animation_page_asks_no_network(page):
    assert_offline(page)
    assert "<title>Walk &lt;1&gt; &amp; more</title>" in page
    # the viewer's own text names web addresses in comments and namespaces; none of ours does
    own = page.replace(page[page.index("<!-- The viewer") : page.index("const commands")], "")
    assert not re.findall(r"https?://", own)


def test_page_stays_small(page):
    assert len(page) < 1_500_000


def unpacked(table):
    return {
        name: np.frombuffer(base64.b64decode(text), dtype="<f4").astype(float)
        for name, text in table["channels"].items()
    }


def test_page_is_told_the_phases_and_events(biped, orbit):
    about = page_data(cast(biped, orbit))
    assert about["duration"] == pytest.approx(orbit.t[-1])
    run = about["runs"][0]
    assert [(p["step"], p["stance"], p["phase"]) for p in run["phases"][:3]] == [
        (1, "left", "rising"),
        (1, "left", "falling"),
        (2, "right", "rising"),
    ]
    assert [event["kind"] for event in run["events"]] == ["impact", "reversal"] * 4 + ["impact"]
    np.testing.assert_allclose([event["t"] for event in run["events"]], orbit.event_t, atol=1e-6)


def test_events_are_found_in_the_phases_where_the_run_lists_none(biped, orbit):
    """Another simulator may record samples alone."""
    bare = replace(orbit, event_t=np.zeros(0), event_kind=(), event_step=np.zeros(0), event_state=np.zeros((0, 8)))
    found = page_data(cast(biped, bare))["runs"][0]["events"]
    listed = page_data(cast(biped, orbit))["runs"][0]["events"]
    # the impacts at either end are no change of phase
    assert [event["kind"] for event in found] == [event["kind"] for event in listed[1:-1]]
    np.testing.assert_allclose([e["t"] for e in found], [e["t"] for e in listed[1:-1]], atol=1e-6)


def test_channels_are_the_samples_of_the_run(biped, walk):
    table = samples(biped, walk)
    channels = unpacked(table)
    assert table["count"] == min(len(walk.t), table["count"]) <= MOST_SAMPLES + 2 * len(phase_spans(walk))
    assert all(len(values) == table["count"] for values in channels.values())
    single = 1e-5  # float32 of seconds and radians
    beta = np.interp(channels["t"], walk.t, walk.q[:, 0])
    inside = ~np.isin(np.arange(table["count"]), [*table["breaks"], *(np.array(table["breaks"]) - 1)])
    np.testing.assert_allclose(channels["q1"][inside], beta[inside], atol=single)
    # heights of the swing sole: on the ground at the end of every step, never below it
    for name in ("inner", "outer"):
        assert channels[name].min() > -0.1
        assert abs(channels[name][-1]) < 0.1
    used = {line[key] for panel in PANELS for line in panel["lines"] for key in ("y", "wanted") if key in line}
    assert used | {panel["x"] for panel in PANELS} <= set(channels)


def test_long_runs_are_thinned_but_keep_both_ends_of_every_phase(biped, walk):
    repeats = 1 + MOST_SAMPLES // len(walk.t)
    duration, steps = walk.t[-1], walk.steps_completed
    arrays = {name: np.concatenate([getattr(walk, name)] * repeats) for name in (
        "q", "dq", "u", "force", "p_fri", "p_fri_target", "q_b_desired", "phase", "stance", "stance_y",
    )}  # fmt: skip
    arrays["t"] = np.concatenate([walk.t + k * duration for k in range(repeats)])
    arrays["step"] = np.concatenate([walk.step + k * steps for k in range(repeats)])
    long = replace(walk, **arrays)
    table = samples(biped, long)
    assert table["count"] < len(long.t)
    times, starts = unpacked(table)["t"], {round(span.start, 3) for span in phase_spans(long)}
    assert starts <= {round(float(t), 3) for t in times}


@pytest.fixture(scope="module")
def many(biped, gait):
    """Three hundred steps, and in one of them a spike of a single sample in every curve."""
    run = orbit_trajectory(biped, gait, 300, samples=50)
    spiked = {name: getattr(run, name).copy() for name in ("u", "dq", "p_fri")}
    for values in spiked.values():
        values[len(run.t) // 2 + 7] = 9.0 * np.abs(values).max()
    return replace(run, **spiked)


def test_what_is_drawn_of_a_long_walk_is_bounded_and_its_extremes_are_kept(biped, orbit, many):
    few, long = (page_data(cast(biped, run))["runs"][0] for run in (orbit, many))
    table, told = unpacked(long["samples"]), unpacked(few["samples"])
    assert long["samples"]["count"] < 2 * MOST_SAMPLES < len(many.t)
    for i in range(4):
        for name, values in (("u", many.u), ("v", many.dq), ("q", many.q)):
            drawn = table[f"{name}{i + 1}"]
            np.testing.assert_allclose([drawn.min(), drawn.max()], [values[:, i].min(), values[:, i].max()], rtol=1e-6)
    assert table["fri"].max() == pytest.approx(1e3 * many.p_fri.max())
    # what is told is told of every step
    assert long["steps"] == 300
    assert len(long["phases"]) == 600
    assert long["motion"]["count"] <= MOST_FRAMES + 2
    assert set(table) == set(told)
    assert len(animation_page(biped, many)) - len(animation_page(biped, orbit)) < MOST_ADDED


def test_pushes_are_told(biped, gait, walk):
    pushed = replace(walk, settings={"disturbances": {"pushes": [{"start": 0.5, "duration": 0.1, "impulse": -3.0}]}})
    assert page_data(cast(biped, pushed))["runs"][0]["pushes"] == [{"start": 0.5, "duration": 0.1, "impulse": -3.0}]
    # of a phase: counted from where it began, and not told where it never did
    of_phase = {"start": 0.05, "duration": 0.1, "impulse": 2.0, "phase": "falling"}
    both = {"disturbances": {"pushes": [{**of_phase, "step": 1}, {**of_phase, "step": 99}]}}
    reversal = next(
        t
        for t, kind, step in zip(walk.event_t, walk.event_kind, walk.event_step, strict=True)
        if kind == "REVERSAL" and step == 1
    )
    (told,) = page_data(cast(biped, replace(walk, settings=both)))["runs"][0]["pushes"]
    assert told["start"] == pytest.approx(reversal + 0.05)
    broken = replace(walk, settings={"disturbances": {"pushes": [{"start": "early"}]}})
    assert page_data(cast(biped, broken))["runs"][0]["pushes"] == []
    from frontal_biped.simulation.walking import simulate

    run = simulate(
        biped,
        gait,
        steps=1,
        period=5e-3,
        stabiliser="adaptive",
        disturbances=Disturbances(pushes=(Push(0.1, 0.05, 0.5),)),
    )
    assert page_data(cast(biped, run))["runs"][0]["pushes"] == [{"start": 0.1, "duration": 0.05, "impulse": 0.5}]


def test_trace_is_the_way_of_the_swing_foot(biped, orbit):
    traces = swing_traces(biped, orbit)
    assert [trace.step for trace in traces] == [0, 1, 2, 3]
    soles = sole_ends(biped, world_configurations(biped, orbit))
    for trace in traces:
        own = orbit.step == trace.step
        swing = 1 if orbit.stance[own][0] > 0.0 else 0
        middle = soles[own][:, swing].mean(axis=1)
        for end, place in ((0, middle[0]), (-1, middle[-1])):
            np.testing.assert_allclose(trace.points[end], place, atol=1e-6)
        t = np.linspace(trace.start, trace.end, len(trace.points))
        np.testing.assert_allclose(trace.points[:, 2], np.interp(t, orbit.t[own], middle[:, 2]), atol=1e-3)
    vertices, faces = ribbon(traces[0].points, 0.01)
    assert len(faces) == 2 * (len(traces[0].points) - 1)
    assert [trace.foot.value for trace in traces] == ["right", "left", "right", "left"]
    np.testing.assert_allclose(np.linalg.norm(vertices[::2] - vertices[1::2], axis=1), 0.01)


def test_a_run_with_gaps_is_drawn_as_far_as_it_goes(biped, orbit):
    """No desired posture, no force in flight, and postures that are no numbers after a fall."""
    holes = {name: getattr(orbit, name).copy() for name in ("q", "force", "p_fri", "p_fri_target", "q_b_desired", "u")}
    holes["q_b_desired"][:] = np.nan
    holes["p_fri_target"][:] = np.nan
    holes["force"][10:20] = 0.0
    holes["p_fri"][10:20] = np.nan
    holes["u"][5] = np.inf
    holes["q"][300:] = np.nan
    damaged = replace(orbit, **holes, gait={}, settings={}, outcome="fell: blew up")
    seen = drawable(damaged)
    assert len(seen.t) == 300
    np.testing.assert_array_equal(seen.q_b_desired, seen.q[:, 1:])
    assert "NaN" not in animation_page(biped, damaged, ghost=True).split("const about = ")[1].split("\n")[0]
    holes["q"][:] = np.nan
    with pytest.raises(ValueError, match="no posture"):
        animation_page(biped, replace(orbit, **holes))


def test_ghost_is_the_desired_posture(biped, orbit):
    wrong = replace(orbit, q=orbit.q + np.array([0.0, 0.1, 0.0, 0.0]))
    first, ghost = cast(biped, wrong, ghost=True)
    np.testing.assert_allclose(ghost.trajectory.q[:, 1:], orbit.q_b_desired)
    np.testing.assert_array_equal(ghost.trajectory.q[:, 0], first.trajectory.q[:, 0])
    commands = recorded_scene([first, ghost]).commands
    drawn = {c["path"] for c in commands if c["type"] == "set_object"}
    assert {p.replace("/first/", "/ghost/") for p in drawn if "/first/robot/" in p} <= drawn
    assert not any("/ghost/contact" in path or "/ghost/trace" in path for path in drawn)
    materials = [c["object"]["materials"][0] for c in commands if "/ghost/" in c["path"] and c["type"] == "set_object"]
    assert all(material["transparent"] and material["opacity"] < 0.6 for material in materials)


def test_two_runs_stand_apart_and_end_together(biped, low_torso, orbit, walk):
    actors = cast(biped, orbit, beside=(low_torso, walk.first_steps(2)))
    assert actors[0].shift < -0.3 < 0.3 < actors[1].shift
    about = page_data(actors)
    assert [run["node"] for run in about["runs"]] == ["first", "second"]
    assert about["duration"] == pytest.approx(orbit.t[-1])
    assert about["camera"]["half_width"] > actors[1].shift
    (animation,) = [c for c in recorded_scene(actors).commands if c["type"] == "set_animation"]
    ends = {c["path"]: c["clip"]["tracks"][0]["keys"][-1]["time"] / FPS for c in animation["animations"]}
    # clips of different length would repeat on their own, out of step
    assert min(ends.values()) == max(ends.values()) == pytest.approx(orbit.t[-1])
    overlaid = cast(biped, orbit, beside=(biped, walk), overlay=True)
    assert [actor.shift for actor in overlaid] == [0.0, 0.0]
    assert page_data(overlaid)["overlaid"]


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
    assert visual_model(raised_ankle.robot, raised_ankle.spatial_model).ngeoms == 0
    drawn = {c["path"] for c in recorded_scene(cast(raised_ankle, orbit)).commands if c["type"] == "set_object"}
    assert {"/meshcat/first/robot/left_hip/leg", "/meshcat/first/robot/right_ankle/foot"} <= drawn


def test_missing_mesh_is_named(biped, tmp_path):
    text = biped.description.urdf.read_text(encoding="utf-8")
    urdf = tmp_path / "meshy.urdf"
    mesh = '<mesh filename="package://nowhere/torso.stl"/>'
    urdf.write_text(text.replace('<sphere radius="0.10"/>', mesh), encoding="utf-8")

    meshy = FrontalBiped(Robot.of(replace(biped.description, urdf=urdf)))
    with pytest.raises(RobotError, match=r"meshy\.urdf.*nowhere"):
        visual_model(meshy.robot, meshy.spatial_model)


def test_steps_are_counted_once(biped, walk):
    """The page counts the steps that were completed, and numbers the last one so."""
    (run,) = page_data(cast(biped, walk))["runs"]
    assert run["steps"] == walk.steps_completed == run["phases"][-1]["step"]


def test_page_says_what_is_shown(biped, orbit, walk):
    assert told_source(orbit) == "the gait's periodic orbit, in closed form"
    assert told_source(replace(walk, settings={"period": 1e-3})) == "simulated, control at 1000 Hz"
    assert told_source(replace(walk, settings={"period": None})) == "simulated, continuous control"
    assert told_source(replace(walk, settings={"period": 2e-3, "engine": "mujoco"})).startswith("simulated in MuJoCo")
    assert told_source(replace(walk, settings={})) == ""
