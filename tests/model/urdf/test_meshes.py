"""Meshes come from the robot's folders and from nowhere else, and broken ones are told instead of read."""

import json
import os
import struct
import time
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped.exceptions import RobotError
from frontal_biped.model.urdf import meshes
from frontal_biped.model.urdf.shapes import build_shapes

LINK = (
    '<link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
DAE = (
    '<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">'
    '<asset><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="p">'
    '<float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>'
    '<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>'
    '<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v">'
    '<input semantic="POSITION" source="#p"/></vertices><triangles count="1">'
    '<input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>'
    '<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene>'
    '</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>'
)

_DEEP = DAE.replace('<node id="n">', "<node>" * 20_000 + '<node id="n">')
_LAUGHS = "".join(f'<!ENTITY e{i + 1} "{f"&e{i};" * 10}">' for i in range(9)).replace("&e0;", "ha")
_FILE = '<!ENTITY e SYSTEM "file:///etc/passwd">'
BROKEN_DAE = {
    "empty": "",
    "cut": DAE[:500],
    "cut late": DAE[:-200],
    "an index too far": DAE.replace("0 1 2<", "0 1 99999<"),
    "a negative index": DAE.replace("0 1 2<", "0 1 -5<"),
    "a lying count": DAE.replace('count="1"', 'count="99999999"'),
    "a lying array": DAE.replace('count="9"', 'count="999999999"'),
    "no scene": DAE.replace("<scene>", "<other>"),
    "in a circle, where Assimp crashes": DAE.replace("</node>", '<instance_node url="#n"/></node>'),
    "deep, where Assimp crashes": _DEEP.replace("</node></vis", "</node>" + "</node>" * 20_000 + "</vis"),
    "entities": DAE.replace("<COLLADA", f"<!DOCTYPE x [{_LAUGHS}]><COLLADA", 1).replace("0 0 0 1", "&e9;"),
    "a file": DAE.replace("<COLLADA", f"<!DOCTYPE x [{_FILE}]><COLLADA", 1).replace("0 0 0 1", "&e; 1"),
}


def stl(count=1, told=None, corner=1.0):
    facet = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, corner, 0, 0, 0, 1, 0, 0)
    return b"\0" * 80 + struct.pack("<I", count if told is None else told) + facet * count


def gltf(uri):
    return json.dumps(
        {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"uri": uri, "byteLength": 36}],
        }
    )  # fmt: skip


def put(path, content=None):
    path.parent.mkdir(parents=True, exist_ok=True)
    content = stl() if content is None else content
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def read(urdf, name, kind=pin.GeometryType.VISUAL, more=""):
    """The file that a robot's one mesh is read from."""
    shape = f'<geometry><mesh filename="{name}"/></geometry>{more}'
    text = f'<robot name="r">{LINK}<visual>{shape}</visual><collision>{shape}</collision></link></robot>'
    put(urdf, text)
    shapes = build_shapes(pin.buildModelFromXML(text), urdf, text, kind)
    assert [shape.meshTexturePath for shape in shapes.geometryObjects] == [""]
    return Path(shapes.geometryObjects[0].meshPath)


def refused(urdf, name):
    """What is said of a robot's one mesh: one line."""
    with pytest.raises(RobotError) as error:
        read(urdf, name)
    message = str(error.value)
    assert "\n" not in message and message.startswith(f"{urdf}: mesh {name[:200]!r}") and ";" in message
    return message


@pytest.fixture(autouse=True)
def no_environment(monkeypatch):
    for name in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
        monkeypatch.delenv(name, raising=False)


@pytest.fixture
def workspace(tmp_path):
    """Folders for robots, a few levels down, with somebody's secret above."""
    put(tmp_path / "secret.stl")
    put(tmp_path / "private" / "secret.stl")
    folder = tmp_path / "a" / "b" / "c"
    folder.mkdir(parents=True)
    return folder


class TestWhere:
    @pytest.mark.parametrize(
        ("urdf", "mesh", "name"),
        [
            ("r/r.urdf", "r/x.stl", "x.stl"),
            ("r/r.urdf", "r/meshes/v/x.stl", "meshes/v/x.stl"),
            ("r/urdf/r.urdf", "r/meshes/x.stl", "../meshes/x.stl"),
            ("r/urdf/r.urdf", "r/meshes/x.stl", "package://r/meshes/x.stl"),
            ("r/model/robots/r.urdf", "r/model/meshes/x.stl", "package://r/model/meshes/x.stl"),
            ("r/meshes.urdf", "r/meshes/x.stl", "package://meshes/x.stl"),
            ("r/r.urdf", "r/meshes/x.stl", "package:///meshes/x.stl"),
            ("r/r.urdf", "r/meshes/x.stl", "package://renamed/meshes/x.stl"),
            ("r/urdf/r.urdf", "r/meshes/x.stl", "package://renamed/meshes/x.stl"),
            ("p/q/r/models/r1/urdf/r.urdf", "p/q/r/models/r1/meshes/x.stl", "package://q/r/models/r1/meshes/x.stl"),
        ],
    )  # fmt: skip
    def test_where_robots_keep_their_meshes(self, workspace, urdf, mesh, name):
        there = put(workspace / mesh)
        for kind in (pin.GeometryType.VISUAL, pin.GeometryType.COLLISION):
            assert read(workspace / urdf, name, kind) == there

    def test_absolute_names_into_the_robots_own_folders(self, workspace):
        there = put(workspace / "r" / "x.stl")
        for name in (str(there), f"file://{there}"):
            assert read(workspace / "r" / "r.urdf", name) == there

    def test_a_ros_package_reaches_as_far_as_its_package_xml(self, workspace):
        put(workspace / "r" / "package.xml", "")
        there = put(workspace / "r" / "x" / "y.stl")
        for name in ("../../../x/y.stl", "package://r/x/y.stl", "package://named_otherwise/x/y.stl"):
            assert read(workspace / "r" / "d" / "e" / "urdf" / "r.urdf", name) == there

    def test_a_package_beside_it_is_one_with_a_package_xml(self, workspace):
        there = put(workspace / "its_meshes" / "x.stl")
        urdf = workspace / "r" / "urdf" / "r.urdf"
        assert "could not be found" in refused(urdf, "package://its_meshes/x.stl")
        put(workspace / "its_meshes" / "package.xml", "")
        assert read(urdf, "package://its_meshes/x.stl") == there

    @pytest.mark.parametrize(
        ("variable", "inside"), [("ROS_PACKAGE_PATH", ""), ("AMENT_PREFIX_PATH", "share")]
    )  # fmt: skip
    def test_the_environments_packages_with_their_links(self, workspace, tmp_path, monkeypatch, variable, inside):
        source = put(tmp_path / "src" / "x.stl")
        link = tmp_path / "install" / inside / "far" / "meshes" / "x.stl"
        link.parent.mkdir(parents=True)
        link.symlink_to(source)
        urdf = workspace / "r.urdf"
        assert "could not be found" in refused(urdf, "package://far/meshes/x.stl")
        monkeypatch.setenv(variable, f"/nowhere{os.pathsep}{tmp_path / 'install'}")
        assert read(urdf, "package://far/meshes/x.stl") == source
        for name in ("package://far/../../../secret.stl", "package://../secret.stl", "package://far/../../secret.stl"):
            assert "secret" in refused(urdf, name)

    @pytest.mark.parametrize("height", range(1, 6))
    def test_names_that_climb_out(self, workspace, height):
        urdf = workspace / "r" / "urdf" / "r.urdf"
        put(workspace / "secret.stl")
        names = ["../" * height + "secret.stl", "meshes/" + "../" * (height + 1) + "secret.stl"]
        for name in names[height == 1 :]:
            assert "outside the robot's folders" in refused(urdf, name) if height > 1 else refused(urdf, name)

    def test_names_of_the_whole_disk(self, workspace, tmp_path, monkeypatch):
        urdf = workspace / "r" / "urdf" / "r.urdf"
        monkeypatch.setenv("HOME", str(tmp_path))
        secret = tmp_path / "private" / "secret.stl"
        below = secret.relative_to("/").as_posix()
        names = [str(secret), f"file://{secret}", f"file:///{secret}", f"package://{below}", f"package:///{below}",
                 f"package://{tmp_path.name}/private/secret.stl", "package://private/secret.stl", f"file://localhost{secret}",
                 f"http://stranger.test{secret}", f"model://{secret}", f"package://r/../../../../../{below}",
                 f"//{secret}", f"/.{secret}", f"FILE://{secret}"]  # fmt: skip
        for name in names:
            message = refused(urdf, name)
            assert "outside the robot's folders" in message or "could not be found" in message, name

    def test_home_and_the_top_of_the_disk_are_no_robots(self, workspace, tmp_path, monkeypatch):
        put(tmp_path / "package.xml", "")
        urdf = tmp_path / "downloads" / "r.urdf"
        assert read(urdf, "../private/secret.stl") == tmp_path / "private" / "secret.stl"
        for home in (tmp_path, tmp_path / "downloads", tmp_path / "user"):
            monkeypatch.setenv("HOME", str(home))
            for name in ("../private/secret.stl", f"package://{tmp_path.name}/private/secret.stl"):
                if home.name != "user":
                    assert "outside the robot's folders" in refused(urdf, name), home
        monkeypatch.undo()
        assert not meshes._is_robots(Path("/")) and not meshes._is_robots(Path("/tmp"))

    def test_links_count_for_what_they_lead_to(self, workspace, tmp_path):
        urdf = workspace / "r" / "r.urdf"
        there = put(workspace / "r" / "meshes" / "x.stl")
        (workspace / "r" / "same.stl").symlink_to(there)
        assert read(urdf, "same.stl") == there
        (workspace / "r" / "y.stl").symlink_to(tmp_path / "secret.stl")
        (workspace / "r" / "folder").symlink_to(tmp_path / "private")
        for name in ("y.stl", "folder/secret.stl", "package://r/folder/secret.stl", "package://renamed/y.stl"):
            assert "outside the robot's folders" in refused(urdf, name)
        elsewhere = workspace / "named" / "r.urdf"
        elsewhere.parent.mkdir()
        elsewhere.symlink_to(urdf)  # the URDF is where it really is
        assert read(elsewhere, "meshes/x.stl") == there

    def test_textures_are_not_looked_up(self, workspace):
        put(workspace / "x.stl")
        put(workspace / "t.png", "")
        texture = '<material name="m"><color rgba="1 0 0 1"/><texture filename="package://c/t.png"/></material>'
        assert read(workspace / "r.urdf", "x.stl", more=texture)

    def test_a_name_that_is_not_there_tells_where_it_was_searched(self, workspace):
        message = refused(workspace / "r" / "r.urdf", "package://nowhere/x.stl")
        for word in ("could not be found; searched", str(workspace / "r"), "ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
            assert word in message
        assert len(refused(workspace / "r" / "r.urdf", "x" * 5000)) < 1000


class TestWhat:
    @pytest.mark.parametrize(
        ("name", "content"),
        [("x.stl", stl(5)), ("x.STL", stl()), ("x.obj", OBJ), ("x.obj", "mtllib x.mtl\nmtllib none.mtl\n" + OBJ),
         ("x.dae", DAE), ("x.gltf", gltf("part.bin")),
         ("x.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
                   "endfacet\nendsolid\n")],
    )  # fmt: skip
    def test_good_meshes(self, workspace, name, content):
        put(workspace / "x.mtl", "newmtl a\n")
        put(workspace / "part.bin", struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0))
        there = put(workspace / name, content)
        assert read(workspace / "r.urdf", name) == there

    @pytest.mark.parametrize(
        "content",
        [b"", b"solid", stl(0), stl(2, told=2**32 - 1), stl(2, told=1000), stl(2)[:-7], b"version https://git-lfs",
         stl(corner=np.nan), stl(corner=np.inf), b"root:x:0:0:root:/root:/bin/sh\n" * 40, bytes(range(256)) * 9],
    )  # fmt: skip
    def test_broken_stl(self, workspace, content, capfd):
        put(workspace / "x.stl", content)
        refused(workspace / "r.urdf", "x.stl")
        assert capfd.readouterr() == ("", "")

    @pytest.mark.parametrize(
        "content", ["", "v 0 0 0\n", "f 1 2 3\n", OBJ.replace("3\n", "99999\n"), OBJ.replace("f 1", "f 0"), OBJ[:-3],
                    OBJ.replace("f 1", "f -9"), OBJ.replace("v 1", "v nan"), OBJ.replace("v 1", "v x")],
    )  # fmt: skip
    def test_broken_obj(self, workspace, content, capfd):
        put(workspace / "x.obj", content)
        refused(workspace / "r.urdf", "x.obj")
        assert capfd.readouterr() == ("", "")

    @pytest.mark.parametrize("content", BROKEN_DAE.values(), ids=BROKEN_DAE)
    def test_broken_dae(self, workspace, content, capfd):
        put(workspace / "x.dae", content)
        assert "cannot be read" in refused(workspace / "r.urdf", "x.dae")
        assert capfd.readouterr() == ("", "")

    @pytest.mark.parametrize("uri", ["../secret.bin", "/etc/passwd", "file:///etc/passwd", "http://stranger.test/x",
                                     "..\\\\secret.bin", "%2e%2e/secret.bin", "link.bin", "pipe", ""])  # fmt: skip
    def test_gltf_that_refers_to_other_files(self, workspace, uri):
        put(workspace.parent / "secret.bin", b"s" * 36)
        (workspace / "link.bin").symlink_to(workspace.parent / "secret.bin")
        os.mkfifo(workspace / "pipe")
        put(workspace / "x.gltf", gltf(uri))
        assert "no file beside it" in refused(workspace / "r.urdf", "x.gltf")
        put(workspace / "x.gltf", gltf("data:,x").replace('"uri":', f'"uri": {json.dumps(uri)}, "uri":'))
        assert "twice" in refused(workspace / "r.urdf", "x.gltf")

    @pytest.mark.parametrize("line", ["mtllib pipe", "mtllib /dev/zero", "mtllib ../../x.mtl", "\tmtllib pipe",
                                      "x\rmtllib pipe", "x\fmtllib pipe",
                                      "mtl\\\nlib pipe", "mtllib \\\n pipe"])  # fmt: skip
    def test_obj_that_refers_to_other_files(self, workspace, line):
        os.mkfifo(workspace / "pipe")
        put(workspace / "x.obj", f"{OBJ}{line}\n{OBJ}")
        started = time.monotonic()
        assert "no file beside it" in refused(workspace / "r.urdf", "x.obj")
        assert time.monotonic() - started < 5.0

    def test_what_is_no_mesh_file(self, workspace):
        put(workspace / "x.ply", OBJ)
        put(workspace / "passwd", "root:x:0:0")
        (workspace / "folder.stl").mkdir()
        os.mkfifo(workspace / "pipe.stl")
        with (workspace / "big.stl").open("wb") as stream:
            stream.truncate(10**12)
        (workspace / "gone.stl").symlink_to(workspace / "nowhere.stl")
        urdf = workspace / "r.urdf"
        for name in ("x.ply", "passwd", ""):
            assert "is no .stl, .dae, .obj, .gltf file" in refused(urdf, name) or name == ""
        assert "a directory" in refused(urdf, "folder.stl")
        assert "a device or a pipe" in refused(urdf, "pipe.stl")
        assert "larger than 200000000 bytes" in refused(urdf, "big.stl")
        assert "No such file" in refused(urdf, "gone.stl")

    def test_one_that_takes_too_long_is_given_up(self, workspace, monkeypatch):
        monkeypatch.setattr(meshes, "TRIAL_SECONDS", 3.0)
        put(workspace / "x.obj", OBJ + "f " + "1 2 3 " * 200_000)
        assert "cannot be read within 3 s" in refused(workspace / "r.urdf", "x.obj")

    def test_a_trial_runs_no_file_of_the_working_folder(self, workspace, monkeypatch):
        for module in ("coal", "numpy", "resource"):
            put(workspace / f"{module}.py", f"open({str(workspace / 'ran')!r}, 'w')")
        monkeypatch.chdir(workspace)
        put(workspace / "x.obj", OBJ)
        assert read(workspace / "r.urdf", "x.obj")
        assert not (workspace / "ran").exists()

    def test_a_mesh_is_tried_once_and_again_when_it_has_changed(self, workspace, monkeypatch):
        there = put(workspace / "x.obj", OBJ)
        assert read(workspace / "r.urdf", "x.obj")
        trials = []
        monkeypatch.setattr(meshes.subprocess, "run", lambda *_, **__: trials.append(1))
        assert read(workspace / "r.urdf", "x.obj")
        assert trials == []
        put(there, OBJ + "# changed\n")
        with pytest.raises(AttributeError):
            read(workspace / "r.urdf", "x.obj")
        assert trials == [1]
