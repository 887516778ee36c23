# SPDX-License-Identifier: GPL-3.0-or-later
"""Files locked by a process, and folders that belong to one.

When the process is gone, however it ended, the lock is too.
"""

from __future__ import annotations

import errno
import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

OWNER = "owner"
"""The file in a folder that its process holds locked."""
TEMPORARY = "etalon-"
"""How the names of temporary folders begin."""

_NO_LINK = getattr(os, "O_NOFOLLOW", 0)
_HELD = {errno.EAGAIN, errno.EWOULDBLOCK, errno.EACCES, errno.EDEADLK}

if sys.platform == "win32":
    import msvcrt

    def _lock(descriptor: int) -> None:
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _lock(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)


def lock(path: Path, create: bool = True) -> int | None:
    """Lock the file `path`; return the descriptor that holds the lock, or None.

    It holds the lock until it is closed. None where the file is locked already. Raises OSError where the file cannot be
    opened, or its file system has no locks.
    """
    while True:
        descriptor = os.open(path, os.O_RDWR | _NO_LINK | (os.O_CREAT if create else 0), 0o600)
        try:
            _lock(descriptor)
        except OSError as error:
            os.close(descriptor)
            if error.errno in _HELD:
                return None
            raise
        # The process that held it may have removed the file in between.
        if _is_open_file(path, descriptor):
            return descriptor
        os.close(descriptor)


def _is_open_file(path: Path, descriptor: int) -> bool:
    try:
        return os.path.samestat(os.stat(path), os.fstat(descriptor))
    except FileNotFoundError:
        return False


@contextmanager
def owned_folder(parent: Path, prefix: str) -> Iterator[Path]:
    """Make a folder in `parent` that belongs to this process, and remove it at the end.

    It holds the file OWNER. Where the file system has no locks, the folder is one that nobody removes but this process.
    Raises OSError.
    """
    folder, descriptor = _make(parent, prefix)
    try:
        yield folder
    finally:
        _remove(folder, descriptor)


def _make(parent: Path, prefix: str) -> tuple[Path, int | None]:
    while True:
        folder = Path(tempfile.mkdtemp(prefix=prefix, dir=parent))
        try:
            return folder, lock(folder / OWNER)
        except FileNotFoundError:  # another process took it for an empty one that was left
            continue
        except OSError as error:
            if error.errno not in {errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP, errno.EINVAL}:
                shutil.rmtree(folder, ignore_errors=True)
                raise
            (folder / OWNER).unlink(missing_ok=True)
            return folder, None


def _remove(folder: Path, descriptor: int | None) -> None:
    """Remove an owned folder, its lock last.

    If the process is ended meanwhile, the folder that is left can be swept.
    """
    with suppress(OSError):
        for entry in folder.iterdir():
            if entry.name == OWNER:
                continue
            if entry.is_dir() and not entry.is_symlink():
                shutil.rmtree(entry, ignore_errors=True)
            else:
                entry.unlink(missing_ok=True)
    if descriptor is not None:
        os.close(descriptor)  # Windows removes no open file
    with suppress(OSError):
        (folder / OWNER).unlink(missing_ok=True)
        folder.rmdir()


def sweep(parent: Path, prefix: str) -> Iterator[Path]:
    """Yield each folder of `parent` whose owner has ended, before it is removed.

    Folders of other users, of running processes, and those that no process ever owned stay.
    """
    for folder in sorted(parent.glob(f"{prefix}*")):
        descriptor = None
        try:
            status = folder.lstat()
            if not folder.is_dir() or folder.is_symlink() or (hasattr(os, "getuid") and status.st_uid != os.getuid()):
                continue
            descriptor = lock(folder / OWNER, create=False)
        except FileNotFoundError:
            with suppress(OSError):
                folder.rmdir()  # only where it is empty
        except OSError:
            continue
        if descriptor is not None:
            try:
                yield folder
            finally:
                _remove(folder, descriptor)


@cache
def _sweep_temporary(parent: Path) -> None:
    for _ in sweep(parent, TEMPORARY):
        pass


@contextmanager
def temporary_folder() -> Iterator[Path]:
    """Make a temporary folder and remove it at the end.

    The first one of a process sweeps those that ended processes left.
    """
    parent = Path(tempfile.gettempdir())
    _sweep_temporary(parent)
    with owned_folder(parent, TEMPORARY) as folder:
        yield folder
