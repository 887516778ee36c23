# SPDX-License-Identifier: GPL-3.0-or-later
"""The frames of normal maps at corners."""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.surfaces.surface import SurfaceTables
from etalon.tests.scenes import icosphere, mesh, quad

ANGLES = (0.3, 2.0, -1.1)


def plates(mirrored=False):
    """A square for each of ANGLES, an object each, whose map is turned by that angle about +z."""
    made = mesh(*(quad((k, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)) for k in range(len(ANGLES))))
    x, y = made.vertices[:2, made.triangles]
    turn = np.array(ANGLES)[made.object_index]
    u, v = x * np.cos(turn) + y * np.sin(turn), y * np.cos(turn) - x * np.sin(turn)
    return replace(made, uvs={"": np.stack([u, -v if mirrored else v], axis=1).astype(np.float32)})


@pytest.mark.parametrize("mirrored", [False, True])
def test_tangents_of_a_turned_map_are_turned(mirrored):
    made = plates(mirrored)
    frames = SurfaceTables(made).normal_map_frame("", np.arange(made.triangle_count))
    turn = np.array(ANGLES)[made.object_index]
    zero, one = np.zeros(turn.size), np.ones(turn.size)
    exact = np.stack([np.cos(turn), np.sin(turn), zero, -one if mirrored else one, zero, zero, one])
    np.testing.assert_allclose(frames, np.stack([exact] * 3), atol=1e-6)


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1), (1,), (2, 2)])
def test_frames_do_not_depend_on_what_was_asked_before(order, rng):
    spheres = mesh(*[icosphere(1.0, 1, 0, True)] * 3)
    spheres = replace(spheres, uvs={"": rng.random((3, 2, spheres.triangle_count)).astype(np.float32)})
    whole = SurfaceTables(spheres).normal_map_frame("", np.arange(spheres.triangle_count))
    tables = SurfaceTables(spheres)
    for k in order:
        own = np.flatnonzero(spheres.object_index == k)
        some = rng.permutation(own)[:7]
        np.testing.assert_array_equal(tables.normal_map_frame("", some), whole[..., some])
