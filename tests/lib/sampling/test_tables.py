# SPDX-License-Identifier: GPL-3.0-or-later
"""Piecewise-constant distributions."""

import numpy as np
import pytest
from etalon.lib.sampling.tables import Distribution1D, Distribution2D, Rows

WEIGHTS = {
    "one": lambda rng: np.array([3.0]),
    "few": lambda rng: np.array([0.0, 1.0, 0.0, 2.0, 5.0, 0.0]),
    "many": lambda rng: rng.random(1000),
    "wide": lambda rng: np.exp(12.0 * rng.standard_normal(777)),
    "hot": lambda rng: np.where(np.arange(4096) == 1234, 1e6, 1e-3),
    "huge": lambda rng: np.full(5, 1e308),
    "tiny": lambda rng: np.full(5, 1e-308),
    "zero": lambda rng: np.zeros(7),
}


@pytest.fixture(params=WEIGHTS)
def weights(request, rng):
    return WEIGHTS[request.param](rng)


def test_index_is_the_inverse_of_the_cumulated_weights(weights, rng):
    """Against numpy's own binary search."""
    table = Distribution1D(weights)
    assert table.probability.sum() == pytest.approx(1.0, rel=1e-12)
    u = np.append(rng.random(5000), [0.0, 2.0**-53, np.nextafter(1.0, 0.0)])
    given = u.copy()
    index, rest = table.sample(u)
    assert np.array_equal(table.index(u), index)
    assert np.array_equal(u, given)
    assert np.all((rest >= 0.0) & (rest < 1.0))
    assert np.all(table.probability[index] > 0.0), "what has no weight is never chosen"
    upper = np.cumsum(table.probability)
    lower = np.append(0.0, upper[:-1])
    assert np.all((lower[index] - 1e-12 <= u) & (u <= upper[index] + 1e-12))
    np.testing.assert_allclose(lower[index] + rest * table.probability[index], u, atol=1e-12)


def test_each_row_is_the_inverse_of_its_own_weights(rng):
    """More rows than the guide is made for at a time, at uniforms that are edges of its buckets too."""
    weights = rng.random((3000, 40)) ** 8
    weights[::7, 5:20] = 0.0
    weights[1::7, -1] = 0.0
    rows = Rows(weights)
    row = rng.integers(0, 3000, 20000)
    u = np.where(rng.random(20000) < 0.3, rng.integers(0, 256, 20000) / 256, rng.random(20000))
    scaled = weights / weights.max(axis=1, keepdims=True)
    upper = np.cumsum(scaled, axis=1)
    upper /= upper[:, -1:]
    wanted = [np.searchsorted(upper[k], one, side="right") for k, one in zip(row, u, strict=True)]
    np.testing.assert_array_equal(rows.sample(row, u)[0], wanted)


def test_probability_is_proportional_to_the_weights(rng):
    weights = rng.random(50)
    np.testing.assert_allclose(Distribution1D(weights).probability, weights / weights.sum(), rtol=1e-12)
    weights = rng.random((20, 30))
    np.testing.assert_allclose(Distribution2D(weights).probability, weights / weights.sum(), rtol=1e-12)


def test_cells_are_as_frequent_as_their_weights(rng):
    """A stratified grid of uniforms lands in each cell in proportion.

    It does so to the grid's own resolution.
    """
    weights = rng.random((5, 7))
    weights[2] = 0.0
    weights[1, 3] = 0.0
    table = Distribution2D(weights)
    side = (np.arange(700) + 0.5) / 700
    u1, u2 = (grid.ravel() for grid in np.meshgrid(side, side))
    row, column, down, along = table.sample(u1, u2)
    share = np.bincount(row * 7 + column, minlength=35).reshape(5, 7) / u1.size
    np.testing.assert_allclose(share, weights / weights.sum(), atol=1e-3)
    assert np.all(share[weights == 0.0] == 0.0)
    for rest in (down, along):
        assert np.all((rest >= 0.0) & (rest < 1.0))
        assert rest.mean() == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (64, 128)])
def test_one_hot_cell_is_found(shape):
    weights = np.full(shape, 1e-9)
    weights[-1, -1] = 1.0
    row, column, _, _ = Distribution2D(weights).sample(np.array([0.5]), np.array([0.5]))
    assert (row[0], column[0]) == (shape[0] - 1, shape[1] - 1)


@pytest.mark.parametrize("weights", [[], [-1.0, 2.0], [np.nan], [np.inf, 1.0]])
def test_weights_out_of_their_domain(weights):
    with pytest.raises(ValueError, match="finite, not negative"):
        Distribution1D(np.array(weights))
