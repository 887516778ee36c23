# SPDX-License-Identifier: GPL-3.0-or-later
"""Glossy BSDF, Ashikhmin-Shirley: BSDF sampling against quadrature in a uniform world.

First table: a uniform world, which Cycles does not sample as a light, so that BSDF sampling is alone. The column
"with stray" adds to the integral the samples that come from half vectors seen from behind.
Second table: a square light of radiance 1 above the plane, once as a mesh that is not sampled (BSDF sampling alone) and
once as an area light without MIS (light sampling alone). Both must give the same integral.
"""

import numpy as np

import probe

HALF, HEIGHT = 10.0, 1.0

# roughness, anisotropy, angle of the viewer, its turn about the normal
CASES = [
    (0.3, 0.0, 80.0, 0.0),
    (0.5, 0.0, 60.0, 0.0),
    (0.5, 0.0, 80.0, 0.0),
    (0.7, 0.0, 45.0, 0.0),
    (0.7, 0.0, 80.0, 0.0),
    (0.9, 0.0, 60.0, 0.0),
    (0.9, 0.0, 80.0, 0.0),
    (0.7, 0.6, 80.0, 0.0),
    (0.7, 0.6, 80.0, 90.0),
]


def exponents(roughness, anisotropy):
    alpha = roughness**2
    ax, ay = min(alpha * (1 - anisotropy), 1.0), min(alpha / (1 - anisotropy), 1.0)
    return 2 / ax**2 - 2, 2 / ay**2 - 2


def half_vectors(nx, ny, nodes=800):
    """Half vectors at equal weight, by Ashikhmin and Shirley (2000), eq. 9 and 10."""
    u = (np.arange(nodes) + 0.5) / nodes
    u1, u2 = (x.ravel() for x in np.meshgrid(u, u))
    phi = np.arctan2(np.sqrt(nx + 1) * np.sin(2 * np.pi * u1), np.sqrt(ny + 1) * np.cos(2 * np.pi * u1))
    cos = u2 ** (1 / (nx * np.cos(phi) ** 2 + ny * np.sin(phi) ** 2 + 1))
    sin = np.sqrt(1 - cos * cos)
    return np.stack([sin * np.cos(phi), sin * np.sin(phi), cos])


def value(view, light, nx, ny):
    """Lobe times cosine, Ashikhmin and Shirley (2000), eq. 4 without the Fresnel factor.

    Directions are unit vectors (3, n).
    """
    h = view[:, None] + light
    h /= np.linalg.norm(h, axis=0)
    power = (nx * h[0] ** 2 + ny * h[1] ** 2) / np.maximum(1 - h[2] ** 2, 1e-15)
    scale = np.sqrt((nx + 1) * (ny + 1)) / (8 * np.pi)
    return scale * h[2] ** power * light[2] / ((view @ h) * np.maximum(view[2], light[2]))


def integral(view, h):
    """Integral of the lobe times cosine over the hemisphere.

    Over half vectors of density p it is the mean of n.l / max(n.v, n.l), because p / (4 h.v) is the density of l.
    """
    c = view @ h
    light = 2 * c * h[2] - view[2]
    return np.mean(np.where((c > 0) & (light > 0), light / np.maximum(view[2], light), 0.0))


def stray(view, h, is_lit=lambda light: True):
    """Mean of f cos / pdf over the directions that Cycles keeps below the facet.

    For half vectors with h.v < 0 they are -v - 2 (h.v) h.
    """
    c = view @ h
    light = -view[:, None] - 2 * c * h
    up = light[2]
    return np.mean(np.where((c < 0) & (up > 0) & is_lit(light), up / np.maximum(view[2], up), 0.0))


def scene_of(roughness, anisotropy, view, samples):
    scene = probe.start(size=64, samples=samples)
    material = probe.add_material(
        "BsdfAnisotropic",
        distribution="ASHIKHMIN_SHIRLEY",
        Color=(1.0, 1.0, 1.0, 1.0),
        Roughness=roughness,
        Anisotropy=anisotropy,
    )
    tree = probe.node_tree(material)
    glossy = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeBsdfAnisotropic")
    axis = tree.nodes.new("ShaderNodeCombineXYZ")
    axis.inputs["X"].default_value = 1.0
    tree.links.new(axis.outputs[0], glossy.inputs["Tangent"])
    probe.add_plane(scene, material)
    probe.look_from(scene, view)
    return scene


def square_light(scene, kind):
    """Square of 20 m and radiance 1, 1 m above the plane, facing down."""
    if kind == "mesh":
        glow = probe.add_material("Emission", "Glow", Color=(1.0, 1.0, 1.0, 1.0), Strength=1.0)
        glow.cycles.emission_sampling = "NONE"
        probe.add_plane(scene, glow, half=HALF, height=HEIGHT, name="Light").visible_camera = False
    else:
        probe.add_area_light(scene, 2 * HALF, HEIGHT).cycles.use_multiple_importance_sampling = False


def under_square(view, nx, ny, nodes=500):
    """Integral over the square light: lobe cos, times cos / distance^2 at the light."""
    x, w = np.polynomial.legendre.leggauss(nodes)
    x, y = (a.ravel() for a in np.meshgrid(HALF * x, HALF * x))
    distance2 = (x - probe.AIM[0]) ** 2 + (y - probe.AIM[1]) ** 2 + HEIGHT**2
    light = np.stack([x - probe.AIM[0], y - probe.AIM[1], np.full_like(x, HEIGHT)]) / np.sqrt(distance2)
    return np.sum(value(view, light, nx, ny) * light[2] / distance2 * HALF**2 * np.outer(w, w).ravel())


def hits_square(light):
    reach = HEIGHT / np.maximum(light[2], 1e-9)
    return (np.abs(probe.AIM[0] + light[0] * reach) < HALF) & (np.abs(probe.AIM[1] + light[1] * reach) < HALF)


world = []
for roughness, anisotropy, angle, turn in CASES:
    view = probe.tilted(angle, turn)
    scene = scene_of(roughness, anisotropy, view, 64)
    probe.light_world(scene)
    seen, noise = probe.mean(probe.render(scene))
    h = half_vectors(*exponents(roughness, anisotropy))
    book = integral(view, h)
    world.append((roughness, anisotropy, angle, turn, f"{book + stray(view, h):.5f}", book, seen, noise))
probe.show(
    "Ashikhmin-Shirley, white, uniform world of radiance 1",
    ("roughness", "anisotropy", "angle", "turn", "with stray"),
    world,
)

square = []
for roughness, angle in ((0.5, 60.0), (0.7, 80.0), (0.9, 80.0)):
    view = probe.tilted(angle)
    n = exponents(roughness, 0.0)
    book = under_square(view, *n)
    with_stray = book + stray(view, half_vectors(*n), hits_square)
    for kind, way in (("mesh", "BSDF"), ("lamp", "light")):
        scene = scene_of(roughness, 0.0, view, 128)
        square_light(scene, kind)
        seen, noise = probe.mean(probe.render(scene))
        square.append((roughness, angle, way, f"{with_stray:.5f}", book, seen, noise))
probe.show(
    "Ashikhmin-Shirley, white, square light of radiance 1", ("roughness", "angle", "sampling", "with stray"), square
)
