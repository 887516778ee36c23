# SPDX-License-Identifier: GPL-3.0-or-later
"""One mesh datablock, read once into arrays, in its object's space."""

from __future__ import annotations

from collections.abc import Iterable

import bpy
import numpy as np

from ...lib.errors import SceneError
from ...lib.plural import plural
from ...lib.scene.mesh import FARTHEST, near
from ...lib.scene.placements import LocalMesh
from ...lib.surfaces.displacement import Normals
from .mesh_attributes import read_attribute


def faces_of(thing: bpy.types.Object) -> bpy.types.Mesh:
    """The evaluated mesh of a mesh object.

    A file that was saved in Edit Mode opens in it. The evaluated mesh of what is edited lacks faces or attributes, which Cycles renders.
    """
    return thing.to_mesh() if thing.data.is_editmode else thing.data


def read_mesh(
    mesh: bpy.types.Mesh, name: str, uv_maps: Iterable[str], generated: bool, attributes: Iterable[str] = ()
) -> LocalMesh:
    """Read an evaluated mesh; `name` is the object's, for errors.

    `uv_maps` are the maps wanted ('' is the active render map), `attributes` the others ('' is the active render colour); one that
    the mesh lacks is zero, as in Cycles.
    Raises SceneError when a vertex is not finite, or a face uses one that does not exist.
    """
    triangles = _transposed(_read(mesh.loop_triangles, "vertices", np.int32, 3))
    positions = _transposed(_read(mesh.vertices, "co", np.float32, 3))
    bad = int((~near(positions)).sum())
    if bad:
        raise SceneError(
            f"{name}: {plural(bad, 'coordinate')} of vertices not finite or beyond {FARTHEST:g}; "
            "repair the mesh or the modifier that made it"
        )
    corners = read_corners(mesh)
    polygon = _read(mesh.loop_triangle_polygons, "value", np.int32)
    for index, count in ((triangles, len(mesh.vertices)), (corners, len(mesh.loops)), (polygon, len(mesh.polygons))):
        require_indices(index, count, name)
    smooth = _smooth(mesh, polygon)
    return LocalMesh(
        positions=positions,
        triangles=triangles,
        slot=_slots(mesh, polygon),
        smooth=smooth,
        corner_normals=read_normals(mesh, corners, triangles) if smooth.any() else None,
        uvs={uv_map: _uvs(mesh, uv_map, corners) for uv_map in uv_maps},
        generated=_generated(mesh) if generated else None,
        attributes={wanted: read_attribute(mesh, wanted, corners, triangles, polygon) for wanted in attributes},
    )


def require_indices(index: np.ndarray, count: int, name: str) -> None:
    """Raise SceneError unless every index is one of `count`.

    In a damaged file indices may be anything.
    """
    if index.size and (index.min() < 0 or index.max() >= count):
        raise SceneError(
            f"{name}: faces of its mesh use corners that are not there; remove the object, or make its mesh anew"
        )


def _read(collection: bpy.types.bpy_prop_collection, attribute: str, dtype: type, width: int = 1) -> np.ndarray:
    """(n,) or (n, width) array of an attribute of every item."""
    values = np.empty(len(collection) * width, dtype)
    collection.foreach_get(attribute, values)
    return values if width == 1 else values.reshape(-1, width)


def _transposed(rows: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(rows.T)


def _attribute(mesh: bpy.types.Mesh, name: str, domain: str, kind: str) -> np.ndarray | None:
    """(n,) the values of an attribute of that name, domain and kind.

    None where the mesh has none.
    """
    attribute = mesh.attributes.get(name)
    if attribute is None or attribute.domain != domain or attribute.data_type != kind:
        return None
    return _read(attribute.data, "value", {"INT": np.int32, "BOOLEAN": np.bool_}[kind])


def _slots(mesh: bpy.types.Mesh, polygon: np.ndarray) -> np.ndarray:
    """(t,) material slots as stored; slot 0 where the mesh stores none."""
    slots = _attribute(mesh, "material_index", "FACE", "INT")
    return np.zeros(polygon.size, np.int32) if slots is None else slots[polygon]


def _smooth(mesh: bpy.types.Mesh, polygon: np.ndarray) -> np.ndarray:
    """(t,) whether a face is shaded smooth.

    As in Cycles, all are where it reads a normal for each corner: those of a sharp face are the face's, or custom.
    Else sharp edges count only where no face says whether it is sharp.
    """
    sharp = _attribute(mesh, "sharp_face", "FACE", "BOOLEAN")
    if sharp is None or splits_normals(mesh):
        return np.full(polygon.size, mesh.normals_domain != "FACE")
    return ~sharp[polygon]


def is_smooth(mesh: bpy.types.Mesh) -> bool:
    """Whether any face is shaded smooth."""
    return bool(_smooth(mesh, _read(mesh.loop_triangle_polygons, "value", np.int32)).any())


def read_corners(mesh: bpy.types.Mesh) -> np.ndarray:
    """(t, 3) the numbers of the mesh's corners that the triangles have."""
    return _read(mesh.loop_triangles, "loops", np.int32, 3)


def read_normals(mesh: bpy.types.Mesh, corners: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(3, 3, t) normals of the triangles' corners, those that Cycles reads.

    The triangles have the mesh's `corners` (t, 3) and vertices `triangles` (3, t).
    """
    if splits_normals(mesh):
        return _picked(_read(mesh.corner_normals, "vector", np.float32, 3), corners)
    return _picked(_read(mesh.vertex_normals, "vector", np.float32, 3), triangles.T)


def read_undisplaced_normals(mesh: bpy.types.Mesh, local: LocalMesh) -> Normals:
    """The normals along which a mesh that was read as `local` is displaced."""
    normals = read_normals(mesh, read_corners(mesh), local.triangles)
    if not splits_normals(mesh):
        return Normals(normals)
    polygon = _read(mesh.loop_triangle_polygons, "value", np.int32)
    sharp = _attribute(mesh, "sharp_face", "FACE", "BOOLEAN")
    return Normals(normals, np.zeros(polygon.size, bool) if sharp is None else sharp[polygon])


def splits_normals(mesh: bpy.types.Mesh) -> bool:
    """Whether Cycles reads a normal for each corner.

    Before Blender 5.2, sharp faces alone did not make it do so.
    """
    if mesh.normals_domain != "CORNER":
        return False
    if bpy.app.version >= (5, 2, 0) or mesh.has_custom_normals:
        return True
    sharp = _attribute(mesh, "sharp_edge", "EDGE", "BOOLEAN")
    return sharp is not None and bool(sharp.any())


def _uvs(mesh: bpy.types.Mesh, uv_map: str, corners: np.ndarray) -> np.ndarray:
    """(3, 2, t) texture coordinates of the triangles' corners."""
    layer = mesh.uv_layers.get(uv_map) if uv_map else next((one for one in mesh.uv_layers if one.active_render), None)
    if layer is None:
        return np.zeros((3, 2, corners.shape[0]), np.float32)
    return _picked(_read(layer.uv, "vector", np.float32, 2), corners)


def _picked(rows: np.ndarray, index: np.ndarray) -> np.ndarray:
    """(3 corners, c, t) the `rows` (n, c) at `index` (t, 3).

    It takes one corner at a time, to save memory with a million triangles.
    """
    picked = np.empty((3, rows.shape[1], index.shape[0]), rows.dtype)
    for corner in range(3):
        picked[corner] = rows[index[:, corner]].T
    return picked


def _generated(mesh: bpy.types.Mesh) -> np.ndarray:
    """(3, v) generated coordinates.

    They are undeformed positions within the texture space, which maps to 0..1.
    """
    location = np.array(mesh.texspace_location, np.float32)[:, None]
    size = np.array(mesh.texspace_size, np.float32)[:, None]
    undeformed = _transposed(_read(mesh.vertices, "undeformed_co", np.float32, 3))
    half = np.divide(0.5, size, out=np.zeros_like(size), where=size != 0.0)
    return (undeformed - location) * half + np.float32(0.5)
