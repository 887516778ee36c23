# SPDX-License-Identifier: GPL-3.0-or-later
"""Kernels that work in place compute what the plain definition beside them says."""

import numpy as np
import pytest
from etalon.lib.microfacets import visible_slope
from etalon.lib.microfacets.beckmann import Beckmann
from etalon.lib.microfacets.inverse_tables import LEAST_UNIFORM
from etalon.lib.sampling.tables import LARGEST_UNIFORM


def arguments(rng, grazing):
    """x, s, c and what is wanted, as `visible_tangent` passes them on.

    Views go down to `grazing` cosines.
    """
    cosine = 10.0 ** rng.uniform(np.log10(grazing), 0.0, 4000)
    wo = np.stack([np.sqrt((1.0 - cosine) * (1.0 + cosine)), np.zeros(4000), cosine])
    alpha = 10.0 ** rng.uniform(-4.0, 0.0, 4000)
    u = np.clip(rng.random(4000), LEAST_UNIFORM, LARGEST_UNIFORM)
    cot = cosine / (wo[0] * alpha + 1e-150)
    s = 1.0 / (1.0 + cot)
    c = cot * s
    x, low, _ = visible_slope._bracket(s, u)
    x = np.maximum(x, np.maximum(low, visible_slope._ABOVE_END - cot))
    return x, s, c, (1.0 - u) * c * (1.0 + Beckmann().smith_lambda(wo, alpha, alpha))


@pytest.mark.parametrize("grazing", [1e-1, 1e-6])
def test_the_step_on_visible_slopes_is_its_definition(grazing, rng):
    """To the rounding of what cancels in the excess: 1e-15 of s and c over the density at x."""
    x, s, c, wanted = arguments(rng, grazing)
    defined = visible_slope.step_by_definition(x, s, c, wanted)
    found = visible_slope._step(x, s, c, wanted.copy())
    density = np.exp(-x * x) * (c + s * x)
    np.testing.assert_array_less(np.abs(found - defined), 1e-14 * (1.0 + 1.0 / density))
    assert np.abs(defined).max() > 1e-6


def test_a_slip_in_the_step_is_seen(rng):
    """A billionth more mass moves the step by far more than rounding does."""
    x, s, c, wanted = arguments(rng, 1e-1)
    defined = visible_slope.step_by_definition(x, s, c, wanted)
    found = visible_slope._step(x, s, c, wanted * (1.0 + 1e-9))
    density = np.exp(-x * x) * (c + s * x)
    assert (np.abs(found - defined) > 1e-14 * (1.0 + 1.0 / density)).any()


def test_the_step_leaves_its_arguments_but_the_last(rng):
    x, s, c, wanted = arguments(rng, 1e-2)
    kept = [a.copy() for a in (x, s, c)]
    visible_slope._step(x, s, c, wanted)
    for before, after in zip(kept, (x, s, c), strict=True):
        np.testing.assert_array_equal(before, after)
