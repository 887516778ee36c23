# SPDX-License-Identifier: GPL-3.0-or-later
"""The choice among lights."""

import hypothesis.strategies as st
import numpy as np
import pytest
from etalon.lib.lights.build import light_sampler
from etalon.lib.lights.by_place import EVEN_SHARE, chances_by_power
from etalon.lib.lights.selection import LightSelection
from etalon.lib.scene.lights import AreaLight, PointLight, SphereLight
from hypothesis import given
from hypothesis.extra.numpy import arrays

AREA = (1.0, 0.0, 0.0), (0.0, -2.0, 0.0), (0.0, 0.0, -1.0), "RECTANGLE"


def lights(*powers):
    return [light_sampler(PointLight("point", (0.0, 0.0, 0.0), (p, p, p)), 1.0) for p in powers]


def test_choice_follows_the_power_but_for_an_even_share(rng):
    selection = LightSelection(lights(1.0, 0.0, 2.0, 5.0))
    u = (np.arange(80000) + 0.5) / 80000
    index, probability = selection.choose(u)
    expected = 15.0 / 16.0 * np.array([0.125, 0.0, 0.25, 0.625]) + np.array([1.0, 0.0, 1.0, 1.0]) / 48.0
    np.testing.assert_allclose(np.bincount(index, minlength=4) / 80000, expected, atol=1e-4)
    np.testing.assert_allclose(probability, expected[index])
    np.testing.assert_allclose(probability, selection.probability(index))


def test_one_light_is_always_chosen(rng):
    index, probability = LightSelection(lights(3.0)).choose(rng.random(100))
    assert not index.any()
    assert np.all(probability == 1.0)


@pytest.mark.parametrize("kinds", ["SSS", "SPSAS", "PA", "A"])
def test_a_chosen_light_gives_its_own_sample(rng, kinds):
    """Lights are sampled in batches.

    Each point must still get what its own light alone would give it.
    """
    makers = {
        "S": lambda k: SphereLight("s", (k, 4.0, 1.0), 0.2 + 0.3 * k, (1.0, 2.0, k)),
        "P": lambda k: PointLight("p", (k, -3.0, 2.0), (3.0, k, 1.0)),
        "A": lambda k: AreaLight("a", (k, 0.0, 5.0), *AREA, (k, 1.0, 2.0), np.pi),
    }
    samplers = [light_sampler(makers[kind](float(k + 1)), 1.0) for k, kind in enumerate(kinds)]
    index, point = rng.integers(0, len(kinds), 500), rng.uniform(-1.0, 3.0, (3, 500))
    u1, u2 = rng.random((2, 500))
    together = LightSelection(samplers).sample(index, None, point, u1, u2)
    for k, sampler in enumerate(samplers):
        at = np.flatnonzero(index == k)
        alone = sampler.sample(point[:, at], u1[at], u2[at])
        for whole, part in zip(together, alone, strict=True):
            np.testing.assert_allclose(whole[..., at], part, rtol=1e-13)


@pytest.mark.parametrize("bright", [1e-300, 1.0, 1e12, 1e250])
def test_no_light_that_shines_is_seldom_chosen(bright):
    chances = chances_by_power(np.array([[bright], [1.0], [0.0], [1e-9]]))
    assert chances.sum() == pytest.approx(1.0, rel=1e-14)
    assert chances[2] == 0.0
    assert chances[[0, 1, 3]].min() >= EVEN_SHARE / 3.0


@given(arrays(float, (5, 3), elements=st.one_of(st.just(0.0), st.floats(1e-6, 1e6))))
def test_no_channel_pays_for_lights_of_other_colours(flux):
    """What a sample brings to a channel has at most as large a second moment as if each channel had its third of the samples."""
    shines = flux.any(axis=1)
    lit = flux[shines][:, flux.any(axis=0)]
    chances = chances_by_power(flux)[shines]
    moment = (np.square(lit) / chances[:, None]).sum(axis=0)
    assert np.all(moment <= (1.0 + 1e-9) * 3.0 / (1.0 - EVEN_SHARE) * np.square(lit.sum(axis=0)))


def test_a_dim_red_lamp_among_cyan_ones_is_all_of_the_red_light():
    lamps = [
        PointLight("red", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
        PointLight("cyan", (1.0, 0.0, 0.0), (0.0, 900.0, 900.0)),
    ]
    probability = LightSelection([light_sampler(lamp, 1.0) for lamp in lamps]).probability(np.arange(2))
    np.testing.assert_allclose(probability, 15.0 / 16.0 * np.array([1.0, 2.0]) / 3.0 + 1.0 / 32.0)


def test_lights_without_power_are_chosen_alike():
    index, probability = LightSelection(lights(0.0, 0.0)).choose(np.array([0.1, 0.9]))
    assert index.tolist() == [0, 1]
    assert probability.tolist() == [0.5, 0.5]


def test_no_light_cannot_be_chosen():
    with pytest.raises(ValueError, match="no light"):
        LightSelection([])
