# SPDX-License-Identifier: GPL-3.0-or-later
"""A Lambert plane under the sun, cut into slivers.

Faces of no area and doubled vertices lie over it. None of it may change the radiance, albedo / pi x irradiance x
cosine.
"""

from __future__ import annotations

import math

import numpy as np

from .. import building
from .edge_case import EdgeCase, look, start, sun

ALBEDO, IRRADIANCE = 0.5, 2.0
TOWARD = (0.48, -0.36, 0.8)


def _build() -> None:
    start("bad faces", max_bounces=2)
    # Slivers: a fan of strips whose widths fall from a metre to a nanometre.
    edges = np.concatenate([[-2.0], -np.geomspace(1.0, 1e-9, 10), np.geomspace(1e-9, 1.0, 10), [2.0]])
    low, high = np.full(edges.size, -2.0), np.full(edges.size, 2.0)
    vertices = np.concatenate([np.stack([edges, side, 0.0 * edges], axis=1) for side in (low, high)])
    first = np.arange(edges.size - 1)
    size = edges.size
    faces = [half for k in first for half in ((k, k + 1, k + 1 + size), (k, k + 1 + size, k + size))]
    # Faces of no area: three corners on a line, and all corners in one place.
    start_of_bad = len(vertices)
    bad = np.array(
        [[-1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.3, 0.3, 0.0], [0.3, 0.3, 0.0], [0.3, 0.3, 0.0]]
    )
    vertices = np.concatenate([vertices, bad])
    faces += [tuple(start_of_bad + k for k in corners) for corners in ((0, 1, 2), (3, 4, 5))]
    building.mesh("Plane", vertices, np.array(faces), [building.diffuse("White", (ALBEDO,) * 3)])
    sun(tuple(-c for c in TOWARD), IRRADIANCE)
    look((0.0, 0.0, 0.0), (0.1, 0.2, 1.0), 4.0, 2.5)


CASES = (
    EdgeCase(
        "slivers and faces of no area",
        _build,
        ALBEDO / math.pi * IRRADIANCE * TOWARD[2],
        1e-5,
        64,
        "albedo / pi x irradiance x cosine",
    ),
)
