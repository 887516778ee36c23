# SPDX-License-Identifier: GPL-3.0-or-later
"""Environments for releases of Blender as a Python module.

They are kept in the user's cache folder.
"""

from __future__ import annotations

import importlib.metadata
import os
import re
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from ..blender_versions import Versions, parse_release
from ..errors import EtalonError
from ..files.ownership import lock

# The Python that the releases' modules are made for.
PYTHONS = ((Versions(None, "5.0"), "3.11"), (Versions("5.1"), "3.13"))
# The file that stands in an environment once all of it is installed.
_READY = "ready"

Tell = Callable[[str], None]


def cache_folder() -> Path:
    """Étalon's folder in this user's cache.

    Programs keep there what they can make again.
    """
    home = Path.home()
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", home / "AppData" / "Local")) / "etalon" / "Cache"
    if sys.platform == "darwin":
        return home / "Library" / "Caches" / "etalon"
    return Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache") / "etalon"


def requirements() -> tuple[str, ...]:
    """The packages that Étalon needs besides Blender.

    They come from its installed metadata or the pyproject.toml of a checkout.
    """
    checkout = Path(__file__).resolve().parents[2] / "pyproject.toml"
    if checkout.is_file():
        listed = tomllib.loads(checkout.read_text(encoding="utf-8"))["project"]["dependencies"]
    else:
        try:
            listed = importlib.metadata.requires("etalon") or []
        except importlib.metadata.PackageNotFoundError:
            raise EtalonError(
                "this Étalon cannot install itself elsewhere; give --blender paths of Blenders that have it, or use pip's"
            ) from None
    return tuple(one for one in listed if "extra ==" not in one and not re.match(r"bpy\b", one))


def python_of_release(release: str, tell: Tell) -> str:
    """The Python of an environment that has Blender `release` as a module.

    `release` is as 4.5 or 4.5.3. The environment is made where it is missing. Raises EtalonError where there is no
    Python of the version that the release needs, or no such release to install.
    """
    folder = cache_folder() / f"blender-{release}"
    python = folder / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    wanted = f"bpy=={release}" + (".*" if release.count(".") == 1 else "")
    version = next(python for versions, python in PYTHONS if parse_release(release) in versions)
    with _made(folder, tell) as missing:
        if missing:
            tell(f"installing Blender {release} as a Python module in {folder}")
            _make_environment(folder, version, release)
            _install(["--python", str(python)], [wanted, *requirements()], f"Blender {release}")
    return str(python)


def install_packages(asked: str, python: str, tell: Tell) -> str:
    """A folder with what Étalon needs for a Blender whose `python` (3.11) lacks it.

    Raises EtalonError where it cannot be had.
    """
    folder = cache_folder() / f"packages-{python}"
    with _made(folder, tell) as missing:
        if missing:
            tell(f"installing what Étalon needs for Python {python} in {folder}")
            where = ["--target", str(folder), "--python-version", python]
            _install(where, [*requirements(), f"numpy<{2 if python == '3.11' else 3}"], f"the libraries for {asked}")
    return str(folder)


@contextmanager
def _made(folder: Path, tell: Tell) -> Iterator[bool]:
    """Yield whether a folder of the cache is still to be made.

    Another process that makes it is waited for, and what failed is removed.
    """
    held = _wait_for_lock(folder.with_suffix(folder.suffix + ".lock"), tell)
    try:
        missing = not (folder / _READY).is_file()
        if missing:
            shutil.rmtree(folder, ignore_errors=True)
        yield missing
        if missing:
            folder.mkdir(exist_ok=True)
            (folder / _READY).touch()
    except BaseException:
        if not (folder / _READY).is_file():
            shutil.rmtree(folder, ignore_errors=True)
        raise
    finally:
        os.close(held)


def _wait_for_lock(path: Path, tell: Tell) -> int:
    """The descriptor of the locked file, once no other process holds it."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        held = lock(path)
        while held is None:
            tell(f"waiting for another process that installs {path.stem}")
            time.sleep(1.0)
            held = lock(path)
    except OSError as error:
        raise EtalonError(f"{path.parent}: cannot be written ({error.strerror}); set XDG_CACHE_HOME") from error
    return held


def _make_environment(folder: Path, version: str, release: str) -> None:
    """Make a virtual environment with Python `version`, by uv where that is installed."""
    uv, python = shutil.which("uv"), _find_python(version)
    if uv is None and python is None:
        raise EtalonError(
            f"--blender {release}: needs Python {version}, which is not installed; install it or uv, or give the path of a Blender"
        )
    made = [uv, "venv", "--python", version, str(folder)] if uv else [str(python), "-m", "venv", str(folder)]
    _run(made, f"an environment for Blender {release}")


def _find_python(version: str) -> str | None:
    """A Python program of that version that runs, None where there is none."""
    here = ".".join(map(str, sys.version_info[:2])) == version
    for program in [sys.executable] * here + [shutil.which(f"python{version}") or ""]:
        if program and subprocess.run([program, "-c", ""], capture_output=True, check=False).returncode == 0:
            return program
    return None


def _install(where: Sequence[str], packages: Sequence[str], what: str) -> None:
    """Install wheels of `packages`, by uv where that is installed, else by pip.

    Nothing is built.
    """
    uv = shutil.which("uv")
    pip = [uv, "pip", "install"] if uv else [sys.executable, "-m", "pip", "install", "--disable-pip-version-check"]
    if not uv and where[0] == "--python":
        pip, where = [where[1], "-m", "pip", "install", "--disable-pip-version-check"], []
    _run([*pip, "--quiet", "--only-binary=:all:", *where, *packages], what)


def _run(command: Sequence[str], what: str) -> None:
    """Run a program; raises EtalonError with its last line where it fails."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    except OSError as error:
        raise EtalonError(f"{what} cannot be installed ({error.strerror}); check {command[0]}") from error
    if done.returncode:
        lines = [line.strip() for line in f"{done.stdout}\n{done.stderr}".splitlines() if line.strip()]
        said = next((line for line in reversed(lines) if "rror" in line), lines[-1] if lines else "no message")
        raise EtalonError(f"{what} cannot be installed ({said}); check the network and the version")
