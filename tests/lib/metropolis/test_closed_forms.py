# SPDX-License-Identifier: GPL-3.0-or-later
"""Metropolis light transport against closed forms and path tracing.

Errors are those of its replicates.
"""

import numpy as np
import pytest
from etalon.lib.errors import EtalonError, Refused
from etalon.lib.metropolis import render as metropolis_render
from etalon.lib.metropolis.chains import ChainUniforms
from etalon.lib.metropolis.render import MetropolisRenderer
from etalon.lib.rendering.replicates import render_film
from etalon.lib.scene.lights import PointLight
from etalon.lib.scene.materials import Diffuse, Emission, Material
from etalon.lib.settings.reference import Options, RenderOptions
from etalon.tests.lib.light_tracing.traced import MATERIALS, ball_on_floor
from etalon.tests.lib.wavefront.test_direct_light import lit, over_pixels
from etalon.tests.replicates import assert_mean, assert_same, blocks, replicates
from etalon.tests.scenes import color, cube, material, perspective, scene


def box():
    """A closed box whose walls shine and reflect, and the sum of its geometric series."""
    walls = material(Diffuse(color(0.6)), Emission(color(2.0)))
    the_scene = scene(cube(1.0), walls, perspective(4, 4, 0.8, (0.03, -0.9, 0.1), (0.1, 1.0, -0.2)), bounces=2)
    return the_scene, 2.0 * sum(0.6**k for k in range(4))


def assert_lamp(seed):
    """I cos / D^2 of a lamp over a floor, pixel by pixel."""
    light = PointLight("point", (0.3, 0.2, 0.8), (1.0, 1.0, 1.0))
    exact = over_pixels(lambda x, y: 0.8 / ((x - 0.3) ** 2 + (y - 0.2) ** 2 + 0.64) ** 1.5)
    assert_mean(replicates(lit([light]), 8, 2048, MetropolisRenderer, seed=seed), exact, 0.05)


def test_a_lamp_over_a_floor(seed):
    assert_lamp(seed)


def test_large_steps_that_are_not_counted_among_independent_samples_are_seen(monkeypatch, seed):
    monkeypatch.setattr(metropolis_render, "LARGE", 0.0)
    with pytest.raises(AssertionError, match="difference"):
        assert_lamp(seed)


@pytest.mark.slow
def test_chains_of_one_mutation_are_unbiased(seed):
    """The start is picked by brightness among the samples of the normalisation itself."""
    the_scene, exact = box()
    images = replicates(the_scene, 100, 8, MetropolisRenderer, seed=seed)
    assert_mean(blocks(images, 4), exact, 0.02)


def assert_starts_are_unbiased(monkeypatch, seed):
    """Chains of few steps give I cos / D^2, where samples to start at come in many small blocks."""
    monkeypatch.setattr(metropolis_render, "BLOCK", 4)
    light = PointLight("point", (0.3, 0.2, 0.4), (1.0, 1.0, 1.0))
    exact = over_pixels(lambda x, y: 0.4 / ((x - 0.3) ** 2 + (y - 0.2) ** 2 + 0.16) ** 1.5)
    assert_mean(replicates(lit([light]), 200, 2, MetropolisRenderer, seed=seed), exact, 0.2)


@pytest.mark.slow
def test_starts_from_many_blocks_are_unbiased(monkeypatch, seed):
    assert_starts_are_unbiased(monkeypatch, seed)


@pytest.mark.slow
def test_starts_that_do_not_follow_the_brightness_are_seen(monkeypatch, seed):
    resample = metropolis_render._resample
    monkeypatch.setattr(metropolis_render, "_resample", lambda w, u, n: resample(np.ones_like(w), u, n))
    with pytest.raises(AssertionError, match="difference"):
        assert_starts_are_unbiased(monkeypatch, seed)


def assert_agree(seed):
    """Path tracing and Metropolis have the same mean in every block of a scene with a caustic."""
    the_scene = ball_on_floor(MATERIALS["smooth_glass"], bounces=2)
    images = replicates(the_scene, 6, 256, MetropolisRenderer, seed=seed)
    assert_same(blocks(replicates(the_scene, 6, 64, seed=seed + 1), 5), blocks(images, 5), 0.05)


@pytest.mark.slow
def test_it_gives_the_image_of_path_tracing(seed):
    assert_agree(seed)


@pytest.mark.slow
def test_chains_alone_give_the_image_of_path_tracing(monkeypatch, seed):
    monkeypatch.setattr(MetropolisRenderer, "_level", 0.0)
    assert_agree(seed)


@pytest.mark.slow
def test_chains_that_accept_every_proposal_are_seen(monkeypatch, seed):
    monkeypatch.setattr(MetropolisRenderer, "_level", 0.0)  # chains alone: independent samples hide a part of the error
    accept = ChainUniforms.accept
    monkeypatch.setattr(ChainUniforms, "accept", lambda self, accepted: accept(self, np.ones_like(accepted)))
    with pytest.raises(AssertionError, match="difference"):
        assert_agree(seed)


def test_small_steps_are_symmetric(seed):
    """Forward and back are as likely, across the ends too.

    The mean of the step is 0, and uniform numbers stay uniform.
    """
    chains = ChainUniforms(np.random.default_rng(seed), 20000, 1, 1)
    chain = np.arange(20000)
    chains.pair(0, chain, chain)
    before = chains._state[0].copy()
    chains._large = np.zeros(20000, bool)
    after = chains._mutated(before)
    step = np.mod(after - before + 0.5, 1.0) - 0.5
    assert np.abs(step).max() <= 1.0 / 8.0 + 1e-12
    assert abs(step.mean()) < 5.0 * step.std() / np.sqrt(step.size)
    counts = np.histogram(after, 64, (0.0, 1.0))[0]
    assert ((counts - step.size / 64) ** 2).sum() / (step.size / 64) < 63 + 5 * np.sqrt(126)


def test_the_image_does_not_depend_on_the_number_of_threads(monkeypatch, seed):
    """Groups have random numbers of their own."""
    monkeypatch.setattr(metropolis_render, "GROUP_PATHS", 4096)
    monkeypatch.setattr(metropolis_render, "BLOCK", 500)
    the_scene = ball_on_floor(MATERIALS["glossy"])
    one, two = (replicates(the_scene, 1, 100, MetropolisRenderer, seed=seed, threads=k) for k in (1, 2))
    np.testing.assert_array_equal(one, two)


def test_unsupported_materials_are_refused_by_name():
    with pytest.raises(Refused, match="material 'Hair': a node is not simulated"):
        MetropolisRenderer(ball_on_floor(Material("Hair", (), "a node")), Options())


def test_a_sampler_is_refused_with_the_remedy():
    with pytest.raises(EtalonError, match="sampler 'random': Metropolis has a sampler of its own; leave --sampler out"):
        MetropolisRenderer(ball_on_floor(MATERIALS["glossy"]), Options(sampler="random"))


def test_the_strategy_renders_by_metropolis():
    the_scene = ball_on_floor(MATERIALS["glossy"])
    film = render_film(the_scene, RenderOptions(strategy="metropolis", samples=4, replicates=2, threads=1))
    expected = [MetropolisRenderer(the_scene, Options(threads=1)).render(k, 4).radiance for k in range(2)]
    np.testing.assert_allclose(film.moments.mean, np.mean(expected, axis=0), rtol=1e-12)
