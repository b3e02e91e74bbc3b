"""The imports of a package as a graph, read from its files; nothing is imported.

    python tests/module_graph.py frontal_biped

prints rooms (files and folders directly under the package), floors (a room stands above all it imports), circles of
rooms and circles of files.
"""

import ast
import sys
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path

Graph = dict[str, set[str]]


def module_files(package: Path) -> dict[str, Path]:
    """Dotted name, without ``__init__``, to file."""
    names = {}
    for path in sorted(package.rglob("*.py")):
        parts = (package.name, *path.relative_to(package).with_suffix("").parts)
        names[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return names


@cache  # the architecture's tests look at every file a dozen times
def imported_names(path: Path) -> tuple[str, ...]:
    """Dotted names that a file imports anywhere in it, ``module.name`` for a name; not those for type checking only."""
    found = []
    nodes: list[ast.AST] = [ast.parse(path.read_text(encoding="utf-8"))]
    while nodes:
        node = nodes.pop()
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            nodes += node.orelse
            continue
        if isinstance(node, ast.Import):
            found += [name.name for name in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: imports are absolute"
            found += [f"{node.module}.{name.name}" for name in node.names]
        nodes += ast.iter_child_nodes(node)
    return tuple(found)


def module_of(name: str, modules: Iterable[str]) -> str | None:
    """The module of a dotted name: itself, or what it is defined in."""
    return next((known for known in (name, name.rpartition(".")[0]) if known in modules), None)


def module_graph(package: Path) -> Graph:
    """Each module, package faces (``__init__``) included, to the modules it imports."""
    files = module_files(package)
    graph: Graph = {}
    for module, path in files.items():
        targets = {module_of(name, files) for name in imported_names(path)}
        graph[module] = {target for target in targets if target is not None and target != module}
    return graph


def faces(package: Path) -> set[str]:
    """The packages: their ``__init__`` hands names on."""
    return {module for module, path in module_files(package).items() if path.name == "__init__.py"}


def room(module: str) -> str:
    """File or folder directly under the package."""
    return module.split(".")[1]


def room_graph(package: Path) -> Graph:
    """Each room to the other rooms that its files import."""
    graph, shown = module_graph(package), faces(package)
    rooms: Graph = {}
    for module, targets in graph.items():
        if module == package.name or (module in shown and not graph[module]):
            continue
        inside = rooms.setdefault(room(module), set())
        inside |= {room(target) for target in targets if target != package.name} - {room(module)}
    return rooms


def circles(graph: Mapping[str, set[str]]) -> list[list[str]]:
    """Sets of nodes that reach each other, larger than one (Tarjan)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(node: str) -> None:
        index[node] = low[node] = len(index)
        stack.append(node)
        for target in graph[node]:
            if target not in index:
                visit(target)
                low[node] = min(low[node], low[target])
            elif target in stack:
                low[node] = min(low[node], index[target])
        if low[node] == index[node]:
            component = [stack.pop()]
            while component[-1] != node:
                component.append(stack.pop())
            if len(component) > 1:
                found.append(sorted(component))

    for node in graph:
        if node not in index:
            visit(node)
    return found


def floors(graph: Mapping[str, set[str]]) -> dict[str, int]:
    """Height of every node above the ground, 1; of a graph without circles."""
    height: dict[str, int] = {}

    def at(node: str) -> int:
        if node not in height:
            height[node] = 1 + max((at(target) for target in graph[node]), default=0)
        return height[node]

    for node in graph:
        at(node)
    return height


def main(package: Path) -> None:
    rooms, files = room_graph(package), module_graph(package)
    tangled = circles(rooms)
    print(f"{len(rooms)} rooms on {max(floors(rooms).values()) if not tangled else '?'} floors")
    print(f"{len(tangled)} circles of rooms {tangled or ''}")
    print(f"{len(circles(files))} circles of files {circles(files) or ''}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
