# SPDX-License-Identifier: GPL-3.0-or-later
"""All triangles of the scene, in world space, in one set of arrays."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .links import UNLINKED, Links
from .overlaps import Overlaps, find_overlaps
from .rays import EVERY
from .shells import find_defect

FARTHEST = 1e18
"""Coordinates beyond this are refused: their squares leave single precision, in which both renderers look for hits."""

UNDISPLACED, UNDISPLACED_NORMAL = ".undisplaced", ".undisplaced_N"
"""Attributes of corners, in object space: where they were before they were displaced, and the shading normal there."""


def near(positions: np.ndarray) -> np.ndarray:
    """Whether each coordinate is a number that is no larger than FARTHEST."""
    return np.abs(positions) <= FARTHEST


@dataclass(frozen=True)
class Object:
    """An object (or one instance) with the user's name for it.

    `world_from_object` is a (3, 4) affine map.
    `color` (red, green, blue, alpha), `index` and `random`, from 0 to 1, are what materials can ask of it. `rays` is
    the mask of the rays that meet it (rays.py); others pass through it as if it were not there. `receiver` and
    `blocker` number the sets of objects to which it belongs where lights are linked to what they light and to what
    hides them, `links` says so of the light that it emits (links.py). What the camera sees of an object that
    `catches_shadows` is not compared; for all other rays it is an object like any other.
    """

    name: str
    world_from_object: np.ndarray
    color: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    index: int = 0
    random: float = 0.0
    rays: int = EVERY
    receiver: int = 0
    blocker: int = 0
    links: Links = UNLINKED
    catches_shadows: bool = False


@dataclass(frozen=True)
class Mesh:
    """Triangles, counter-clockwise about the geometric normal.

    vertices (3, v) float64, metres; triangles (3, t) int32, indices of corners; material_index and object_index (t,) int32;
    smooth (t,) bool; corner_normals (3 corners, 3, t) float32 in world space, to be mixed as they are and then normalised (not all
    are of unit length), or (3, 3, 0) when no face is smooth;
    uvs: map name -> (3 corners, 2, t) float32, the maps that materials use ('' is the active render map); generated (3, v) float32, or (3, 0)
    when no material asks for it; attributes: name -> (3 corners, 6, t) float32, red, green, blue, alpha, factor and presence of those that
    materials use ('' is the active render colour).
    """

    vertices: np.ndarray
    triangles: np.ndarray
    material_index: np.ndarray
    object_index: np.ndarray
    smooth: np.ndarray
    corner_normals: np.ndarray
    objects: tuple[Object, ...]
    uvs: dict[str, np.ndarray] = field(default_factory=dict)
    generated: np.ndarray = field(default_factory=lambda: np.zeros((3, 0), np.float32))
    attributes: dict[str, np.ndarray] = field(default_factory=dict)

    @property
    def triangle_count(self) -> int:
        """Number of triangles."""
        return self.triangles.shape[1]

    @cached_property
    def overlaps(self) -> Overlaps:
        """The triangles that overlap in one plane, searched for when first asked."""
        return find_overlaps(self.vertices, self.triangles)

    def find_defect(self, object_index: int, material_index: int) -> str:
        """Why the faces of an object with a material do not say what is inside them.

        See shells.py. The search runs once.
        """
        key = object_index, material_index
        if key not in self._defects:
            faces = (self.object_index == object_index) & (self.material_index == material_index)
            self._defects[key] = find_defect(self.vertices, self.triangles[:, faces])
        return self._defects[key]

    @cached_property
    def _defects(self) -> dict[tuple[int, int], str]:
        return {}
