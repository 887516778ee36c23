# SPDX-License-Identifier: GPL-3.0-or-later
"""The rules of docs/architecture.md.

They say who may import whom, and how long a function may be.
"""

import ast
import gc
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
ROOMS = ("addon", "lib", "reference_scenes")
BLENDER = {"bpy", "mathutils", "bpy_extras"}
LONGEST = 60
# Half a second or so each: `import scipy` loads them where they are first used.
SLOW_TO_LOAD = {
    f"scipy.{name}" for name in ("stats", "interpolate", "optimize", "ndimage", "integrate", "signal", "fft")
}


@cache
def parsed(path):
    """The syntax tree of a file.

    The garbage collector, which would look at all trees again and again, never does: they stay to the end.
    """
    gc.disable()
    try:
        return ast.parse(path.read_text(encoding="utf-8"))
    finally:
        gc.freeze()
        gc.enable()


@cache
def statements(path):
    """All statements of a file, those in functions and classes too.

    Imports and functions are among them. What lies in expressions, most of a tree, is not visited.
    """
    found, ahead = [], [parsed(path)]
    while ahead:
        node = ahead.pop()
        for name in ("body", "orelse", "finalbody", "handlers", "cases"):
            inner = getattr(node, name, [])
            if isinstance(inner, list):
                ahead += inner
                found += inner
    return found


def sources():
    """Every Python file of the product."""
    return [*ROOT.glob("*.py"), *(path for room in ROOMS for path in (ROOT / room).rglob("*.py"))]


def modules():
    """Dotted name -> (file, whether it is a package); the root's name is empty."""
    found = {}
    for path in sources():
        parts = path.relative_to(ROOT).with_suffix("").parts
        is_package = parts[-1] == "__init__"
        found[".".join(parts[:-1] if is_package else parts)] = path, is_package
    return found


def imports(name, known):
    """The files of the tree that the file `name` imports.

    Imports in functions and those that only a type checker reads count too. What does not count: that importing a file runs the
    `__init__.py` of the packages it lies in, and the second Blender's worker, which imports by text in a process of its own.
    """
    path, is_package = known[name]
    package = name.split(".") if is_package else name.split(".")[:-1]
    found = set()
    for node in statements(path):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = [*package[: len(package) - (node.level - 1)], *(node.module or "").split(".")]
            target = ".".join(filter(None, base))
            names = {one.name: f"{target}.{one.name}".strip(".") for one in node.names}
            found |= {full if full in known else target for full in names.values()}
    return {one for one in found if one in known and one != name}


def by_package(graph, known):
    """The graph of packages that a graph of files makes.

    A package and one that lies in it are two.
    """
    package = {name: name if known[name][1] else name.rpartition(".")[0] for name in known}
    merged = {one: set() for one in package.values()}
    for name, targets in graph.items():
        merged[package[name]] |= {package[target] for target in targets} - {package[name]}
    return merged


def circle(graph):
    """A circle of a graph, or None."""
    try:
        tuple(TopologicalSorter(graph).static_order())
    except CycleError as error:
        return error.args[1]
    return None


def test_no_files_and_no_packages_import_each_other_in_a_circle():
    known = modules()
    graph = {name: imports(name, known) for name in known}
    assert circle(graph) is None
    assert circle(by_package(graph, known)) is None


def test_a_circle_is_seen():
    assert circle({"a": {"b"}, "b": {"c"}, "c": {"a"}})


def test_a_circle_of_packages_without_one_of_files_is_seen():
    known = {"a": ("", True), "a.x": ("", False), "a.y": ("", False), "b": ("", True), "b.z": ("", False)}
    graph = {"a.x": {"b.z"}, "b.z": {"a.y"}}
    assert circle(graph) is None
    assert circle(by_package(graph, known))


@pytest.mark.parametrize(
    "text", ["from ..b import y", "def f():\n    from ..b.y import g", "if TYPE_CHECKING:\n    from ..b.y import G"]
)
def test_imports_in_functions_and_for_type_checkers_count(tmp_path, text):
    path = tmp_path / "x.py"
    path.write_text(text)
    assert imports("a.x", {"a.x": (path, False), "b.y": (path, False)}) == {"b.y"}


def test_lib_imports_no_blender():
    for path in (ROOT / "lib").rglob("*.py"):
        for node in statements(path):
            names = [one.name for one in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not BLENDER & {name.split(".")[0] for name in names}, path


def test_no_file_loads_a_slow_part_of_scipy_before_it_is_used():
    for path in sources():
        for node in parsed(path).body:
            if isinstance(node, ast.ImportFrom) and not node.level:
                names = {node.module, *(f"{node.module}.{one.name}" for one in node.names)}
            else:
                names = {one.name for one in node.names} if isinstance(node, ast.Import) else set()
            assert not names & SLOW_TO_LOAD, f"{path}:{node.lineno}: import scipy, and name {names} where it is used"


def test_no_function_is_longer_than_60_lines():
    long = [
        (path.name, node.name)
        for path in sources()
        for node in statements(path)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and node.end_lineno - node.lineno >= LONGEST
    ]
    assert long == []
