# SPDX-License-Identifier: GPL-3.0-or-later
"""The container of RGL's `.bsdf` files: named arrays (Dupuy and Jakob 2018).

Little-endian: the 12 bytes "tensor_file" and zero, two bytes of version (1, 0), the number of fields as uint32. A field is a name
(uint16 length, bytes), the number of dimensions as uint16, a type as uint8, the offset of its data in the file and its shape as uint64.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import EtalonError

MAGIC = b"tensor_file\0"
_VERSION = 1
_TYPES = {
    1: "<u1",
    2: "<i1",
    3: "<u2",
    4: "<i2",
    5: "<u4",
    6: "<i4",
    7: "<u8",
    8: "<i8",
    9: "<f2",
    10: "<f4",
    11: "<f8",
}
_MOST_FIELDS = 1000
_MOST_DIMENSIONS = 16


@dataclass
class _Reader:
    path: Path
    data: bytes
    at: int = 0

    def take(self, form: str) -> tuple[int, ...]:
        """The next numbers, little-endian."""
        return struct.unpack("<" + form, self.take_bytes(struct.calcsize("<" + form)))

    def take_bytes(self, count: int) -> bytes:
        """The next bytes."""
        if self.at + count > len(self.data):
            raise truncated(self.path)
        self.at += count
        return self.data[self.at - count : self.at]


def truncated(path: Path) -> EtalonError:
    """The error about a file that ends too early."""
    return EtalonError(f"{path}: the file ends before its data do; fetch it again")


def read_tensors(path: Path) -> dict[str, np.ndarray]:
    """Read all fields of a tensor file by name; arrays are read-only views.

    Raises EtalonError for a foreign or truncated file, and OSError where it cannot be read.
    """
    reader = _Reader(path, path.read_bytes())
    if reader.data[: len(MAGIC)] != MAGIC:
        raise EtalonError(f"{path} is not a tensor file; give a .bsdf file of the RGL database")
    reader.take_bytes(len(MAGIC))
    version, _, fields = reader.take("BBI")
    if version != _VERSION or fields > _MOST_FIELDS:
        raise EtalonError(f"{path}: unknown version of the tensor format; give a .bsdf file of version {_VERSION}")
    return dict(_read_field(reader) for _ in range(fields))


def _read_field(reader: _Reader) -> tuple[str, np.ndarray]:
    (length,) = reader.take("H")
    name = reader.take_bytes(length).decode("utf-8", "replace")
    dimensions, kind, offset = reader.take("HBQ")
    if kind not in _TYPES or dimensions > _MOST_DIMENSIONS:
        raise EtalonError(f"{reader.path}: field '{name}' has an unknown type; fetch the file again")
    shape = reader.take("Q" * dimensions)
    count, dtype = math.prod(shape), np.dtype(_TYPES[kind])
    if offset + count * dtype.itemsize > len(reader.data):
        raise truncated(reader.path)
    return name, np.frombuffer(reader.data, dtype, count, offset).reshape(shape)
