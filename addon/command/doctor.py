# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon doctor`: Blender, libraries, processors and memory, and what is missing."""

from __future__ import annotations

import importlib
import importlib.metadata
import importlib.util
import platform
import re
import subprocess
import sys
from typing import Any

from ...lib.blender_versions import NEWEST_CHECKED, OLDEST, describe_unchecked, format_release
from ...lib.errors import EtalonError
from ...lib.exit_codes import ExitCode
from ...lib.memory import usable_memory
from ...lib.pages.formats import format_gigabytes
from ...lib.plural import plural
from ...lib.settings.common import Terminal, count_processors
from ...lib.version import VERSION
from ..host.blender import load_blender
from ..host.quiet import quiet
from .console import ended_by_interrupt, paint, print_json

# The module of each package that pyproject.toml asks for, as it is imported.
PACKAGES = {
    "numpy": "numpy",
    "scipy": "scipy",
    "embreex": "embreex.rtcore_scene",
    "openimageio": "OpenImageIO",
    "matplotlib": "matplotlib",
    "jinja2": "jinja2",
    "flip-evaluator": "flip_evaluator",
    "tqdm": "tqdm",
    "mpmath": "mpmath",
}


def run(terminal: Terminal) -> int:
    """Print what was found and what is missing; the exit code says whether anything is."""
    found = examine()
    if terminal.json:
        print_json(found)
    else:
        print("\n".join(describe(found)))
    return ExitCode.BAD_INPUT if found["missing"] else ExitCode.DONE


def examine() -> dict[str, Any]:
    """What there is of all that Étalon needs; `missing` has a line for each thing to install."""
    missing: list[str] = []
    return {
        "etalon": VERSION,
        "python": platform.python_version(),
        "system": platform.platform(),
        "processors": count_processors(),
        "memory_bytes": usable_memory(),
        "blender": _blender(missing),
        "libraries": {name: _version(name, module, missing) for name, module in PACKAGES.items()},
        "missing": missing,
    }


def _blender(missing: list[str]) -> dict[str, Any]:
    """Version and build of Blender, and whether it was checked.

    What keeps Blender from starting is appended to `missing`.
    """
    try:
        with ended_by_interrupt(), quiet():
            bpy = load_blender()
    except EtalonError as error:
        libraries = missing_system_libraries()
        names = f" (not found: {' '.join(libraries)})" if libraries else ""
        missing.append(f"{error}{names}")
        return {"version": None, "build": None, "checked": None, "system_libraries_missing": libraries}
    release = bpy.app.version[:2]
    if release < OLDEST:
        missing.append(f"Blender {bpy.app.version_string} is too old; install {format_release(OLDEST)} or newer")
    return {
        "version": bpy.app.version_string,
        "build": f"{bpy.app.build_hash.decode()}, {bpy.app.build_date.decode()}",
        "checked": OLDEST <= release <= NEWEST_CHECKED,
        "note": describe_unchecked(release),
        "system_libraries_missing": [],
    }


def missing_system_libraries() -> list[str]:
    """The shared libraries that the bpy module needs and that the system lacks.

    Found on Linux only; empty elsewhere.
    """
    found = importlib.util.find_spec("bpy") if sys.platform == "linux" else None
    if found is None or found.origin is None:
        return []
    try:
        listed = subprocess.run(["ldd", found.origin], capture_output=True, text=True, timeout=60, check=False).stdout
    except OSError:
        return []
    return parse_missing(listed)


def parse_missing(listed: str) -> list[str]:
    r"""The libraries that the output of ldd calls not found.

    >>> parse_missing("libXi.so.6 => not found\nlibc.so.6 => /lib/libc.so.6 (0x7f)")
    ['libXi.so.6']
    """
    return re.findall(r"^\s*(\S+) => not found", listed, re.MULTILINE)


def _version(name: str, module: str, missing: list[str]) -> str | None:
    """The version of a library that can be imported.

    Otherwise None, and a line is appended to `missing`.
    """
    try:
        loaded = importlib.import_module(module)
    except ImportError as error:
        missing.append(f"{name} cannot be imported ({error}); run: pip install {name}")
        return None
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:  # inside Blender some modules come without a record
        return str(getattr(loaded, "__version__", "of unknown version"))


def describe(found: dict[str, Any]) -> list[str]:
    """The lines for a terminal."""
    blender, memory = found["blender"], found["memory_bytes"]
    checked = "checked with this Étalon" if blender["checked"] else "not checked with this Étalon"
    build = f"{blender['version']} (build {blender['build']}), {checked}" if blender["version"] else "does not start"
    rows = {
        "Étalon": found["etalon"],
        "Blender": build,
        "Python": found["python"],
        "system": found["system"],
        "processors": plural(found["processors"], "thread"),
        "memory": "not known" if memory is None else format_gigabytes(memory),
        **{name: version or "missing" for name, version in found["libraries"].items()},
    }
    width = max(map(len, rows))
    lines = [f"{name:{width}}  {text}" for name, text in rows.items()]
    if blender.get("note"):
        lines += ["", blender["note"]]
    if not found["missing"]:
        return [*lines, "", paint("Nothing is missing.", "EQUIVALENT")]
    return [*lines, "", *(paint(f"missing: {line}", "DIFFERENT") for line in found["missing"])]
