# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes of a mesh that materials read: colours, vectors and values of points, corners or faces."""

from __future__ import annotations

import bpy
import numpy as np

from ...lib.errors import Refusal, Refused

# Data type -> the property that holds it, its width, its dtype.
_STORED = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "BOOLEAN": ("value", 1, np.bool_),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
}


def read_attribute(
    mesh: bpy.types.Mesh, name: str, corners: np.ndarray, triangles: np.ndarray, polygon: np.ndarray
) -> np.ndarray:
    """(3, 6, t) red, green, blue, alpha, factor and presence (0 or 1) at the triangles' corners; alpha alone 1 where there is nothing.

    '' is the active render colour. `corners` (t, 3) are the triangles' loops, `triangles` (3, t) their vertices, `polygon` (t,) their faces.
    Raises Refused for a type or domain that is not read.
    """
    attribute = mesh.attributes.get(name) if name else _render_color(mesh)
    values = np.zeros((3, 6, corners.shape[0]), np.float32)
    values[:, 3] = 1.0
    if attribute is None:
        return values
    if attribute.data_type not in _STORED or attribute.domain not in ("POINT", "CORNER", "FACE"):
        kind = attribute.data_type.replace("_", " ").lower()
        what = f"attribute '{attribute.name}' of type {kind} on domain {attribute.domain.lower()}"
        remedy = "convert it to a float, vector or colour of points, corners or faces"
        raise Refused([Refusal(f"mesh '{mesh.name}'", what, remedy)])
    field, width, dtype = _STORED[attribute.data_type]
    stored = np.empty(len(attribute.data) * width, dtype)
    attribute.data.foreach_get(field, stored)
    stored = stored.reshape(-1, width).astype(np.float32)
    index = {"POINT": triangles.T, "CORNER": corners, "FACE": np.repeat(polygon[:, None], 3, axis=1)}
    picked = stored[index[attribute.domain]].transpose(1, 2, 0)  # (3 corners, width, t)
    values[:, 5] = 1.0
    if width == 1:
        values[:, :3] = picked
    else:
        values[:, : min(width, 4)] = picked
    # Cycles takes the first number of a pair for its value, and the mean of three.
    values[:, 4] = picked[:, 0] if width <= 2 else values[:, :3].mean(axis=1)
    return values


def _render_color(mesh: bpy.types.Mesh) -> bpy.types.Attribute | None:
    colors = mesh.color_attributes
    index = colors.render_color_index
    return colors[index] if 0 <= index < len(colors) else None
