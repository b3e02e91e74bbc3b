"""The one-way architecture, read from the imports themselves."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import frontal_biped

PACKAGE = Path(frontal_biped.__file__).parent

ANYONE = {"arrays", "exceptions", "files", "toml_fields", "version", "provenance"}
"""Helpers without mechanics; every place may use them."""

# place: the other places it may import; model -> virtual_constraints -> zero_dynamics -> poincare -> gait -> design
MAY_IMPORT = {
    "model": set(),
    "quadrature": set(),
    "quadratic_program": set(),
    "least_distance": set(),
    "virtual_constraints": {"model"},
    "zero_dynamics": {"model", "virtual_constraints", "quadrature"},
    "poincare": {"model", "virtual_constraints", "zero_dynamics"},
    "phase_energy": {"model", "virtual_constraints", "zero_dynamics"},
    "half_steps": {"model", "virtual_constraints", "poincare", "phase_energy"},
    "chebyshev": set(),
    "reversal": {"model", "virtual_constraints", "zero_dynamics", "poincare", "gait"},
    "reversal_problem": {"model", "virtual_constraints", "poincare", "reversal"},
    "reversal_solver": {"poincare", "reversal_problem"},
    "reversal_zeros": {"chebyshev", "reversal_problem"},
    "reversal_certificate": {"zero_dynamics", "poincare", "chebyshev", "reversal_problem", "reversal_zeros"},
    "gait": {"model", "virtual_constraints", "zero_dynamics", "poincare"},
    "design": {
        "model", "quadrature", "virtual_constraints", "zero_dynamics", "poincare", "gait", "simulation", "walking",
        "least_distance",
    },
    "library": {"model", "design", "gait"},
    "contact_margins": {"model", "zero_dynamics", "poincare", "phase_energy", "half_steps", "gait"},
    "control": {
        "model", "virtual_constraints", "gait", "quadratic_program", "least_distance", "phase_energy", "half_steps",
        "contact_margins",
    },
    "return_map": {"model", "virtual_constraints", "phase_energy", "half_steps", "gait", "contact_margins", "control"},
    "simulation": {"model", "virtual_constraints", "control"},
    "cross_check": {"model", "zero_dynamics", "gait", "simulation", "walking"},
    "scenarios": {"model", "gait", "control", "design", "simulation", "walking"},
}  # fmt: skip

APPLICATIONS = {"cli", "demo", "studio", "pytest_plugin", "__main__"}
"""They see everything, and nothing below sees them."""

# foreign package: the only places that may import it
ONLY_IN = {
    "meshcat": {"visualisation"},
    "matplotlib": {"visualisation"},
    "umsgpack": {"visualisation"},
    "proxsuite": {"quadratic_program"},
    "distributed": {"library"},
    "mujoco": {"simulation"},
    "viser": {"studio"},
    "pytest": {"pytest_plugin"},
    "playwright": {"visualisation"},
    "PIL": {"visualisation"},
}


def imports(path: Path) -> set[str]:
    """Dotted names of the modules a file imports, anywhere in it, except for type checking only."""
    found = set()
    nodes = [ast.parse(path.read_text(encoding="utf-8"))]
    while nodes:
        node = nodes.pop()
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            nodes += node.orelse
            continue
        if isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: imports are absolute"
            found |= {f"{node.module}.{name.name}" for name in node.names}
        nodes += ast.iter_child_nodes(node)
    return found


def imports_by_place() -> dict[str, set[str]]:
    """What each module or subpackage at the top level of the package imports."""
    table: dict[str, set[str]] = {}
    for path in PACKAGE.rglob("*.py"):
        place = path.relative_to(PACKAGE).with_suffix("").parts[0]
        if place != "__init__":
            table.setdefault(place, set()).update(imports(path))
    return table


@pytest.fixture(scope="module")
def imported():
    return imports_by_place()


@pytest.fixture(scope="module")
def arrows(imported):
    """Place to the other places of the package that it imports."""
    return {
        place: {name.split(".")[1] for name in names if name.startswith("frontal_biped.")} - {place}
        for place, names in imported.items()
    }


@pytest.mark.parametrize("place", MAY_IMPORT)
def test_imports_go_one_way(arrows, place):
    assert arrows[place] - ANYONE <= MAY_IMPORT[place]


@pytest.mark.parametrize("place", sorted(ANYONE))
def test_helpers_know_nothing_of_the_robot(arrows, place):
    assert arrows[place] <= ANYONE


def test_no_cycles(arrows):
    left = {place: set(names) for place, names in arrows.items()}
    while left:
        leaves = {place for place, names in left.items() if not names & set(left)}
        assert leaves, f"a cycle among {sorted(left)}"
        left = {place: names for place, names in left.items() if place not in leaves}


def test_nothing_sees_the_applications(arrows):
    for place, names in arrows.items():
        if place not in APPLICATIONS:
            assert not names & APPLICATIONS, place


def test_only_applications_see_the_visualisation(arrows):
    for place, names in arrows.items():
        if place not in APPLICATIONS:
            assert "visualisation" not in names, place


@pytest.mark.parametrize("package", ONLY_IN)
def test_foreign_packages_keep_to_their_place(imported, package):
    users = {place for place, names in imported.items() if any(name.split(".")[0] == package for name in names)}
    assert users <= ONLY_IN[package]


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
