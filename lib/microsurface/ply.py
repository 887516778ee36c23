# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes as PLY files, for Blender and other programs."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..files.atomic import replace_file
from ..scene.mesh import Mesh

_HEADER = """ply
format binary_little_endian 1.0
comment {comment}
element vertex {vertices}
property float x
property float y
property float z
element face {faces}
property list uchar int vertex_indices
end_header
"""


def write_ply(path: Path, mesh: Mesh, comment: str) -> None:
    """Write vertices, in float32, and triangles of `mesh` to `path`, whole or not at all.

    `comment` is one line in the file's head. Raises EtalonError where the file cannot be written.
    """
    faces = np.empty(mesh.triangles.shape[1], [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, mesh.triangles.T
    header = _HEADER.format(comment=comment, vertices=mesh.vertices.shape[1], faces=len(faces))
    with replace_file(path) as beside:
        beside.write_bytes(header.encode("ascii") + mesh.vertices.T.astype("<f4").tobytes() + faces.tobytes())
