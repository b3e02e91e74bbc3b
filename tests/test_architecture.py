"""The one-way architecture, read from the imports themselves (`module_graph`)."""

import subprocess
import sys
from pathlib import Path

import pytest
from module_graph import circles, faces, floors, imported_names, module_files, module_graph, room_graph

import frontal_biped

PACKAGE = Path(frontal_biped.__file__).parent
TESTS = Path(__file__).parent

MOST_ROOMS, MOST_FLOORS = 22, 13
"""What a newcomer can keep in mind: files and folders directly under the package, and how high they are stacked."""

ANYONE = {"arrays", "exceptions", "version", "files", "numerics"}
"""Rooms without mechanics; every room may use them."""

MECHANICS = {"model", "virtual_constraints", "zero_dynamics"}

# room: the other rooms it may import. The paper's sections from the ground up, then what is built on them.
MAY_IMPORT = {
    "arrays": set(),
    "exceptions": set(),
    "version": set(),
    "files": {"arrays", "exceptions", "version"},
    "numerics": {"arrays", "exceptions"},
    "model": ANYONE,
    "virtual_constraints": ANYONE | {"model"},
    "zero_dynamics": ANYONE | {"model", "virtual_constraints"},
    "gait": ANYONE | MECHANICS,
    "control": ANYONE | MECHANICS | {"gait"},
    "simulation": ANYONE | MECHANICS | {"gait", "control"},
    "design": ANYONE | MECHANICS | {"gait", "simulation"},
    "analysis": ANYONE | MECHANICS | {"gait", "control", "simulation"},
    "viewer": ANYONE | {"model", "virtual_constraints", "gait", "simulation"},
    "library": ANYONE | {"model", "gait", "design"},
    "scenarios": ANYONE | {"model", "gait", "control", "simulation", "design"},
    "figures": ANYONE | MECHANICS | {"gait", "control", "simulation", "design", "analysis"},
    "studio": ANYONE | {"model", "virtual_constraints", "gait", "simulation", "design", "analysis", "viewer"},
    "demo": ANYONE | {
        "model", "gait", "control", "simulation", "design", "analysis", "viewer", "figures", "library",
    },
    "pytest_plugin": {"exceptions", "scenarios"},
    "cli": ANYONE | {
        "model", "gait", "control", "simulation", "design", "analysis", "viewer", "figures", "library", "scenarios",
        "studio", "demo",
    },
    "__main__": {"cli"},
}  # fmt: skip

# foreign package: the only modules, or packages of them, that may import it
ONLY_IN = {
    "meshcat": {"viewer"},
    "umsgpack": {"viewer"},
    "playwright": {"viewer.headless"},
    "PIL": {"viewer"},
    "matplotlib": {"figures"},
    "proxsuite": {"numerics.quadratic_program"},
    "distributed": {"library.executors"},
    "mujoco": {"simulation.mujoco"},
    "flint": {"zero_dynamics.proof.balls"},
    "viser": {"studio"},
    "mcap_ros2": {"simulation.mcap_log"},
    "pytest": {"pytest_plugin"},
}


@pytest.fixture(scope="module")
def rooms():
    return room_graph(PACKAGE)


@pytest.fixture(scope="module")
def modules():
    return module_graph(PACKAGE)


def test_every_room_has_its_place_in_the_table(rooms):
    assert set(rooms) == set(MAY_IMPORT)


@pytest.mark.parametrize("room", MAY_IMPORT)
def test_imports_go_one_way(rooms, room):
    """The table is what the code does, no more: an arrow that goes, or comes, is seen."""
    assert rooms[room] <= MAY_IMPORT[room]
    assert MAY_IMPORT[room] - ANYONE <= rooms[room]


def test_house_stays_small(rooms):
    assert len(rooms) <= MOST_ROOMS
    assert max(floors(rooms).values()) <= MOST_FLOORS


def test_no_circles_of_rooms(rooms):
    assert circles(rooms) == []


def test_no_circles_of_files(modules):
    """Neither between packages nor inside one; package faces are files like any other."""
    assert circles(modules) == []


def test_names_are_imported_from_the_module_that_defines_them(modules):
    """A face (``__init__``) is for users; inside, going through one would tie a module to all the face hands on."""
    shown = faces(PACKAGE)
    through = {
        module: sorted(targets & shown)
        for module, targets in modules.items()
        if module not in shown and targets & shown and module not in FACES_ON_PURPOSE
    }
    assert through == {}


FACES_ON_PURPOSE = {"frontal_biped.__main__"}
"""Behave as a user would."""


@pytest.mark.parametrize("package", ONLY_IN)
def test_foreign_packages_keep_to_their_place(package):
    places = tuple(f"frontal_biped.{place}" for place in ONLY_IN[package])
    users = {
        module
        for module, path in module_files(PACKAGE).items()
        if any(name.split(".")[0] == package for name in imported_names(path))
    }
    strangers = {module for module in users if not f"{module}.".startswith(tuple(f"{place}." for place in places))}
    assert users
    assert strangers == set()


def test_tests_mirror_the_package():
    """Every folder of tests is a package, and every package has a folder of tests."""
    apart = {"benchmarks", "data"}
    tested = {
        str(folder.relative_to(TESTS))
        for path in TESTS.rglob("test_*.py")
        if (folder := path.parent) != TESTS and folder.relative_to(TESTS).parts[0] not in apart
    }
    packages = {"/".join(face.split(".")[1:]) for face in faces(PACKAGE)} - {""}
    assert tested == packages


class TestTheDetectors:
    """The checks above would see what they look for."""

    @pytest.fixture
    def tangled(self, tmp_path):
        files = {
            "a/__init__.py": "from house.a.one import x",
            "a/one.py": "def f():\n    from house.a import two",
            "a/two.py": "from house.a.one import x\nimport house.b",
            "b.py": "if TYPE_CHECKING:\n    from house.c import z",
            "c.py": "from house.a import x",
        }
        for name, text in {"__init__.py": "", **files}.items():
            path = tmp_path / "house" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return tmp_path / "house"

    def test_a_circle_inside_a_package(self, tangled):
        assert circles(module_graph(tangled)) == [["house.a.one", "house.a.two"]]

    def test_arrows_and_floors(self, tangled):
        assert room_graph(tangled) == {"a": {"b"}, "b": set(), "c": {"a"}}
        assert floors(room_graph(tangled)) == {"b": 1, "a": 2, "c": 3}

    def test_a_circle_of_rooms(self, tangled):
        (tangled / "b.py").write_text("import house.c", encoding="utf-8")
        assert circles(room_graph(tangled)) == [["a", "b", "c"]]


@pytest.mark.parametrize(
    "statement",
    [
        "import frontal_biped",
        "import frontal_biped; [getattr(frontal_biped, name) for name in frontal_biped.__all__]",
    ],
)
def test_import_loads_no_viewer(statement):
    code = f"import sys; {statement}; print([name for name in ('meshcat', 'matplotlib') if name in sys.modules])"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    assert run.stdout.strip() == "[]"


def test_public_names_exist():
    for name in frontal_biped.__all__:
        assert getattr(frontal_biped, name) is not None
    with pytest.raises(AttributeError, match="no_such_name"):
        frontal_biped.no_such_name  # noqa: B018
