# SPDX-License-Identifier: GPL-3.0-or-later
"""A measured BRDF of any known format, told apart by what the file holds."""

from __future__ import annotations

from pathlib import Path

from ..errors import EtalonError
from .brdf import MeasuredBrdf
from .merl import HEADER, SHAPE, read_merl
from .rgl import read_rgl
from .tensor_file import MAGIC

_SUFFIXES = {".binary": read_merl, ".bsdf": read_rgl}


def is_measured_file(path: Path) -> bool:
    """Whether the name ends like one of a measured BRDF."""
    return path.suffix.lower() in _SUFFIXES


def read_measured(path: Path) -> MeasuredBrdf:
    """Read a MERL or RGL file.

    Raises EtalonError, in one line, for a foreign, truncated or unusable file; OSError where it cannot be read.
    """
    with path.open("rb") as file:
        start = file.read(len(MAGIC))
    if start == MAGIC:
        return read_rgl(path)
    if start == _merl_header():
        return read_merl(path)
    if is_measured_file(path):
        return _SUFFIXES[path.suffix.lower()](path)
    raise EtalonError(f"{path} holds no measured BRDF; give a MERL .binary or an RGL .bsdf file")


def _merl_header() -> bytes:
    """The bytes with which every MERL file begins."""
    return b"".join(size.to_bytes(HEADER.itemsize, "little") for size in SHAPE)
