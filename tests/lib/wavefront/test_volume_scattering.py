# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes that scatter, against closed forms.

They are furnaces, single scattering by quadrature, half-spaces by Chandrasekhar's H, and limits of bounces.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.errors import Refused
from etalon.lib.film.light_passes import LightPass
from etalon.lib.scattering.henyey_greenstein import evaluate
from etalon.lib.scene.lights import AreaLight, PointLight, SphereLight, SunLight
from etalon.lib.scene.links import Links
from etalon.lib.scene.materials import Material
from etalon.lib.scene.rays import DIFFUSE
from etalon.lib.scene.scene import Transport
from etalon.lib.scene.volumes import Phase, Volume
from etalon.lib.scene.world import World
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.visibility import transmittance
from etalon.tests.replicates import assert_mean, assert_same, replicates
from etalon.tests.scenes import color, cube, diffuse, floor, orthographic, perspective, scene
from scipy.integrate import quad
from scipy.special import expn

ABOVE = orthographic(1, 1, 0.5, (0.03, 0.02, 10.0))
ABSORBED, SCATTERED = np.array([0.1, 0.0, 0.4]), np.array([0.3, 0.8, 1.6])
EXTINCT = ABSORBED + SCATTERED


def smoke(absorption=(0.0,) * 3, scattering=(1.0,) * 3, g=0.0, **more):
    return Volume(tuple(absorption), (Phase(tuple(scattering), g),), **more)


def bounds(volume):
    return Material("bounds", (), volume=volume, only_bounds=True)


def wide(part, factor):
    return replace(part, vertices=part.vertices * np.array([[factor], [factor], [1.0]]))


@pytest.mark.slow
@pytest.mark.parametrize(
    "phases",
    [(0.0,), (0.8,), (-0.5, 0.9)],
)
def test_a_white_furnace(phases, seed):
    """Nothing is absorbed.

    A cube is invisible, in whatever colours and directions it scatters.
    """
    coefficients = ((0.5, 1.0, 2.0), (0.5, 0.2, 0.1))
    volume = Volume(phases=tuple(map(Phase, coefficients, phases)))
    furnace = scene(cube(), bounds(volume), ABOVE, world=1.0, bounces=200)
    assert_mean(replicates(furnace, 12, 256, seed=seed), 1.0, 0.02)


def test_emission_that_is_absorbed_again(seed):
    """(1 - exp(-2 sigma)) / sigma, and 2 m of it where nothing is absorbed."""
    glow, sigma = np.array([0.5, 1.0, 2.0]), np.array([0.0, 0.3, 4.0])
    shown = glow * np.array([2.0, *(-np.expm1(-2.0 * sigma[1:]) / sigma[1:])])
    box = scene(cube(), bounds(Volume(tuple(sigma), emission=tuple(glow))), ABOVE)
    np.testing.assert_allclose(replicates(box, 1, 4, seed=seed)[0, 0, 0], shown, rtol=1e-5)
    with pytest.raises(Refused, match="emits light and absorbs none"):
        ReferenceRenderer(replace(box, world=World(color(0.0), volume=Volume(emission=(1.0,) * 3))), Options())


@pytest.mark.grid(3)
@pytest.mark.parametrize("g", [0.0, 0.7, -0.4])
@pytest.mark.parametrize(("beside", "end"), [(0.05, 6.0), (1.0, 6.0), (1.0, np.inf)])
def test_a_lamp_in_fog(g, beside, end, seed):
    """Light that is scattered once.

    It is the integral along a ray that passes a point light and ends on a black floor, or nowhere.
    """
    lamp = PointLight("lamp", (beside, 0.0, 2.0), (3.0, 3.0, 3.0))
    camera = orthographic(1, 1, 1e-4, (0.0, 0.0, 6.0))
    fog = World(color(0.0), volume=smoke(ABSORBED, SCATTERED, g))
    ground = floor(5.0) if np.isfinite(end) else floor(1.0, 9.0)
    foggy = scene(ground, diffuse(0.0), camera, [lamp], fog)

    def along(t, sigma):
        height = 6.0 - t - 2.0
        square = beside**2 + height**2
        cosine = height / np.sqrt(square)  # of the ray, which flies down, with the way to the lamp
        return evaluate(np.array([cosine]), g)[0] * 3.0 / square * np.exp(-sigma * (t + np.sqrt(square)))

    exact = [
        s * quad(along, 0.0, min(end, 200.0), (e,), points=[4.0], limit=200)[0]
        for s, e in zip(SCATTERED, EXTINCT, strict=True)
    ]
    assert_mean(replicates(foggy, 12, 512, seed=seed), exact, 0.01, rounding=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("g", [0.0, 0.6])
def test_all_ways_of_finding_a_lamp_in_smoke_agree(g, seed):
    """A broad lamp and a ball of light over a cube of smoke on a floor, with two bounces."""
    lamp = AreaLight("a", (0, 0, 3.0), (6.0, 0, 0), (0, -6.0, 0), (0, 0, -1.0), "RECTANGLE", (1.0,) * 3, np.pi)
    ball = SphereLight("b", (2.0, 0.0, 1.0), 1.0, (2.0, 1.0, 0.5))
    camera = perspective(1, 1, 0.3, (0.5, -4.0, 2.0), (-0.1, 1.0, -0.4))
    box = cube(0.8, (0.0, 0.0, 0.9))
    smoky = scene(
        [floor(5.0, 0.0, 1), box],
        [bounds(smoke(ABSORBED, SCATTERED, g)), diffuse(0.5)],
        camera,
        [lamp, ball],
        bounces=2,
    )
    images = {way: replicates(smoky, 11, 192, direct=way, seed=seed) for way in ("mis", "lights", "bsdf")}
    assert_same(images["mis"], images["lights"], 0.05)
    assert_same(images["mis"], images["bsdf"], 0.05)


@pytest.mark.parametrize("bounces", [(0, 1024), (5, 0)], ids=["of the path", "in volumes"])
def test_scattered_once_by_either_limit(bounces, seed):
    """An infinite slab of depth tau under a white sky.

    exp(-tau) + albedo / 2 times integrals of the exponential integral E2.
    """
    tau, albedo = 1.2, 0.8
    layer = wide(cube(0.5), 400.0)
    volume = smoke(((1.0 - albedo) * tau,) * 3, (albedo * tau,) * 3)
    slab = scene(layer, bounds(volume), ABOVE, world=1.0)
    once = quad(lambda t: np.exp(-t) * (expn(2, t) + expn(2, tau - t)), 0.0, tau)[0]
    images = replicates(replace(slab, transport=Transport(bounces[0], 64, bounces[1])), 12, 512, seed=seed)
    assert_mean(images, np.exp(-tau) + 0.5 * albedo * once, 0.01, rounding=1e-4)


def chandrasekhar(albedo, mu):
    """H of isotropic scattering, by its integral equation.

    See Chandrasekhar 1960, section 37, eq. 40, in the form that converges.
    """
    node, weight = np.polynomial.legendre.leggauss(60)
    node, weight = 0.5 * (node + 1.0), 0.5 * weight
    h, root = np.ones(60), np.sqrt(1.0 - albedo)
    for _ in range(400):
        h = 1.0 / (root + 0.5 * albedo * (node * h * weight / (node + node[:, None])).sum(axis=1))
    return 1.0 / (root + 0.5 * albedo * (node * h * weight / (node + mu)).sum())


@pytest.mark.slow
def test_a_half_space_reflects_by_chandrasekhars_h(seed):
    """albedo E / (4 pi) mu0 / (mu + mu0) H(mu) H(mu0) for sunlight E across its direction.

    A block of optical depth 200 for all space.
    """
    albedo, mu, mu0 = np.array([0.5, 0.7, 0.9]), 0.8, 0.6
    block = replace(cube(1.0, (0.0, 0.0, -1.0)), vertices=cube(1.0, (0.0, 0.0, -1.0)).vertices * [[3.0], [3.0], [1.0]])
    volume = smoke(100.0 * (1.0 - albedo), 100.0 * albedo)
    sun = SunLight("sun", (np.sqrt(1.0 - mu0**2), 0.0, mu0), 0.0, (1.0,) * 3)
    forward = np.array([np.sqrt(1.0 - mu**2), 0.0, -mu])
    camera = orthographic(1, 1, 0.1, -5.0 * forward, forward)
    dense = scene(block, bounds(volume), camera, [sun], bounces=100)
    exact = [a / (4.0 * np.pi) * mu0 / (mu + mu0) * chandrasekhar(a, mu) * chandrasekhar(a, mu0) for a in albedo]
    images = replicates(dense, 8, 128, seed=seed, russian_roulette=True)
    assert_mean(images, exact, 0.04, rounding=1e-3)


def test_light_passes_add_up(seed):
    """Light that a volume scatters first is its own, direct once and indirect after more."""
    lamp = PointLight("lamp", (0.5, 0.5, 3.0), (3.0,) * 3)
    volume = smoke(ABSORBED, SCATTERED, emission=(0.1, 0.0, 0.0))
    boxed = scene([cube(), floor(3.0, -1.5, 1)], [bounds(volume), diffuse(0.7)], ABOVE, [lamp], bounces=2)
    rendering = ReferenceRenderer(boxed, Options(threads=1, seed=seed), passes=tuple(LightPass)).render(0, 256)
    np.testing.assert_allclose(sum(rendering.passes.values()), rendering.radiance, rtol=1e-9)
    for name in ("volume direct", "volume indirect", "diffuse direct", "diffuse indirect", "emission"):
        assert rendering.passes[LightPass(name)].any(), name
    once = replace(boxed, transport=Transport(0), materials=(boxed.materials[0], diffuse(0.0)))
    alone = ReferenceRenderer(once, Options(threads=1, seed=seed), passes=tuple(LightPass)).render(0, 256)
    assert not any(
        alone.passes[LightPass(name)].any() for name in ("volume indirect", "diffuse direct", "diffuse indirect")
    )


def test_masks_and_links_beside_scattering_are_refused():
    """They would have to know rays that volumes scatter."""
    lamp = PointLight("lamp", (0.0, 0.0, 3.0), (1.0,) * 3)
    box = scene(cube(), bounds(smoke()), ABOVE, [lamp])
    for changed, what in (
        (replace(box, lights=(replace(lamp, rays=DIFFUSE),)), "ray visibility"),
        (replace(box, lights=(replace(lamp, links=Links(receivers=2)),)), "light linking"),
    ):
        with pytest.raises(Refused, match=f"the scene: {what} beside the volume of 'bounds', which scatters"):
            ReferenceRenderer(changed, Options())


def test_a_way_of_less_than_nothing_loses_no_light():
    """An emissive face that is seen edge-on.

    The shadow ray to it is shortened at both ends by what single precision resolves there.
    """
    kernel = ReferenceRenderer(
        scene(floor(), diffuse(0.5), ABOVE, world=World(color(1.0), volume=smoke()), bounces=1), Options()
    ).kernel
    origin, direction = np.array([[0.0], [0.0], [1.0]]), np.array([[0.6], [0.0], [0.8]])
    for way, left in ((-1e6, 1.0), (0.5, np.exp(-0.5))):
        through, _ = transmittance(kernel, True, origin, direction, np.array([way]), medium=np.zeros(1, np.intp))
        np.testing.assert_allclose(through, left)
