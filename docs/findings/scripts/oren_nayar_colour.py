# SPDX-License-Identifier: GPL-3.0-or-later
"""Diffuse BSDF, rough: light scattered k times must carry the colour k times.

One sun, no noise. Energy-preserving Oren-Nayar of Fujii (2012) with the multiple scattering of OpenPBR: the walk leaves
with probability E(view) at the first scattering and Eavg at each later one. For colour c the part scattered twice or
more is (1 - E(l)) (1 - E(v)) / (pi (1 - Eavg)) times the sum over k >= 2 of c^k (1 - Eavg)^(k - 2) Eavg.
"""

import numpy as np

import probe


def hemisphere(a, b, mu):
    """E(mu), by quadrature.

    It is the integral of the single-scattering lobe times cosine over the hemisphere.
    """
    light, weight = probe.sphere_grid(150, 240)
    s = np.sqrt(1 - mu * mu) * light[0]
    t = np.where(s > 0, s / np.maximum(np.maximum(mu, light[2]), 1e-12), s)
    return np.sum(weight * light[2] * (a + b * t))


def average(a, b, nodes=16):
    """Eavg = integral of 2 mu E(mu)."""
    x, w = np.polynomial.legendre.leggauss(nodes)
    return sum(wk * 0.5 * (1 + xk) * hemisphere(a, b, 0.5 * (1 + xk)) for xk, wk in zip(x, w, strict=True))


rows = []
roughness = 1.0
a = 1 / (np.pi + roughness * (np.pi / 2 - 2 / 3))
b = roughness * a
eavg = average(a, b)
for color in (1.0, 0.8, 0.5, 0.2):
    for angle in (30.0, 75.0):
        view, light = probe.tilted(angle), probe.tilted(60.0, 120.0)
        s = view @ light - view[2] * light[2]
        t = s / max(view[2], light[2]) if s > 0 else s
        ev, el = hemisphere(a, b, view[2]), hemisphere(a, b, light[2])
        orders = np.arange(2, 400)
        walk = np.sum(color**orders * (1 - eavg) ** (orders - 2.0) * eavg)
        more = (1 - ev) * (1 - el) / (np.pi * (1 - eavg)) * walk
        expected = light[2] * (color * (a + b * t) + more)
        up_to_52 = light[2] * (color * (a + b * t) + color * more)
        scene = probe.start()
        probe.add_plane(scene, probe.add_material("BsdfDiffuse", Color=(color,) * 3 + (1.0,), Roughness=roughness))
        probe.look_from(scene, view)
        probe.add_sun(scene, light)
        seen = probe.render(scene).mean()
        rows.append((color, angle, f"{up_to_52:.6f}", expected, seen, 0.0))
probe.show("Diffuse BSDF, roughness 1, one sun at 60 degrees", ("color", "angle", "extra colour"), rows)
