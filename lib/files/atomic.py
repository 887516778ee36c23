# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that appear whole or not at all: written beside their place, then renamed."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import EtalonError

UNFINISHED = ".unfinished-"
"""Folders whose name begins so hold files that are still being written."""


@contextmanager
def replace_files(folder: Path) -> Iterator[Path]:
    """Yield an empty folder; its files move into `folder`, over older ones, when the block ends well.

    Entering it proves that `folder` can be written, before any time is spent. Other files in `folder` stay.
    Raises EtalonError where it cannot be written or the disk is full; then `folder` is as it was.
    """
    try:
        if folder.exists() and not folder.is_dir():
            raise EtalonError(f"{folder} is a file, not a folder; name another folder")
        missing = [parent for parent in (folder, *folder.parents) if not parent.exists()]
        folder.mkdir(parents=True, exist_ok=True)
        beside = Path(tempfile.mkdtemp(prefix=UNFINISHED, dir=folder))
    except OSError as error:
        raise EtalonError(f"{folder} cannot be written ({error.strerror}); name another folder") from error
    finished = False
    try:
        yield beside
        for path in sorted(beside.iterdir()):
            os.replace(path, folder / path.name)
        finished = True
    except OSError as error:
        where = f"{error.filename or folder} cannot be written ({error.strerror})"
        raise EtalonError(f"{where}; make room or name another folder") from error
    finally:
        shutil.rmtree(beside, ignore_errors=True)
        if not finished:
            for parent in missing:
                if parent.is_dir() and not any(parent.iterdir()):
                    parent.rmdir()


@contextmanager
def replace_file(path: Path) -> Iterator[Path]:
    """Yield a path whose file becomes `path` when the block ends well, as `replace_files` does for a folder."""
    if path.is_dir():
        raise EtalonError(f"{path} is a folder; name a file")
    with replace_files(path.parent) as folder:
        yield folder / path.name
