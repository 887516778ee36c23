# SPDX-License-Identifier: GPL-3.0-or-later
"""Photon mapping against closed forms, and the bias that it states."""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.errors import EtalonError, Refused
from etalon.lib.photon_mapping import render as photon_render
from etalon.lib.photon_mapping.render import PhotonMappingRenderer
from etalon.lib.rendering.replicates import render_film
from etalon.lib.scene.lights import PointLight
from etalon.lib.scene.materials import Diffuse, Emission, Glossy
from etalon.lib.settings.reference import Options, RenderOptions
from etalon.tests.lib.light_tracing.traced import MATERIALS, ball_on_floor
from etalon.tests.lib.wavefront.test_direct_light import lit, over_pixels
from etalon.tests.scenes import color, cube, diffuse, glossy, icosphere, material, perspective, scene

# What the radius may cost in these scenes, of the mean.
BIAS = 0.01


def photon_mapped(the_scene, count, samples, seed):
    """Means (count,) over the image of replicates; and the renderer.

    One thread and no roulette.
    """
    renderer = PhotonMappingRenderer(the_scene, Options(threads=1, russian_roulette=False, seed=seed))
    return np.array([renderer.render(k, samples).radiance.mean() for k in range(count)]), renderer


def assert_near(means, exact, bias=BIAS):
    """The mean is exact up to five standard errors, each below 1 %, and the bias."""
    error = means.std(ddof=1) / np.sqrt(len(means))
    assert error < 0.01 * exact
    assert abs(means.mean() - exact) < 5.0 * error + bias * exact


def box(bounces=2):
    """A closed box whose walls shine and reflect, and the sum of its geometric series."""
    walls = material(Diffuse(color(0.6)), Emission(color(2.0)))
    the_scene = scene(cube(1.0), walls, perspective(16, 16, 0.8, (0.03, -0.9, 0.1), (0.1, 1.0, -0.2)), bounces=bounces)
    return the_scene, 2.0 * sum(0.6**k for k in range(bounces + 2))


@pytest.mark.slow
def test_a_lamp_over_a_floor(seed):
    """I cos / D^2."""
    light = PointLight("point", (0.3, 0.2, 0.8), (1.0, 1.0, 1.0))
    exact = over_pixels(lambda x, y: 0.8 / ((x - 0.3) ** 2 + (y - 0.2) ** 2 + 0.64) ** 1.5).mean()
    means, _ = photon_mapped(lit([light]), 6, 16, seed)
    assert_near(means, exact)


def test_a_sphere_that_mirrors_half_and_scatters_half_vanishes_in_a_white_world(seed):
    """Camera paths see the world by the Dirac lobe, photons bring the other half."""
    coat = material(Diffuse(color(0.5)), Glossy("GGX", color(0.5)))
    sphere = scene(icosphere(1.5, 3, 0, True), coat, perspective(12, 12, 0.8, (0.0, 0.0, 4.0)), world=1.0)
    means, _ = photon_mapped(sphere, 4, 3, seed)
    assert_near(means, 1.0)


@pytest.mark.slow
def test_a_mirror_shows_the_photons_behind_it(seed):
    """A mirror ball in a box whose radiance is the same everywhere."""
    ball = icosphere(0.3, 2, 1, True)
    walls = material(Diffuse(color(0.2)), Emission(color(1.0)))
    camera = perspective(12, 12, 0.2, (0.03, -0.9, 0.1), (-0.03, 0.9, -0.1))
    the_scene = scene([cube(1.0), ball], [walls, glossy(0.0, 1.0, 1.0, 1.0)], camera, bounces=3)
    means, _ = photon_mapped(the_scene, 4, 6, seed)
    assert_near(means, 1.25)


@pytest.mark.slow
def test_the_stated_bias_is_what_discs_that_reach_beyond_edges_cost(monkeypatch, seed):
    """Wide discs lose light at the edges of a box; the series is known.

    What is stated is right by a third.
    """
    monkeypatch.setattr(photon_render, "NEIGHBOURS", 256)
    the_scene, exact = box()
    means, renderer = photon_mapped(the_scene, 3, 3, seed)
    found = means.mean() / exact - 1.0
    assert found < -3.0 * means.std(ddof=1) / exact
    assert renderer.bias.relative == pytest.approx(found, rel=1 / 3)


@pytest.mark.slow
def test_a_scattering_too_few_is_seen(monkeypatch, seed):
    the_scene, exact = box()
    means, _ = photon_mapped(the_scene, 3, 4, seed)
    assert_near(means, exact, 0.02)
    original = photon_render.trace_photons

    def late(*arguments):
        photons = original(*arguments)
        return replace(photons, scatterings=photons.scatterings + 1)

    monkeypatch.setattr(photon_render, "trace_photons", late)
    with pytest.raises(AssertionError):
        assert_near(photon_mapped(the_scene, 3, 2, seed)[0], exact, 0.02)


def test_the_radius_falls_as_the_law_says(seed):
    """r^2 of the last of n passes is about n^(alpha - 1) of the first."""
    radii = PhotonMappingRenderer(box()[0], Options(threads=1, seed=seed)).radii(1000)
    assert (radii[-1] / radii[0]) ** 2 == pytest.approx(1000.0 ** (-1 / 3), rel=0.12)


def test_what_it_does_not_simulate_is_refused_by_name():
    with pytest.raises(EtalonError, match="no light to send out photons; render with --strategy visible"):
        PhotonMappingRenderer(ball_on_floor(diffuse(0.5), []), Options())
    panorama = replace(ball_on_floor(diffuse(0.5)).camera, kind="EQUIRECTANGULAR")
    with pytest.raises(Refused, match="panoramic camera"):
        PhotonMappingRenderer(ball_on_floor(diffuse(0.5), camera=panorama), Options())


def test_the_film_states_radius_and_bias():
    options = RenderOptions(strategy="photon-mapping", samples=2, replicates=1, threads=1)
    (remark,) = render_film(ball_on_floor(MATERIALS["glossy"]), options).remarks
    assert remark.startswith("photon radius 0.")
    assert remark.endswith("of the mean")
