# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables behind Multiscatter GGX: the albedo E that Cycles reads, against quadrature.

One sun, no noise. A white lobe is the single-scattering lobe divided by E. The same sun on GGX and on Multiscatter GGX
gives E.
"""

import numpy as np

import probe
import quadrature


def read_albedo(kind, roughness, angle, **inputs):
    seen = []
    for distribution in ("GGX", "MULTI_GGX"):
        scene = probe.start()
        material = probe.add_material(
            kind, distribution=distribution, Color=(1.0, 1.0, 1.0, 1.0), Roughness=roughness, **inputs
        )
        probe.add_plane(scene, material)
        probe.look_from(scene, probe.tilted(angle))
        probe.add_sun(scene, probe.tilted(min(angle, 80.0), 180.0), 10.0)
        seen.append(probe.render(scene).mean())
    return seen[0] / seen[1]


def glass_albedo(cos, alpha, eta):
    """Reflection and refraction once, towards a viewer at `cos`.

    Mean of G2 / G1 over the visible facets.
    """
    view, facet = quadrature.visible_facets(cos, alpha, 900)
    c = view @ facet
    f = quadrature.fresnel(c, eta)
    t = np.sqrt(np.maximum(1 - (1 - c * c) / eta**2, 0.0))
    up, down = 2 * c * facet[2] - cos, (c / eta - t) * facet[2] - cos / eta
    seen = quadrature.smith_lambda(cos, alpha)

    def passed(out):
        share = (1 + seen) / (1 + seen + quadrature.smith_lambda(np.maximum(out, 1e-9), alpha))
        return np.where(out > 0, share, 0.0)

    return float(np.mean(f * passed(up) + (1 - f) * passed(-down)))


glossy, glass = [], []
for roughness, cos in ((0.2, 0.02), (0.35, 0.05), (0.5, 0.02), (0.5, 0.2), (0.8, 0.02), (0.8, 0.5)):
    angle = np.degrees(np.arccos(cos))
    book = quadrature.reflected(cos, roughness**2)
    glossy.append((roughness, cos, book, read_albedo("BsdfAnisotropic", roughness, angle), 0.0))
probe.show("albedo E of GGX as tabulated", ("roughness", "cos"), glossy)
for ior, roughness, cos in (
    (1.5, 0.6, 0.03),
    (1 / 1.5, 0.6, 0.03),
    (1.5, 0.6, 0.5),
    (1 / 1.5, 0.3, 0.1),
    (1.33, 0.4, 0.05),
):
    angle = np.degrees(np.arccos(cos))
    book = glass_albedo(cos, roughness**2, ior)
    glass.append((ior, roughness, cos, book, read_albedo("BsdfGlass", roughness, angle, IOR=ior), 0.0))
probe.show("albedo E of GGX glass as tabulated", ("IOR", "roughness", "cos"), glass)
