# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines that docs/architecture.md draws: who may import whom, and how long a function may be."""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
ROOMS = ("addon", "lib", "reference_scenes")
BLENDER = {"bpy", "mathutils", "bpy_extras"}
LONGEST = 60
# Tables of the atlas, one row a line.
TABLES = {"closed_forms", "inversions"}


def modules():
    """Dotted name -> (file, whether it is a package)."""
    found = {}
    for path in (path for room in ROOMS for path in (ROOT / room).rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        is_package = parts[-1] == "__init__"
        found[".".join(parts[:-1] if is_package else parts)] = path, is_package
    return found


def at_import(tree):
    """The statements that run when a file is imported, without those that only a type checker reads."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            continue
        yield node
        yield from at_import(node)


def imports(name, known):
    """The files of the tree that the file `name` imports when it is imported itself."""
    path, is_package = known[name]
    found = set()
    for node in at_import(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = name.split(".") if is_package else name.split(".")[:-1]
            base = base[: len(base) - (node.level - 1)] + (node.module or "").split(".")
            target = ".".join(filter(None, base))
            found |= {f"{target}.{one.name}" if f"{target}.{one.name}" in known else target for one in node.names}
    return {one for one in found if one in known and one != name}


def circle(graph):
    """A circle of a graph, or None."""
    try:
        tuple(TopologicalSorter(graph).static_order())
    except CycleError as error:
        return error.args[1]
    return None


def test_no_files_import_each_other_in_a_circle():
    known = modules()
    assert circle({name: imports(name, known) for name in known}) is None


def test_a_circle_is_seen():
    assert circle({"a": {"b"}, "b": {"c"}, "c": {"a"}})


def test_lib_imports_no_blender():
    for path in (ROOT / "lib").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [one.name for one in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not BLENDER & {name.split(".")[0] for name in names}, path


@pytest.mark.parametrize("room", ROOMS)
def test_functions_fit_on_a_page(room):
    long = [
        (path.name, node.name)
        for path in (ROOT / room).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        and node.end_lineno - node.lineno >= LONGEST
        and node.name not in TABLES
    ]
    assert long == []
