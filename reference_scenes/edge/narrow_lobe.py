# SPDX-License-Identifier: GPL-3.0-or-later
"""A lobe of alpha 1e-4 that mirrors a small light.

Light sampling and BSDF sampling differ there by a factor of 1e7. The camera sees only points in which every facet of
weight sends it into the light, of 0.02 rad across. Beckmann's radiance is then the light's own; GGX's long tail sends
alpha^2 / (alpha^2 + t^2) of its facets past it, t = 0.005 being the tilt that reaches the light's edge from the middle:
4e-4 there, which the tolerance covers.
"""

from __future__ import annotations

from .. import building
from .edge_case import EdgeCase, look, start

ALPHA, RADIANCE, DISTANCE = 1e-4, 5.0, 10.0


def _build(distribution: str) -> None:
    start(f"narrow {distribution}")
    material = building.glossy("Narrow", distribution, ALPHA, (1.0, 1.0, 1.0))
    building.rectangle("Floor", material, (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    toward = (0.6, 0.0, 0.8)
    place = tuple(DISTANCE * c for c in toward)
    building.area_light("Small", place, (0.0, 0.0, 0.0), (0.2, 0.2), (RADIANCE,) * 3)
    look((0.0, 0.0, 0.0), (-0.6, 0.0, 0.8), 5.0, 0.01)


CASES = (
    EdgeCase("alpha 1e-4 under a small light, Beckmann", lambda: _build("BECKMANN"), RADIANCE, 1e-3, 256, "a mirror's"),
    EdgeCase(
        "alpha 1e-4 under a small light, GGX", lambda: _build("GGX"), RADIANCE, 2e-3, 256, "a mirror's, less the tail"
    ),
)
