# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes of a mesh that materials read, as Cycles reads them.

They are colours, vectors and values of points, edges, corners or faces. Measured in Blender 4.5, 5.2 and 5.3 for
every type on every domain.
"""

from __future__ import annotations

from collections.abc import Callable

import bpy
import numpy as np

from ...lib.blender_versions import Versions
from ...lib.scene.pointiness import POINTINESS, pointiness

# Data type -> the property that holds it, its width, its dtype.
_STORED = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int32),
    "BOOLEAN": ("value", 1, np.bool_),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT4": ("vector", 4, np.float32),
    "QUATERNION": ("value", 4, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
}
_DOMAINS = ("POINT", "EDGE", "FACE", "CORNER")
# Edges are averaged at their points: of quaternions and of bytes there is no plain average.
_NO_AVERAGE = ("QUATERNION", "BYTE_COLOR")
# Of an edge between vertices at one place Cycles takes the direction for 0; in 4.5 for NaN, and 5.0 and 5.1 are not measured.
_EDGES_MAY_HAVE_NO_LENGTH = Versions("5.2")
_TANGENTS = (".tangent", ".tangent_sign", ".undisplaced_tangent", ".undisplaced_tangent_sign")


def unreadable(mesh: bpy.types.Mesh, name: str) -> tuple[str, str] | None:
    """(what, remedy) where the attribute `name` cannot be read; None where it can.

    '' is the active render colour.
    """
    if name == POINTINESS:
        return None
    attribute = _find(mesh, name)
    if attribute is None:
        # Cycles makes tangents itself where a material asks for them by name.
        own = name.endswith(_TANGENTS) and name.rsplit(".", 1)[0] in mesh.uv_layers
        return (f"attribute '{name}', which Cycles makes itself", "use a Tangent node") if own else None
    kind, domain = attribute.data_type, attribute.domain
    if kind in _STORED and domain in _DOMAINS and not (domain == "EDGE" and kind in _NO_AVERAGE):
        return None
    what = f"attribute '{attribute.name}' of type {kind.replace('_', ' ').lower()} on domain {domain.lower()}"
    return what, "convert it to a float, vector or colour of points, corners or faces"


def read_attribute(
    mesh: bpy.types.Mesh, name: str, corners: np.ndarray, triangles: np.ndarray, polygon: np.ndarray
) -> np.ndarray:
    """(3, 6, t) red, green, blue, alpha, factor and presence (0 or 1) at the corners.

    Where there is no attribute, alpha is 1 and the rest 0. '' is the active render colour, and 'pointiness' is computed,
    whatever the mesh has under that name. `corners` (t, 3) are the
    triangles' loops, `triangles` (3, t) their vertices, `polygon` (t,) their faces. An `unreadable` attribute counts as
    absent: the export has refused the materials of this mesh that read it.
    """
    values = np.zeros((3, 6, corners.shape[0]), np.float32)
    values[:, 3] = 1.0
    if name == POINTINESS:
        values[:, 4] = _pointiness(mesh)[triangles]
        return values
    attribute = _find(mesh, name)
    if attribute is None or unreadable(mesh, name):
        return values
    field, width, dtype = _STORED[attribute.data_type]
    stored = np.empty(len(attribute.data) * width, dtype)
    attribute.data.foreach_get(field, stored)
    stored = stored.reshape(-1, width)
    domain = attribute.domain
    if domain == "EDGE":
        stored, domain = _at_points(mesh, stored), "POINT"
    index = {"POINT": triangles.T, "CORNER": corners, "FACE": np.repeat(polygon[:, None], 3, axis=1)}
    picked = stored.astype(np.float32)[index[domain]].transpose(1, 2, 0)  # (3 corners, width, t)
    values[:, 5] = 1.0
    if width == 1:
        values[:, :3] = picked
    else:
        values[:, : min(width, 4)] = picked
    # Cycles takes the first number of a pair for its value, and the mean of three.
    values[:, 4] = picked[:, 0] if width <= 2 else values[:, :3].mean(axis=1)
    return values


def _pointiness(mesh: bpy.types.Mesh) -> np.ndarray:
    """(v,) the pointiness of the mesh's vertices."""
    positions, normals = (np.empty((len(mesh.vertices), 3), np.float32) for _ in range(2))
    mesh.vertices.foreach_get("co", positions.ravel())
    mesh.vertex_normals.foreach_get("vector", normals.ravel())
    lengthless = 0.0 if bpy.app.version in _EDGES_MAY_HAVE_NO_LENGTH else np.nan
    return pointiness(positions.T, normals.T, _edges(mesh).T, lengthless)


def _edges(mesh: bpy.types.Mesh) -> np.ndarray:
    """(e, 2) the two vertices of each edge."""
    ends = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", ends)
    return ends.reshape(-1, 2)


def _at_points(mesh: bpy.types.Mesh, stored: np.ndarray) -> np.ndarray:
    """(v, width) the mean at each point of its edges' values (e, width).

    Means of whole numbers are rounded. A boolean is true where that of any edge is.
    """
    ends = _edges(mesh).ravel()
    total = np.zeros((len(mesh.vertices), stored.shape[1]))
    np.add.at(total, ends, np.repeat(stored.astype(np.float64), 2, axis=0))
    mean = total / np.maximum(np.bincount(ends, minlength=len(mesh.vertices)), 1)[:, None]
    return _ROUNDED.get(stored.dtype.type, np.asarray)(mean)


def _round_half_away(mean: np.ndarray) -> np.ndarray:
    return np.copysign(np.floor(np.abs(mean) + 0.5), mean)


_ROUNDED: dict[type, Callable[[np.ndarray], np.ndarray]] = {
    np.int32: _round_half_away,
    np.bool_: lambda mean: mean > 0.0,
}


def _find(mesh: bpy.types.Mesh, name: str) -> bpy.types.Attribute | None:
    if name:
        return mesh.attributes.get(name)
    colors = mesh.color_attributes
    index = colors.render_color_index
    return colors[index] if 0 <= index < len(colors) else None
