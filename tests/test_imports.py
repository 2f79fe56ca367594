"""Imports: no circle between files, floors that hold, the toolbox that knows no ship, no class name twice."""

from __future__ import annotations

import ast
import collections
import shutil
import subprocess
import sysconfig
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
SOURCES = sorted([*(ROOT / "shipid").rglob("*.py"), *(ROOT / "models").rglob("*.py")])
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def dotted(path: Path) -> str:
    """The name a source file is imported by."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    parts = ("shipid", *parts) if parts[0] == "models" else parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imported(tree: ast.Module) -> set[str]:
    """Every name that an import statement names, those for types and inside functions included."""
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return names


def graph_of(sources: dict[str, ast.Module]) -> dict[str, set[str]]:
    """Which file imports which. The face of the package hands names on when they are asked for, and imports none."""
    return {
        name: {n for n in imported(tree) if n in sources and n != name and n != "shipid"}
        for name, tree in sources.items()
    }


def circle_in(graph: dict[str, set[str]]) -> list[str]:
    """One circle, or nothing."""
    state: dict[str, int] = {}

    def visit(name: str, path: list[str]) -> list[str]:
        state[name] = 1
        for other in sorted(graph[name]):
            if state.get(other) == 1:
                return [*path[path.index(other) :], other]
            if other not in state and (found := visit(other, [*path, other])):
                return found
        state[name] = 2
        return []

    for name in sorted(graph):
        if name not in state and (found := visit(name, [name])):
            return found
    return []


@pytest.fixture(scope="module")
def trees() -> dict[str, ast.Module]:
    return {dotted(p): ast.parse(p.read_text(encoding="utf-8")) for p in SOURCES}


def test_no_circle_between_files(trees: dict[str, ast.Module]) -> None:
    assert circle_in(graph_of(trees)) == []


def test_a_circle_would_be_found() -> None:
    sources = {
        "a": "def f():\n    from b import g",
        "b": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from c import h",
        "c": "import a",
        "d": "import a",
    }
    graph = graph_of({name: ast.parse(text) for name, text in sources.items()})
    assert circle_in(graph) == ["a", "b", "c", "a"]
    graph["c"] = set()
    assert circle_in(graph) == []


def test_contracts_hold() -> None:
    program = shutil.which("lint-imports", path=sysconfig.get_path("scripts")) or shutil.which("lint-imports")
    if program is None:
        pytest.skip("import-linter is not installed: install shipid[test]")
    done = subprocess.run([program, "--no-cache"], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    contracts = len(PROJECT["tool"]["importlinter"]["contracts"])
    assert f"{contracts} kept, 0 broken" in done.stdout


def test_every_room_stands_on_a_floor() -> None:
    floors = {f for c in PROJECT["tool"]["importlinter"]["contracts"] if c["type"] == "layers" for f in c["layers"]}
    named = {room.strip() for floor in floors for room in floor.split("|")}
    rooms = {dotted(p.parent / "__init__.py") for p in (ROOT / "shipid").glob("*/__init__.py")}
    assert rooms <= named


def test_the_toolbox_imports_no_ship(trees: dict[str, ast.Module]) -> None:
    toolbox = {n: tree for n, tree in trees.items() if not n.startswith("shipid.models")}
    assert len(toolbox) > 300
    ships = {
        name: {n for n in imported(tree) if n.startswith(("shipid.models", "models."))}
        for name, tree in toolbox.items()
    }
    named = {name for name, tree in toolbox.items() if "models" in imported(tree)}
    assert {name for name, found in ships.items() if found} | named == set()


def test_no_class_name_stands_twice(trees: dict[str, ast.Module]) -> None:
    places = collections.defaultdict(list)
    for name, tree in trees.items():
        for node in tree.body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                places[node.name].append(name)
    assert {n: p for n, p in places.items() if len(p) > 1} == {}


def test_a_folder_is_one_room() -> None:
    """A folder past a dozen files hides a room; ``models`` has one file a family, and the command line one a command."""
    files = collections.Counter(p.parent.relative_to(ROOT).as_posix() for p in SOURCES if p.name != "__init__.py")
    assert {f: n for f, n in files.items() if n > 12 and f not in ("models", "shipid/cli")} == {}
