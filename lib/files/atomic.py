# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that appear together and whole, or not at all.

They are written beside their place, checked, then renamed.
"""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from ..errors import EtalonError
from .ownership import owned_folder, sweep

UNFINISHED = ".unfinished-"
"""Folders whose name begins so hold files that are still being written."""

# What such a folder holds: the new files, those that they replace, and when all new ones are on the disk, a note of what is to be done.
_NEW, _OLD, _COMPLETE = "new", "old", "complete"


@contextmanager
def replace_files(folder: Path, without: Sequence[str] = ()) -> Iterator[Path]:
    """Yield an empty folder whose files replace those of their names in `folder`.

    They do when the block ends well, all or none. The files `without`, which belonged to the results before, go away
    with them where they are not new; other files in `folder` stay. Old and new files never lie in `folder` together.
    If the process ends while they move, the next call for `folder` finishes that.

    Entering it proves that `folder` can be written, before any time is spent, and removes what processes that were
    ended left there. Raises EtalonError where it cannot be written or the disk is full; then `folder` is as it was.
    A `folder` that is itself one that was yielded is not written to the disk before the one that it is for.
    """
    missing = _make_folder(folder)
    finished = False
    try:
        with owned_folder(folder, UNFINISHED) as beside:
            new = beside / _NEW
            new.mkdir()
            with _known_places(folder, new):
                yield new
            names = sorted(set(without) - {path.name for path in new.iterdir()})
            if not _is_unfinished(folder):
                _flush(new)
                _note(beside, names)
            _swap(folder, beside, names)
            if not _is_unfinished(folder):
                _flush_folder(folder)
            finished = True
    except OSError as error:
        place = _place(folder, str(error.filename or folder))
        raise EtalonError(f"{place} cannot be written ({error.strerror}); make room or name another folder") from error
    finally:
        if not finished:
            for parent in missing:
                if parent.is_dir() and not any(parent.iterdir()):
                    parent.rmdir()


def _is_unfinished(folder: Path) -> bool:
    """Whether what is in `folder` goes with a folder around it if the process ends now."""
    return any(part.startswith(UNFINISHED) for part in folder.parts)


@contextmanager
def replace_file(path: Path) -> Iterator[Path]:
    """Yield a path whose file becomes `path` when the block ends well.

    It does as `replace_files` does for a folder.
    """
    if path.is_dir():
        raise EtalonError(f"{path} is a folder; name a file")
    with replace_files(path.parent) as folder:
        yield folder / path.name


def _make_folder(folder: Path) -> list[Path]:
    """Make `folder` and finish what was left in it.

    Returns those of its parents, and itself, that did not exist.
    """
    try:
        if folder.exists() and not folder.is_dir():
            raise EtalonError(f"{folder} is a file, not a folder; name another folder")
        missing = [parent for parent in (folder, *folder.parents) if not parent.exists()]
        folder.mkdir(parents=True, exist_ok=True)
        _finish(folder)
    except OSError as error:
        raise EtalonError(f"{folder} cannot be written ({_reason(error)}); name another folder") from error
    return missing


def clear_unfinished(folder: Path) -> None:
    """Finish or remove what a process that was ended left in `folder`.

    The folder goes too where nothing else is in it.
    """
    if folder.is_dir():
        with suppress(OSError):
            _finish(folder)
            folder.rmdir()


def _finish(folder: Path) -> None:
    for left in sweep(folder, UNFINISHED):
        if (left / _COMPLETE).is_file():
            with suppress(OSError):
                _swap(folder, left, json.loads((left / _COMPLETE).read_text(encoding="utf-8")))
                _flush_folder(folder)


@contextmanager
def _known_places(folder: Path, new: Path) -> Iterator[None]:
    """Have errors name files by the place that they were to get."""
    try:
        yield
    except EtalonError as error:
        if type(error) is not EtalonError or str(new) not in str(error):
            raise
        raise EtalonError(str(error).replace(str(new), str(folder))) from error


def _reason(error: OSError) -> str:
    """The error in one line; Blender's own have no number."""
    return error.strerror or " ".join(str(error).split())


def _place(folder: Path, name: str) -> str:
    """The path by which a user knows a file that is written beside its place."""
    inside = UNFINISHED in name
    return str(folder / Path(name).name if Path(name).suffix else folder) if inside else name


def _flush(new: Path) -> None:
    """Write every file of `new` to the disk.

    Raises OSError for one that is empty, as full disks leave them.
    """
    for path in new.iterdir():
        with path.open("rb+") as file:
            os.fsync(file.fileno())
            if not os.fstat(file.fileno()).st_size:
                raise OSError(errno.ENOSPC, "it stayed empty; the disk may be full", str(path))
    _flush_folder(new)


def _flush_folder(folder: Path) -> None:
    if hasattr(os, "O_DIRECTORY"):
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            with suppress(OSError):  # some file systems cannot
                os.fsync(descriptor)
        finally:
            os.close(descriptor)


def _note(beside: Path, stale: Sequence[str]) -> None:
    """Note that all new files are there, and which old ones are to go."""
    written = beside / f"{_COMPLETE}.part"
    with written.open("w", encoding="utf-8") as file:
        json.dump(stale, file)
        file.flush()
        os.fsync(file.fileno())
    os.replace(written, beside / _COMPLETE)
    _flush_folder(beside)


def _swap(folder: Path, beside: Path, stale: Sequence[str]) -> None:
    """Move the old files out of `folder`, then the new ones in.

    Raises OSError, after which `folder` is as it was.
    """
    new, old = beside / _NEW, beside / _OLD
    moved: list[tuple[Path, Path]] = []
    try:
        old.mkdir(exist_ok=True)
        names = sorted(path.name for path in new.iterdir())
        for name in (*names, *stale):
            if (folder / name).is_dir():
                raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(folder / name))
        for name in (*names, *stale):
            if os.path.lexists(folder / name):
                _move(folder / name, old / name, moved)
        for name in names:
            _move(new / name, folder / name, moved)
    except OSError:
        for source, target in reversed(moved):
            with suppress(OSError):
                os.replace(target, source)
        raise


def _move(source: Path, target: Path, moved: list[tuple[Path, Path]]) -> None:
    os.replace(source, target)
    moved.append((source, target))
