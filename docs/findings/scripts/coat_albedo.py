# SPDX-License-Identifier: GPL-3.0-or-later
"""Principled BSDF: what the coat takes from the base beneath it.

It is compared with what the coat itself reflects.
"""

from functools import cache

import numpy as np

import probe
import quadrature

CASES = [(1.5, r, a) for r in (0.2, 0.4, 0.8) for a in (8.0, 60.0, 84.0)] + [(1.7, 0.4, 84.0)]
WEIGHT = 0.8


def coated(roughness, eta, base):
    return probe.add_material(
        "BsdfPrincipled",
        Base_Color=(base, base, base, 1.0),
        IOR=1.0,  # no specular layer: the coat lies on a Lambertian base
        Coat_Weight=WEIGHT,
        Coat_Roughness=roughness,
        Coat_IOR=eta,
    )


def taken(roughness, eta, angle):
    """Albedo A that Cycles takes, without noise.

    It comes from a white base minus a black one under one sun: (1 - weight A) cos / pi.
    """
    light, cos = probe.tilted(30.0, 70.0), np.cos(np.radians(30.0))
    seen = []
    for base in (1.0, 0.0):
        scene = probe.start()
        probe.add_plane(scene, coated(roughness, eta, base))
        probe.look_from(scene, probe.tilted(angle))
        probe.add_sun(scene, light, 100.0)
        seen.append(probe.render(scene).mean())
    return (1.0 - (seen[0] - seen[1]) * np.pi / (100.0 * cos)) / WEIGHT


def furnace(roughness, eta, angle):
    scene = probe.start(size=64, samples=128)
    probe.add_plane(scene, coated(roughness, eta, 1.0))
    probe.look_from(scene, probe.tilted(angle))
    probe.light_world(scene)
    return probe.mean(probe.render(scene))


quadrature.average_albedo = cache(quadrature.average_albedo)
albedos, furnaces = [], []
for eta, roughness, angle in CASES:
    albedo, factor = quadrature.compensated(np.cos(np.radians(angle)), roughness**2, eta)
    found = taken(roughness, eta, angle)
    albedos.append((eta, roughness, angle, f"{1 / factor:.4f}", albedo, found, 0.0))
    shown, noise = furnace(roughness, eta, angle)
    furnaces.append((eta, roughness, angle, 1.0, shown, noise))
probe.show(
    "albedo that the coat takes from the base; 1/f is 1 / (E + Fms (1 - E))",
    ("coat IOR", "roughness", "angle", "1/f"),
    albedos,
)
probe.show(f"white furnace, white base, coat weight {WEIGHT}", ("coat IOR", "roughness", "angle"), furnaces)
