# SPDX-License-Identifier: GPL-3.0-or-later
"""Refraction BSDF, GGX: light sampling against BSDF sampling and quadrature.

The plane is white, rough and refracts; a light of radiance 1 lies below it. First table: one sun at a time, no noise.
Second table: a square of 20 m, 1 m below the plane, as a mesh that is not sampled (BSDF sampling alone) and as an area
light without MIS (light sampling alone). A passive surface cannot show more than the radiance of the light, 1.
"""

import numpy as np

import probe

HALF, HEIGHT = 10.0, 1.0
IOR, ROUGHNESS = 1.5, 0.8
ALPHA = ROUGHNESS**2


def smith_lambda(cos):
    return 0.5 * (np.sqrt(1 + ALPHA**2 * (1 / cos**2 - 1)) - 1)


def value(view, light, backs):
    """Walter et al. (2007), eq. 21, times cosine, without F.

    0 where the viewer or the light sees the facet from behind. With `backs` such facets, and facets that face down,
    count as if they were seen from the front.
    """
    h = -(IOR * light + view[:, None])
    length = np.linalg.norm(h, axis=0)
    h /= length
    c, t = view @ h, np.sum(light * h, axis=0)
    density = ALPHA**2 / (np.pi * (1 + (ALPHA**2 - 1) * h[2] ** 2) ** 2)
    passed = 1 / (1 + smith_lambda(view[2]) + smith_lambda(np.abs(light[2])))
    inside = 1 - (1 - c * c) / IOR**2
    kept = (inside > 0) & ((h[2] > 0) & (c > 0) & (t < 0) | backs)
    return np.where(kept, density * passed * np.abs(c * t) * IOR**2 / (length**2 * view[2]), 0.0)


def below_square(view, backs, nodes=600):
    x, w = np.polynomial.legendre.leggauss(nodes)
    x, y = (a.ravel() for a in np.meshgrid(HALF * x, HALF * x))
    x, y = x - probe.AIM[0], y - probe.AIM[1]
    distance2 = x * x + y * y + HEIGHT**2
    light = np.stack([x, y, np.full_like(x, -HEIGHT)]) / np.sqrt(distance2)
    return np.sum(value(view, light, backs) * HEIGHT / distance2**1.5 * HALF**2 * np.outer(w, w).ravel())


def scene_of(view, size=1, samples=1):
    scene = probe.start(size, samples)
    material = probe.add_material(
        "BsdfRefraction", distribution="GGX", Color=(1.0, 1.0, 1.0, 1.0), Roughness=ROUGHNESS, IOR=IOR
    )
    probe.add_plane(scene, material)
    probe.look_from(scene, view)
    return scene


suns = []
view = probe.tilted(80.0)
for angle, turn in ((180.0, 0.0), (140.0, 180.0), (120.0, 180.0), (120.0, 0.0), (140.0, 0.0), (100.0, 0.0)):
    light = probe.tilted(angle, turn)
    scene = scene_of(view)
    probe.add_sun(scene, light, 1.0)
    seen = probe.render(scene).mean()
    book, backs = (value(view, light[:, None], b)[0] for b in (False, True))
    suns.append((angle, turn, f"{backs:.6f}", book, seen, 0.0))
probe.show("Refraction, IOR 1.5, roughness 0.8, viewer at 80 degrees, one sun", ("angle", "turn", "with backs"), suns)

square = []
for angle in (0.0, 60.0, 80.0):
    view = probe.tilted(angle)
    book, backs = (below_square(view, b) for b in (False, True))
    for kind in ("mesh", "lamp"):
        scene = scene_of(view, 64, 128)
        if kind == "mesh":
            glow = probe.add_material("Emission", "Glow", Color=(1.0, 1.0, 1.0, 1.0), Strength=1.0)
            glow.cycles.emission_sampling = "NONE"
            probe.add_plane(scene, glow, half=HALF, height=-HEIGHT, name="Light")
        else:
            light = probe.add_area_light(scene, 2 * HALF, -HEIGHT, up=True)
            light.cycles.use_multiple_importance_sampling = False
        seen, noise = probe.mean(probe.render(scene))
        square.append((angle, "BSDF" if kind == "mesh" else "light", f"{backs:.5f}", book, seen, noise))
probe.show("Refraction, square light of radiance 1 below", ("angle", "sampling", "with backs"), square)
