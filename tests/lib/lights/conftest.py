# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures of the tests of lights.

They are one light of every kind that has an extent, and two checks of sampling.
"""

import math

import numpy as np
import pytest
from etalon.lib.lights.build import light_sampler
from etalon.tests.lib.lights.examples import LIGHTS
from scipy import stats


@pytest.fixture(params=LIGHTS, ids=lambda name: name.replace(" ", "_"))
def extended(request):
    """The sampler of each light that has an extent."""
    return light_sampler(LIGHTS[request.param], 10.0)


@pytest.fixture
def assert_mean():
    """Assert that independent `values` (replicates, ...) have the mean `exact`.

    Two-sided t test, level 1e-4 over all components.
    """

    def check(values, exact):
        values = np.asarray(values).reshape(len(values), -1)
        exact = np.broadcast_to(exact, values.shape[1:]).ravel()
        error = values.std(axis=0, ddof=1) / math.sqrt(len(values))
        quantile = stats.t.ppf(1.0 - 0.5e-4 / exact.size, len(values) - 1)
        slack = 1e-9 * np.abs(exact)  # where every sample gives the same, the closed form's own rounding
        assert np.all(np.abs(values.mean(axis=0) - exact) <= quantile * error + slack), (
            values.mean(axis=0),
            exact,
            error,
        )

    return check


@pytest.fixture
def assert_directions():
    """Chi-square test, level 1e-4, that `directions` follow `pdf(direction)`.

    Of `count` samples these were in the light. Midpoints on a fine grid of the cone about `axis`: tests/chi2.py needs
    a density without an outline. The samples that missed the light are a cell of their own, so that a wrong integral
    of the density is found too.
    """

    def check(directions, count, pdf, axis, half_angle, bins=(8, 12), fine=48):
        axis = np.asarray(axis) / np.linalg.norm(axis)
        across = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
        across /= np.linalg.norm(across)
        up = np.cross(axis, across)
        top = 2.0 * math.sin(0.5 * half_angle) ** 2
        inner = 0.5 * ((directions - axis[:, None]) ** 2).sum(axis=0) / top  # 1 - cos, without cancellation
        turn = np.arctan2(up @ directions, across @ directions) / (2.0 * math.pi) % 1.0
        assert inner.max() <= 1.0, "the cone of the test is too narrow"
        observed, _, _ = np.histogram2d(inner, turn, bins, [[0.0, 1.0], [0.0, 1.0]])
        i, j = (((np.arange(count * fine) + 0.5) / (count * fine)) for count in bins)
        i, j = (grid.ravel() for grid in np.meshgrid(i * top, 2.0 * math.pi * j, indexing="ij"))
        sine = np.sqrt(i * (2.0 - i))
        grid = (1.0 - i) * axis[:, None] + sine * (np.cos(j) * across[:, None] + np.sin(j) * up[:, None])
        cell = 2.0 * math.pi * top / (bins[0] * bins[1])
        expected = pdf(grid).reshape(bins[0], fine, bins[1], fine).mean(axis=(1, 3)) * cell
        assert expected.sum() < 1.01
        observed = np.append(observed, count - directions.shape[1])
        expected = np.append(expected, max(1.0 - expected.sum(), 0.0)) * count
        # The midpoint rule misplaces the light's outline: cells that expect little are pooled, and the missing are few.
        rare = expected < 0.003 * count
        observed = np.append(observed[~rare], observed[rare].sum())
        expected = np.append(expected[~rare], max(expected[rare].sum(), 1.0))
        statistic = ((observed - expected) ** 2 / expected).sum()
        assert statistic < stats.chi2.ppf(1.0 - 1e-4, expected.size - 1), (
            statistic,
            expected.size,
            expected.sum() / count,
        )

    return check
