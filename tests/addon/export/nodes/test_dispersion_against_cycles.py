# SPDX-License-Identifier: GPL-3.0-or-later
"""Dispersion in Cycles: one sample of a wavelength in each pixel.

The wavelength is read off its colour, and compared with the lobe at that wavelength's index.
"""

import bpy
import numpy as np
import pytest
from etalon.addon.cycles.renderer import CyclesRenderer
from etalon.lib.bsdfs.dielectric import Interface, RoughDielectric
from etalon.lib.bsdfs.fresnels import Dielectric, TintedDielectric, reflectance_at_normal
from etalon.lib.microfacets.dispersion import cauchy_index
from etalon.lib.microfacets.ggx import GGX
from etalon.lib.sampling.wavelengths import COLORS, NODES
from etalon.tests.addon.export.nodes.node_cells import glowing, node, prepare, quad
from mathutils import Vector
from scipy.spatial import cKDTree

pytestmark = [
    pytest.mark.compares_with_cycles,
    pytest.mark.skipif(bpy.app.version < (5, 3), reason="Blender has dispersion from 5.3 on"),
]
TILT, ROUGHNESS = 0.1, 0.4
SUNS = {"refracted": (0.3, 0.2, -1.0), "reflected": (0.35, -0.3, 1.0)}
WHITE = np.ones((3, 1))


def shown(ior, abbe, sun, flipped):
    """One sample in each pixel of a tilted square, (n, 3); equal seeds draw equal wavelengths."""
    scene = prepare("ORTHO", 64, 64)
    scene.camera.data.ortho_scale, scene.camera.location = 0.9, (0.013, 0.007, 20.0)
    inputs = {"Base Color": (1.0, 1.0, 1.0, 1.0), "Transmission Weight": 1.0, "Roughness": ROUGHNESS, "IOR": ior}
    inputs |= {"Transmission Dispersion Scale": 1.0, "Transmission Dispersion Abbe Number": abbe}
    mesh = quad("square", (0.0, 0.0, 0.0), TILT, flipped)
    mesh.materials.append(glowing("glass", lambda tree: node(tree, "BsdfPrincipled", inputs, distribution="GGX")))
    light = bpy.data.lights.new("sun", "SUN")
    light.energy, light.angle = 2.0, 0.0
    lamp = bpy.data.objects.new("sun", light)
    lamp.rotation_euler = Vector(SUNS[sun]).to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(lamp)
    return CyclesRenderer(scene, threads=2).render(0, 1).radiance.reshape(-1, 3)


def wavelengths(colors):
    """The wavelengths, (n,), whose colours have these directions, and where there is one.

    They are accurate to 0.15 nm.
    """
    fine = np.linspace(430.0, 660.0, 23_001)
    curve = np.stack([np.interp(fine, NODES, one) for one in COLORS], axis=1)
    tree = cKDTree(curve / np.linalg.norm(curve, axis=1)[:, None])
    distance, index = tree.query(colors / np.linalg.norm(colors, axis=1)[:, None])
    return fine[index], (distance < 3e-4) & (index > 0) & (index < fine.size - 1)


def value(eta, ior, sun, departs):
    """The lobe's value towards the sun, (n,), at relative indices `eta`."""
    normal = np.array([0.0, -np.sin(TILT), np.cos(TILT)])
    axes = np.stack([np.array([1.0, 0.0, 0.0]), np.cross(normal, [1.0, 0.0, 0.0]), normal])
    wi, wo = np.array(SUNS[sun]) / np.linalg.norm(SUNS[sun]), np.array([0.0, 0.0, 1.0])
    wi, wo = (np.repeat((axes @ w)[:, None], eta.size, axis=1) for w in (wi, wo))
    curve = TintedDielectric(eta, reflectance_at_normal(np.float64(ior))) if departs else Dielectric(eta)
    alpha = np.float64(ROUGHNESS**2)
    return RoughDielectric(wo, alpha, alpha, eta, GGX(), Interface(curve, WHITE, WHITE)).evaluate(wi)[0][0]


@pytest.mark.parametrize("flipped", [False, True])
@pytest.mark.parametrize(("ior", "abbe"), [(1.5, 20.0), (1.5, 10.0), (0.8, 20.0)])
@pytest.mark.parametrize("sun", SUNS)
def test_each_wavelength_has_its_index(sun, ior, abbe, flipped):
    """Against the same pixels with an Abbe number so large that only the colour is left.

    The reflectance at normal incidence is that at n_d.
    """
    plain, spread = (shown(ior, number, sun, flipped) for number in (1e7, abbe))
    wavelength, told = wavelengths(plain)
    told &= np.abs(plain).max(axis=1) > 0.05 * np.abs(plain).max()
    wavelength, brightest = wavelength[told], np.abs(plain[told]).argmax(axis=1)[:, None]
    ratio = (np.take_along_axis(spread[told], brightest, 1) / np.take_along_axis(plain[told], brightest, 1))[:, 0]
    index, still = cauchy_index(np.float64(ior), 1.0 / abbe, wavelength), np.full(1, ior)
    if flipped:
        index, still = 1.0 / index, 1.0 / still
    expected = value(index, ior, sun, True) / value(still, ior, sun, True)
    assert told.sum() > 2000
    np.testing.assert_allclose(ratio, expected, rtol=3e-4)
    if sun == "reflected":
        exact = value(index, ior, sun, False) / value(still, ior, sun, False)
        assert np.abs(exact / ratio - 1.0).max() > 0.02
