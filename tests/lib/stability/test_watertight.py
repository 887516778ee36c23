# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays at shared edges: none passes; a hole is seen."""

import dataclasses

import numpy as np
from etalon.lib.stability import watertight
from etalon.lib.wavefront.raycaster import Raycaster


def test_no_ray_passes_a_shared_edge(rng):
    mesh = watertight.closed_mesh(rng)
    assert watertight._passed(Raycaster(mesh), mesh, rng, 1_000_000, corners=False) == 0


def test_a_missing_triangle_is_seen(rng):
    mesh = watertight.closed_mesh(rng)
    holed = dataclasses.replace(
        mesh,
        triangles=np.ascontiguousarray(mesh.triangles[:, 1:]),
        material_index=mesh.material_index[1:],
        object_index=mesh.object_index[1:],
        smooth=mesh.smooth[1:],
    )
    assert watertight._passed(Raycaster(holed), mesh, rng, 500_000, corners=False) > 10
