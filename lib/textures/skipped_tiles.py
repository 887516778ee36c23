# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles of images that Cycles does not load although faces reach into them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields

import numpy as np

from ..scene.expressions import BLACK, WHITE, Coordinates, Expression, Mapping, Tile
from ..scene.materials import Material
from ..scene.mesh import Mesh
from .fold import walk
from .tiles import tile_corner

# Cycles counts a corner this little inside a tile to the one on its left or below.
_TOUCH = np.float32(1e-6)


def skipped_tiles(mesh: Mesh, materials: tuple[Material, ...]) -> Iterator[tuple[int, int]]:
    """Return the tiles that Cycles shows as missing although their file is there.

    Each is (index of the material, number of the tile).

    Where an image reads a UV map directly, Cycles loads only the tiles that have a corner of a face. A tile is named
    where the bounds of a triangle's texture coordinates reach into it, so some that no triangle covers may be named
    too.
    """
    for index, material in enumerate(materials):
        for uv_map, numbers in _tiles_by_map(material).items():
            uv = mesh.uvs[uv_map][..., mesh.material_index == index]
            column, row = np.trunc(uv).astype(int).swapaxes(0, 1)
            column, row = (
                np.where((whole > 0) & (place < whole + _TOUCH), whole - 1, whole)
                for whole, place in ((column, uv[:, 0]), (row, uv[:, 1]))
            )
            low, high = uv.min(axis=0, initial=np.inf), uv.max(axis=0, initial=-np.inf)
            for number in numbers:
                corner = np.array([tile_corner(number)]).T
                loaded = np.any((column == corner[0]) & (row == corner[1]))
                start = np.where(corner == 0, -1, corner)
                reached = np.all((low < corner + 1 - _TOUCH) & (high > start + _TOUCH), axis=0)
                if not loaded and np.any(reached):
                    yield index, number


def _tiles_by_map(material: Material) -> dict[str, list[int]]:
    """The tiles that a material reads, by the UV map that it reads directly."""
    found: dict[str, dict[int, None]] = {}
    for lobe in material.lobes:
        sockets = [lobe.weight, *(getattr(lobe.closure, one.name) for one in fields(lobe.closure))]
        for node in (node for socket in sockets if isinstance(socket, Expression) for node in walk(socket)):
            if isinstance(node, Tile):
                vector = _without_neutral_mappings(node.vector)
                if isinstance(vector, Coordinates) and vector.kind == "UV":
                    found.setdefault(vector.uv_map, {})[node.number] = None
    return {uv_map: list(numbers) for uv_map, numbers in found.items()}


def _without_neutral_mappings(vector: Expression) -> Expression:
    """Return what feeds `vector` without the Mapping nodes that change nothing.

    Cycles leaves these out, too.
    """
    neutral = (BLACK, BLACK, WHITE)
    while (
        isinstance(vector, Mapping)
        and vector.kind != "NORMAL"
        and (vector.location, vector.rotation, vector.scale) == neutral
    ):
        vector = vector.vector
    return vector
