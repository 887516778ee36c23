# SPDX-License-Identifier: GPL-3.0-or-later
"""The Blenders that `--blender` names.

They are programs, Pythons that have Blender as a module, and releases by their number.
"""

from __future__ import annotations

import importlib.metadata
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ..batch.process import end, find_blender, start
from ..blender_versions import OLDEST, Release, format_release
from ..errors import EtalonError
from .environments import install_packages, python_of_release

# A Blender that does not answer in so many seconds is given up.
PATIENCE = 120.0
_RELEASE = re.compile(r"\d+\.\d+(\.\d+)?")
_SAYS_VERSION = re.compile(r"^(Blender|Python) (\d+(?:\.\d+)+)", re.MULTILINE)

Tell = Callable[[str], None]


@dataclass(frozen=True)
class Blender:
    """One Blender.

    It has what the user `asked` for, the words that start it with a script, its version and build. `label` is its
    name in tables. `packages` is a folder with Python modules that it lacks, or None.
    """

    asked: str
    command: tuple[str, ...]
    version: tuple[int, ...]
    build: str
    label: str
    packages: str | None = None

    @property
    def release(self) -> Release:
        """Its major and minor version."""
        return self.version[0], self.version[1]

    def request(self, what: dict[str, Any]) -> list[str]:
        """The command line that has its script do `what`."""
        return [*self.command, json.dumps(what | {"packages": self.packages})]


def find_blenders(asked: Sequence[str], script: Path, modules: dict[str, str], tell: Tell) -> tuple[Blender, ...]:
    """The Blenders that the texts `asked` name, each ready to run `script`.

    Raises EtalonError for one that cannot serve. A text is the path of a program, or a release such as 4.5 or 4.5.3:
    the Blender that runs, a program that is installed, or a module in an environment of its own, which is made where
    it is missing. `modules` are those that Étalon needs, by the package that has them. `tell` receives what is being
    made.
    """
    found = [_find(text, script, modules, tell) for text in asked]
    labels = [one.label for one in found]
    named = [one if labels.count(one.label) == 1 else _with_place(one) for one in found]
    labels = [one.label for one in named]
    for label in labels:
        if labels.count(label) > 1:
            raise EtalonError(f"--blender names {label} twice; remove one")
    return tuple(named)


def _with_place(blender: Blender) -> Blender:
    """The same, told from another one of its version by what the user calls it."""
    return replace(blender, label=f"{blender.label} ({blender.asked})")


def _find(asked: str, script: Path, modules: dict[str, str], tell: Tell) -> Blender:
    """The Blender that one text names."""
    if not _RELEASE.fullmatch(asked):
        return _probe(asked, _program(asked), script, modules, tell)
    release = tuple(map(int, asked.split(".")))
    if release[:2] < OLDEST:
        raise EtalonError(f"--blender {asked}: is too old; Étalon needs Blender {format_release(OLDEST)} or newer")
    program = next((one for one in _installed() if _is_release(one, release)), None)
    if program is None:
        program = sys.executable if _has_module(release) else python_of_release(asked, tell)
    return _probe(asked, program, script, modules, tell)


def _has_module(release: tuple[int, ...]) -> bool:
    """Whether this Python has the module of that release."""
    try:
        version = importlib.metadata.version("bpy")
    except importlib.metadata.PackageNotFoundError:
        return False
    return tuple(map(int, re.findall(r"\d+", version)))[: len(release)] == release


def _installed() -> list[str]:
    """Candidates for Blender programs.

    They are the Blender that this process is, and programs on the search path and where installers put them.
    """
    folders = {
        "darwin": (Path("/Applications"), "Blender*.app/Contents/MacOS/Blender"),
        "win32": (Path(os.environ.get("PROGRAMFILES", "C:/Program Files")), "Blender Foundation/Blender */blender.exe"),
    }
    place, pattern = folders.get(sys.platform, (Path("/opt"), "blender*/blender"))
    return [*filter(None, (find_blender(), shutil.which("blender"))), *map(str, sorted(place.glob(pattern)))]


def _program(asked: str) -> str:
    """The program that a path or a name on the search path leads to.

    Raises EtalonError where it cannot be run.
    """
    path = Path(asked).expanduser()
    if path.is_dir():
        inside = [path / name for name in ("blender", "Contents/MacOS/Blender", "blender.exe", "bin/python")]
        path = next((one for one in inside if one.is_file()), path)
    found = str(path.absolute()) if path.is_file() else shutil.which(asked)
    if found is None:
        raise EtalonError(f"--blender {asked}: no such program; give a path, or a release such as 5.2")
    if not os.access(found, os.X_OK):
        raise EtalonError(f"--blender {asked}: is not a program that can be run; give that of Blender itself")
    return found


def _says_version(program: str) -> re.Match[str] | None:
    """What a program prints about itself, None where it is neither Blender nor Python."""
    try:
        done = subprocess.run([program, "--version"], capture_output=True, text=True, timeout=PATIENCE, check=False)
    except (OSError, subprocess.TimeoutExpired, UnicodeDecodeError):
        return None
    return _SAYS_VERSION.search(f"{done.stdout}\n{done.stderr}")


def _is_release(program: str, release: tuple[int, ...]) -> bool:
    """Whether a program is Blender of the version that `release` begins."""
    said = _says_version(program)
    return said is not None and said[1] == "Blender" and tuple(map(int, said[2].split(".")))[: len(release)] == release


def _words(program: str, script: Path, said: re.Match[str] | None) -> tuple[str, ...] | None:
    """The words that have a program run `script`, None where it is neither Blender nor Python."""
    if said is None:
        return None
    if said[1] == "Python":
        return program, str(script), "--"
    # Factory settings: no add-on and no script of the user's runs, and none that is in a file.
    return program, "--background", "--factory-startup", "--disable-autoexec", "--python", str(script), "--"


def _probe(asked: str, program: str, script: Path, modules: dict[str, str], tell: Tell) -> Blender:
    """The Blender that `program` is, with the packages that it lacks.

    Raises EtalonError where it is no Blender, or too old.
    """
    command = _words(program, script, _says_version(program))
    if command is None:
        raise EtalonError(f"--blender {asked}: is neither Blender nor a Python with the module bpy")
    tell(f"asking {asked} for its version")
    answer = _answer(command, {"probe": list(modules.values())})
    if isinstance(answer, str):
        raise EtalonError(f"--blender {asked}: does not start ({answer}); run it by hand to see why")
    if tuple(answer["version"][:2]) < OLDEST:
        oldest = format_release(OLDEST)
        raise EtalonError(
            f"--blender {asked}: is Blender {answer['shown']}, which is too old; Étalon needs {oldest} or newer"
        )
    packages = None
    if answer["missing"]:
        packages = install_packages(asked, answer["python"], tell)
        answer = _answer(command, {"probe": list(modules.values()), "packages": packages})
        if isinstance(answer, str) or answer["missing"]:
            missing = answer if isinstance(answer, str) else ", ".join(answer["missing"])
            raise EtalonError(f"--blender {asked}: cannot load what Étalon needs ({missing}); install Étalon there")
    return _blender(asked, command, answer, packages)


def _blender(asked: str, command: tuple[str, ...], answer: dict[str, Any], packages: str | None) -> Blender:
    return Blender(
        asked, command, tuple(answer["version"]), answer["build"], answer["shown"].removesuffix(" LTS"), packages
    )


def _answer(command: Sequence[str], request: dict[str, Any]) -> dict[str, Any] | str:
    """What the script answers, or the last words of a process that did not."""
    process = start(
        [*command, json.dumps(request)],
        encoding="utf-8",
        errors="replace",
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    try:
        out, err = process.communicate(timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return f"no answer in {PATIENCE:.0f} s"
    finally:
        end(process)
    for line in out.splitlines():
        if line.startswith("etalon: {"):
            return json.loads(line.removeprefix("etalon: "))
    lines = [line.strip() for line in f"{out}\n{err}".splitlines() if line.strip()]
    return lines[-1] if lines else f"it ended with code {process.returncode}"
