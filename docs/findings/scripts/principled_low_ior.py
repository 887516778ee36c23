# SPDX-License-Identifier: GPL-3.0-or-later
"""Principled BSDF, opaque, IOR below 1, in a white furnace: more comes back than arrives.

The column "layer" is the albedo of the specular layer by quadrature. "taken" is what Cycles takes from the base for it:
a white base minus a black one under one sun give (1 - taken) cos / pi, without noise.
"""

import numpy as np

import probe
import quadrature

CASES = [(0.8, 0.1, 60.0), (0.8, 0.1, 75.0), (0.8, 0.3, 60.0), (0.8, 0.3, 84.0), (0.8, 0.5, 60.0), (0.95, 0.1, 80.0)]
CASES += [(1.25, 0.1, 60.0), (1.25, 0.3, 84.0)]


def scene_of(ior, roughness, angle, base, size=1, samples=1):
    scene = probe.start(size, samples)
    material = probe.add_material(
        "BsdfPrincipled", distribution="GGX", Base_Color=(base, base, base, 1.0), IOR=ior, Roughness=roughness
    )
    probe.add_plane(scene, material)
    probe.look_from(scene, probe.tilted(angle))
    return scene


rows = []
for ior, roughness, angle in CASES:
    seen = []
    for base in (1.0, 0.0):
        scene = scene_of(ior, roughness, angle, base)
        probe.add_sun(scene, probe.tilted(20.0, 90.0), 100.0)
        seen.append(probe.render(scene).mean())
    taken = 1.0 - (seen[0] - seen[1]) * np.pi / (100.0 * np.cos(np.radians(20.0)))
    layer = quadrature.reflected(np.cos(np.radians(angle)), roughness**2, lambda c, n=ior: quadrature.fresnel(c, n))
    scene = scene_of(ior, roughness, angle, 1.0, 48, 64)
    probe.light_world(scene)
    shown, noise = probe.mean(probe.render(scene))
    rows.append((ior, roughness, angle, f"{layer:.4f}", f"{taken:.4f}", 1.0, shown, noise))
probe.show("Principled, opaque, white base, white furnace", ("IOR", "roughness", "angle", "layer", "taken"), rows)
