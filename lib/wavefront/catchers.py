# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadow catchers: objects that the camera sees only by the shadows on them.

Cycles divides the light of a catcher with all objects by that of the catchers alone, pixel by pixel, and lays the
objects over it (`film_calculate_shadow_catcher`). A quotient of two noisy means is biased, so it is not compared. Cycles
splits a path where a ray from the camera first meets a catcher, and from there on the path adds nothing to the objects'
image (`integrator_split_shadow_catcher`). Faces that let the ray straight through come before that, reflections and
refractions do not: rays that anything scattered meet the catcher as any other object.
"""

from __future__ import annotations

import numpy as np

from ..scene.mesh import Mesh
from .paths import Paths
from .raycaster import Hits


def catching_faces(mesh: Mesh) -> np.ndarray:
    """Whether the triangles belong to shadow catchers, (t + 1,) bool; the last entry, False, is for misses."""
    catches = np.array([thing.catches_shadows for thing in mesh.objects], bool)
    return np.append(catches[mesh.object_index], False)


def end_at_catchers(catchers: np.ndarray, paths: Paths, hits: Hits) -> tuple[Paths, Hits]:
    """The paths (n,) that go on, and their hits: all but those of the camera that meet a catcher.

    `catchers` is that of `catching_faces`. What volumes scatter and emit before the catcher counts, as in Cycles.
    """
    ends = np.take(catchers, hits.triangle) & np.equal(paths.scatterings, 0)
    if not ends.any():
        return paths, hits
    index = np.flatnonzero(~ends)
    return paths.take(index), hits.at(index)
