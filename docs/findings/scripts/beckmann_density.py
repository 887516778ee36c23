# SPDX-License-Identifier: GPL-3.0-or-later
"""Glossy BSDF, Beckmann: light found by BSDF sampling.

It is compared with the integral of the lobe that light sampling sees. Cycles evaluates the lobe and its density with a
rational fit of Smith's Lambda, but samples the exact distribution. BSDF sampling therefore gives the lobe times
(1 + fit) / (1 + exact).
"""

import math

import numpy as np

import probe


def fit(cos, alpha):
    """Rational fit of Lambda, Walter et al. (2007), as Cycles bounds it."""
    a = cos / (alpha * np.sqrt(np.maximum(1 - cos * cos, 1e-30)))
    inside = (1 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a)
    return np.where(1 / (a * a) < 0.39, 0.0, inside)


def exact(cos, alpha):
    a = cos / (alpha * math.sqrt(1 - cos * cos))
    return (math.erf(a) - 1) / 2 + math.exp(-a * a) / (2 * a * math.sqrt(math.pi))


def value(view, light, alpha):
    """Lobe times cosine, with the fit."""
    h = view[:, None] + light
    h /= np.linalg.norm(h, axis=0)
    density = np.exp((1 - 1 / h[2] ** 2) / alpha**2) / (np.pi * alpha**2 * h[2] ** 4)
    return density / (4 * view[2] * (1 + fit(view[2], alpha) + fit(light[2], alpha)))


def scene_of(roughness, view, size=1, samples=1):
    scene = probe.start(size, samples)
    material = probe.add_material(
        "BsdfAnisotropic", distribution="BECKMANN", Color=(1.0, 1.0, 1.0, 1.0), Roughness=roughness
    )
    probe.add_plane(scene, material)
    probe.look_from(scene, view)
    return scene


suns, world = [], []
lights, weights = probe.sphere_grid(300, 300)
for roughness, cos in ((1.0, 0.8), (1.0, 0.6), (0.8, 0.5), (0.8, 0.3), (0.8, 0.15)):
    alpha, view = roughness**2, np.array([np.sqrt(1 - cos * cos), 0.0, cos])
    light = probe.tilted(40.0, 130.0)
    scene = scene_of(roughness, view)
    probe.add_sun(scene, light)
    suns.append((roughness, cos, value(view, light[:, None], alpha)[0], probe.render(scene).mean(), 0.0))
    scene = scene_of(roughness, view, 64, 256)
    probe.light_world(scene)
    seen, noise = probe.mean(probe.render(scene))
    book = np.sum(weights * value(view, lights, alpha))
    predicted = book * (1 + fit(cos, alpha)) / (1 + exact(cos, alpha))
    world.append((roughness, cos, f"{100 * (predicted / book - 1):+.3f} %", book, seen, noise))
probe.show("Beckmann, one sun (light sampling)", ("roughness", "cos"), suns)
probe.show("Beckmann, uniform world (BSDF sampling)", ("roughness", "cos", "predicted"), world)
