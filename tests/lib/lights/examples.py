# SPDX-License-Identifier: GPL-3.0-or-later
"""One light of every kind that has an extent."""

import math

from etalon.lib.scene.lights import AreaLight, Cone, SphereLight, SpotLight, SunLight

RADIANCE = (1.0, 2.0, 0.5)
CONE = Cone((0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), math.cos(0.6), 0.4)
SQUEEZED = Cone((0.0, 0.0, -1.0), (2.0, 0.0, 0.0), (0.0, 0.7, 0.0), math.cos(0.6), 0.4)


def area(shape, spread=math.pi, edge_v=(0.0, 1.0, 0.0)):
    return AreaLight("area", (0.3, -0.2, 2.0), (1.5, 0.0, 0.0), edge_v, (0.0, 0.0, -1.0), shape, RADIANCE, spread)


LIGHTS = {
    "sphere": SphereLight("sphere", (0.2, 0.1, 2.0), 0.5, RADIANCE),
    "spot": SpotLight("spot", (0.2, 0.1, 2.0), 0.5, RADIANCE, CONE),
    "squeezed spot": SpotLight("squeezed spot", (0.2, 0.1, 2.0), 0.5, RADIANCE, SQUEEZED),
    "sun": SunLight("sun", (0.0, 0.6, 0.8), 0.2, RADIANCE),
    "rectangle": area("RECTANGLE"),
    "rectangle with spread": area("RECTANGLE", 1.0),
    "parallelogram": area("RECTANGLE", edge_v=(0.4, 1.0, 0.0)),
    "parallelogram with spread": area("RECTANGLE", 1.5, (0.4, 1.0, 0.0)),
    "ellipse": area("ELLIPSE"),
    "ellipse with spread": area("ELLIPSE", 0.5),
    "sheared ellipse": area("ELLIPSE", 2.0, (0.4, 1.0, 0.0)),
}
