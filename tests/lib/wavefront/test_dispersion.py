# SPDX-License-Identifier: GPL-3.0-or-later
"""Dispersion in whole images, against quadrature over the spectrum.

One face and a prism stand under a sky that varies.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from etalon.lib.microfacets.dispersion import cauchy_index
from etalon.lib.microfacets.fresnel import dielectric
from etalon.lib.microfacets.layers import integrate_glass
from etalon.lib.sampling.wavelengths import COLORS, NODES
from etalon.lib.scene.expressions import ZERO, Constant, Coordinates, Math, ValueToColor, VectorToValue
from etalon.lib.scene.materials import Diffuse, Glass
from etalon.lib.scene.world import World
from etalon.lib.settings.reference import Options
from etalon.lib.surfaces.lobes import _glass_scattering
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.replicates import assert_mean, replicates
from etalon.tests.scenes import color, floor, material, orthographic, quad, scene
from scipy.integrate import trapezoid

IOR, ABBE = 1.5, 4.0
# A sky that grows downwards: -10 times the mean of the direction's components, less a half, and nothing below zero.
_DOWN = Math("MULTIPLY_ADD", VectorToValue(Coordinates("GENERATED")), Constant(-10.0), Constant(-0.5))
SKY = World(ValueToColor(Math("MAXIMUM", _DOWN, ZERO, ZERO)), (8, 4))


def sky(direction):
    return np.maximum(-10.0 * direction.mean(axis=0) - 0.5, 0.0)


def bend(direction, normal, eta):
    """Snell's direction beyond a face, and the share that passes; (3, n), (n,).

    The face's `normal` points against `direction`.
    """
    cos = -(normal[:, None] * direction).sum(axis=0)
    sine2 = (1.0 - cos * cos) / eta**2
    beyond = direction / eta + normal[:, None] * (cos / eta - np.sqrt(1.0 - sine2))
    return beyond, 1.0 - dielectric(cos, eta)


def mirror(direction, normal):
    return direction - 2.0 * normal[:, None] * (normal[:, None] * direction).sum(axis=0)


def spectral(value):
    """The colour of `value`, a function of the wavelength.

    It is a fine trapezoid rule over the observer's table.
    """
    fine = np.linspace(380.0, 780.0, 40_001)
    density = np.stack([np.interp(fine, NODES, one) for one in COLORS])
    return trapezoid(density * value(fine), fine, axis=1)


def dispersive(abbe=ABBE, **sockets):
    return material(Glass(ior=Constant(IOR), dispersion=Constant(1.0 / abbe), **sockets))


def looking(degrees):
    angle = np.radians(degrees)
    return np.array([np.sin(angle), 0.0, -np.cos(angle)])


def single(glass, degrees=50.0):
    forward = looking(degrees)
    camera = orthographic(2, 2, 0.01, -5.0 * forward + [0.013, 0.007, 0.0], forward)
    return scene(floor(500.0), glass, camera, world=SKY)


def test_one_face_spreads_the_light(seed):
    """F of the mirrored sky and 1 - F of the refracted one, each at its wavelength's index."""
    up = np.array([0.0, 0.0, 1.0])
    into = looking(50.0)[:, None]

    def value(wavelength):
        index = cauchy_index(np.float64(IOR), 1.0 / ABBE, wavelength)
        ahead = np.repeat(into, index.size, axis=1)
        beyond, passed = bend(ahead, up, index)
        return passed * sky(beyond) + (1.0 - passed) * sky(mirror(ahead, up))

    expected = spectral(value)
    assert np.ptp(expected) > 0.02 * expected.mean()
    images = replicates(single(dispersive()), 12, 1024, seed=seed).mean(axis=(1, 2), keepdims=True)
    assert_mean(images, expected, 0.01)


def test_a_prism_keeps_the_wavelength_from_face_to_face(seed):
    """Light takes its colour once, at the first face.

    It bends by the same index at the second. Two scatterings at most: what the second face mirrors meets the first from
    below and ends there.
    """
    up, tilt = np.array([0.0, 0.0, 1.0]), np.radians(12.0)
    out = np.array([np.sin(tilt), 0.0, np.cos(tilt)])  # the second face's normal, against the light that comes to it
    far = 50.0
    second = quad((-far, far, -20.0 + far * np.tan(tilt)), (2 * far, 0, -2 * far * np.tan(tilt)), (0, -2 * far, 0))
    forward = looking(20.0)
    camera = orthographic(2, 2, 0.01, -5.0 * forward + [0.013, 0.007, 0.0], forward)
    parts = [floor(500.0), second]
    prism = scene(parts, dispersive(10.0), camera, world=SKY, bounces=1)

    def value(wavelength):
        index = cauchy_index(np.float64(IOR), 0.1, wavelength)
        ahead = np.repeat(forward[:, None], index.size, axis=1)
        inside, first = bend(ahead, up, index)
        beyond, passed = bend(inside, out, 1.0 / index)
        return first * passed * sky(beyond) + (1.0 - first) * sky(mirror(ahead, up))

    expected = spectral(value)
    assert np.ptp(expected) > 0.02 * expected.mean()
    images = replicates(prism, 12, 2048, seed=seed).mean(axis=(1, 2), keepdims=True)
    assert_mean(images, expected, 0.01)


@pytest.mark.slow
def test_rough_faces_spread_light_about_the_same_mean(seed):
    """Hardly rough facets: the smooth face's colours."""
    rough, smooth = (single(dispersive(roughness=Constant(r), distribution="GGX")) for r in (0.02, 0.0))
    expected = replicates(smooth, 12, 4096, seed=seed).mean(axis=(0, 1, 2))
    images = replicates(rough, 12, 1024, seed=seed + 1).mean(axis=(1, 2), keepdims=True)
    assert_mean(images, expected, 0.02)


def test_light_that_meets_no_dispersion_carries_no_noise_of_it(seed):
    """A wavelength is drawn for every path, but colours only what dispersive glass shows."""
    parts = [floor(1.0), floor(1.0, -500.0, 1)]
    camera = orthographic(2, 2, 0.5, (0.0, 0.0, 5.0))
    both = scene(parts, [material(Diffuse(color(0.5))), dispersive()], camera, world=1.0)
    image = ReferenceRenderer(both, Options(threads=1, seed=seed)).render(0, 4).radiance
    np.testing.assert_allclose(image, 0.5, rtol=1e-12)


@pytest.mark.parametrize("tint", [(1.0, 0.0, 0.0), pytest.param((0.2, 0.9, 0.4), marks=pytest.mark.slow)])
def test_roulette_spares_colours_that_are_negative(tint, seed):
    """Tinted glass under one sky: the colour as without dispersion, however long paths grow."""
    plate = [floor(500.0), quad((-500.0, 500.0, -0.1), (1000.0, 0.0, 0.0), (0.0, -1000.0, 0.0))]
    forward = looking(70.0)
    camera = orthographic(2, 2, 0.01, -5.0 * forward + [0.013, 0.007, 0.0], forward)
    images = [
        replicates(scene(plate, material(one), camera, world=1.0, bounces=20), 12, 1024, seed=seed + k).mean(
            axis=(1, 2)
        )
        for k, one in enumerate(Glass(color(*tint), Constant(IOR), dispersion=Constant(d)) for d in (1e-6, 0.0))
    ]
    assert_mean(images[0][:, None, None], images[1].mean(axis=0), 0.01)


@pytest.mark.slow
def test_lost_light_is_given_back_at_each_wavelength():
    """Multiscatter GGX, white, from outside.

    1 / E of the index at the wavelength, E by quadrature over visible normals.
    """
    wavelength = np.array([400.0, 460.0, 520.0, 590.0, 660.0, 750.0])
    cos, alpha = np.repeat([0.1, 0.4, 0.9], 6), np.full(18, 0.5)
    wo = np.stack([np.sqrt(1.0 - cos * cos), np.zeros_like(cos), cos])
    points = SimpleNamespace(backfacing=np.zeros(18, bool), size=18, wavelength=np.tile(wavelength, 3))
    glass = Glass(ior=Constant(IOR), dispersion=Constant(1.0 / 20.0))
    site = SimpleNamespace(points=points, wo=wo, options=Options(), tables=None)
    factor = _glass_scattering(glass, site, alpha, np.ones((3, 1)))
    index = cauchy_index(np.float64(IOR), 1.0 / 20.0, points.wavelength)
    expected = 1.0 / np.concatenate(
        [integrate_glass(*(np.array([x]) for x in (c, 0.5)), n) for c, n in zip(cos, index, strict=True)]
    )
    assert np.ptp(expected[:6]) > 3e-3
    np.testing.assert_allclose(factor, np.tile(expected, (3, 1)), rtol=1e-4)
