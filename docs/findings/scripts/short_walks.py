# SPDX-License-Identifier: GPL-3.0-or-later
"""Subsurface scattering by Random Walk of a half space in a white world, by colour.

Expected is what Chandrasekhar's H function says of the albedo that Cycles makes of the colour: 1 - sqrt(1 - albedo) H(1), for light that
enters along the normal through a smooth interface. Blender 5.2 and later.
"""

import numpy as np

import probe

NODE, WEIGHT = np.polynomial.legendre.leggauss(64)
MU, WEIGHT = 0.5 * (NODE + 1.0), 0.5 * WEIGHT
SIZE, SAMPLES = 16, 256


def reflected(albedo):
    """What a half space that scatters evenly reflects of light along its normal."""
    root, h = np.sqrt(1.0 - albedo), np.ones_like(MU)
    for _ in range(5000):
        h = 0.5 * (h + 1.0 / (root + 0.5 * albedo * (WEIGHT * h * MU / (MU[:, None] + MU)).sum(axis=1)))
    return 1.0 - root / (root + 0.5 * albedo * (WEIGHT * h * MU / (1.0 + MU)).sum())


def mapped(color):
    """The albedo of Random Walk for a colour (d'Eon 2023, eq. 53.7)."""
    s = 4.20863 * color - np.sqrt(9.59217 + 41.6808 * color + 17.7126 * color * color) + 4.09712
    return min(1.0 - s * s, 0.999999)


rows = []
for color in (0.5, 0.8, 0.9, 0.95, 1.0):
    scene = probe.start(SIZE, SAMPLES)
    probe.node_tree(scene.world).nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    probe.node_tree(scene.world).nodes["Background"].inputs["Strength"].default_value = 1.0
    names = {"Color": (color,) * 3 + (1.0,), "Radius": (1.0, 1.0, 1.0), "Scale": 1e-3, "Roughness": 0.0}
    probe.add_plane(scene, probe.add_material("SubsurfaceScattering", falloff="RANDOM_WALK", **names))
    probe.look_from(scene, probe.tilted(0.0))
    image = probe.render(scene).mean(axis=2)
    noise = image.std() / image.size**0.5
    rows.append((color, mapped(color), reflected(mapped(color)), image.mean(), noise))
probe.show("half space in a white world", ("colour", "albedo"), rows)
