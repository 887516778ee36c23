# SPDX-License-Identifier: GPL-3.0-or-later
"""The choice among lights."""

import numpy as np
import pytest
from etalon.lib.lights.build import light_sampler
from etalon.lib.lights.selection import LightSelection
from etalon.lib.scene.lights import PointLight


def lights(*powers):
    return [light_sampler(PointLight("point", (0.0, 0.0, 0.0), (p, p, p)), 1.0) for p in powers]


def test_choice_follows_the_power(rng):
    selection = LightSelection(lights(1.0, 0.0, 2.0, 5.0))
    u = (np.arange(80000) + 0.5) / 80000
    index, probability, rest = selection.choose(u)
    np.testing.assert_allclose(np.bincount(index, minlength=4) / 80000, np.array([1.0, 0.0, 2.0, 5.0]) / 8.0, atol=1e-4)
    np.testing.assert_allclose(probability, np.array([0.125, 0.0, 0.25, 0.625])[index])
    np.testing.assert_allclose(probability, selection.probability(index))
    for light in (0, 2, 3):
        kept = np.sort(rest[index == light])
        np.testing.assert_allclose(kept, (np.arange(kept.size) + 0.5) / kept.size, atol=1e-9)


def test_one_light_leaves_the_uniform_alone(rng):
    u = rng.random(100)
    index, probability, rest = LightSelection(lights(3.0)).choose(u)
    assert not index.any()
    assert np.all(probability == 1.0)
    assert np.array_equal(rest, u)


def test_lights_without_power_are_chosen_alike():
    index, probability, _ = LightSelection(lights(0.0, 0.0)).choose(np.array([0.1, 0.9]))
    assert index.tolist() == [0, 1]
    assert probability.tolist() == [0.5, 0.5]


def test_no_light_cannot_be_chosen():
    with pytest.raises(ValueError, match="no light"):
        LightSelection([])
