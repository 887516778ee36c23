# SPDX-License-Identifier: GPL-3.0-or-later
"""Results on disk: written beside their place and renamed, so that nothing is ever half-written."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import EtalonError


@contextmanager
def folder_beside(folder: Path) -> Iterator[Path]:
    """Yield an empty folder beside `folder`; when the block ends well its files move into `folder`, over older ones.

    Entering it proves that `folder` can be written, before any time is spent; what else lies in `folder` stays.
    Raises EtalonError where it cannot be written or the disk is full.
    """
    try:
        if folder.exists() and not folder.is_dir():
            raise EtalonError(f"{folder}: is a file, not a folder; name another with --out")
        missing = [parent for parent in (folder, *folder.parents) if not parent.exists()]
        folder.mkdir(parents=True, exist_ok=True)
        beside = Path(tempfile.mkdtemp(prefix=".unfinished-", dir=folder))
    except OSError as error:
        raise EtalonError(f"{folder}: cannot be written ({error.strerror}); name another folder with --out") from error
    finished = False
    try:
        yield beside
        for path in sorted(beside.iterdir()):
            os.replace(path, folder / path.name)
        finished = True
    except OSError as error:
        raise EtalonError(f"{error.filename or folder}: {error.strerror}; make room or name another --out") from error
    finally:
        shutil.rmtree(beside, ignore_errors=True)
        if not finished:
            for parent in missing:
                if parent.is_dir() and not any(parent.iterdir()):
                    parent.rmdir()


@contextmanager
def file_beside(path: Path) -> Iterator[Path]:
    """Yield a path whose file becomes `path` when the block ends well, as `folder_beside` does for a folder."""
    if path.is_dir():
        raise EtalonError(f"{path}: is a folder; name a file with --out")
    with folder_beside(path.parent) as folder:
        yield folder / path.name
