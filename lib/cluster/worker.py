# SPDX-License-Identifier: GPL-3.0-or-later
"""A worker of a cluster.

It keeps files that calls need, and notices that nobody waits for a call any more.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from ..errors import EtalonError
from ..version import VERSION

_DESCRIBE = "import bpy; print(); print(bpy.app.version_string, bpy.app.build_hash.decode(errors='replace'))"


@dataclass(frozen=True)
class Lacks:
    """What a call returns that cannot run yet.

    Its `worker` needs the files of these `digests`.
    """

    worker: str
    digests: tuple[str, ...]


def digest_of(content: bytes) -> str:
    """The SHA-256 of a content, by which files are known."""
    return hashlib.sha256(content).hexdigest()


def describe_blender() -> str:
    """Release and build of the Blender that a worker's comparisons run in.

    '' where it has none.
    """
    done = subprocess.run([sys.executable, "-c", _DESCRIBE], capture_output=True, text=True, check=False)
    return done.stdout.strip().splitlines()[-1] if done.returncode == 0 else ""


def worker_name() -> str:
    """The address of the worker that runs this call."""
    from distributed import get_worker

    return get_worker().address


def require_version(version: str) -> None:
    """Raise EtalonError where this worker has another version of Étalon."""
    if version != VERSION:
        raise EtalonError(f"worker {worker_name()} has Étalon {VERSION}; install Étalon {version} there, as here")


def folder() -> Path:
    """The folder of the worker that runs this call; it goes when the worker ends."""
    from distributed import get_worker

    return Path(get_worker().local_directory)


def keep(digest: str, content: bytes, dask_worker: Any) -> None:
    """Keep a file by its content; the name appears when it is whole.

    Dask fills in `dask_worker`.
    """
    place = Path(dask_worker.local_directory) / digest
    with tempfile.NamedTemporaryFile(dir=place.parent, delete=False) as file:
        file.write(content)
    os.replace(file.name, place)


def find_content(digest: str, path: str | None = None) -> Path | None:
    """A file with that content; None where there is none.

    It is the one at `path`, where machines share files, or the one that was sent.
    """
    if path is not None:
        with suppress(OSError):
            status = os.stat(path)
            if _digest_at(path, status.st_mtime_ns, status.st_size) == digest:
                return Path(path)
    place = folder() / digest
    return place if place.is_file() else None


@lru_cache(maxsize=4096)
def _digest_at(path: str, time: int, size: int) -> str:
    """The SHA-256 of a file, read again only where its time or size changed."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def find_files(files: Mapping[str, str]) -> dict[str, Path] | Lacks:
    """Where this worker has the `files`, paths with their digests.

    They are at those paths, or copies that lie to each other as these do.
    """
    found = {path: find_content(digest, path) for path, digest in files.items()}
    if missing := [files[path] for path, place in found.items() if place is None]:
        return Lacks(worker_name(), tuple(dict.fromkeys(missing)))
    places = {path: place for path, place in found.items() if place is not None}
    if all(place == Path(path) for path, place in places.items()):
        return places
    root = os.path.commonpath([os.path.dirname(path) for path in files])
    tree = folder() / f"files-{digest_of(repr(sorted(files.items())).encode())[:16]}"
    copies = {path: tree / os.path.relpath(path, root) for path in files}
    for path, copy in copies.items():
        if not copy.is_file():
            copy.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.NamedTemporaryFile(dir=copy.parent, delete=False) as beside:
                pass
            shutil.copyfile(places[path], beside.name)
            os.replace(beside.name, copy)
    return copies


def watch_task() -> Callable[[], bool]:
    """A function that returns whether nobody waits any more for the call that runs.

    The call was then cancelled, or its client is gone.
    """
    from distributed import get_worker

    worker = get_worker()
    key = worker.get_current_task()

    def is_ending() -> bool:
        task = worker.state.tasks.get(key)
        return task is None or task.state not in ("executing", "long-running")

    return is_ending
