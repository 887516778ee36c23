# SPDX-License-Identifier: GPL-3.0-or-later
"""Chi-square test of a sampler of directions against the density it claims.

Expected counts come from quadrature in a chart of the directions in which the density is smooth (for a microfacet lobe: its own
stretched tangents), refined until they no longer move, so that a lobe of any width is resolved. What the density does not account for
(samples outside the chart, non-finite ones, mass that is missing) is a cell of its own.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.stats import chi2


class Chart(Protocol):
    """The directions that (p, q) in the unit square stand for."""

    def directions(self, p: np.ndarray, q: np.ndarray) -> np.ndarray:
        """Unit directions (3, n)."""

    def solid_angle(self, p: np.ndarray, q: np.ndarray) -> np.ndarray:
        """Steradians per unit area of the chart, (n,)."""

    def coordinates(self, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """p and q, (n,); NaN for a direction outside the chart."""


def _azimuth(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.arctan2(y, x) / (2.0 * np.pi) % 1.0


@dataclass(frozen=True)
class Sphere:
    """All directions, by equal areas: z = 1 - 2 p."""

    def directions(self, p, q):
        z, phi = 1.0 - 2.0 * p, 2.0 * np.pi * q
        sine = 2.0 * np.sqrt(p * (1.0 - p))
        return np.stack([sine * np.cos(phi), sine * np.sin(phi), z])

    def solid_angle(self, p, q):
        return np.full(p.shape, 4.0 * np.pi)

    def coordinates(self, directions):
        return np.clip(0.5 - 0.5 * directions[2], 0.0, 1.0), _azimuth(directions[0], directions[1])


@dataclass(frozen=True)
class Tangents:
    """The upper hemisphere by its tangents (alpha_x r cos(2 pi q), alpha_y r sin(2 pi q)), r = p / (1 - p)."""

    alpha_x: float
    alpha_y: float

    def directions(self, p, q):
        r, phi = p / (1.0 - p), 2.0 * np.pi * q
        m = np.stack([self.alpha_x * r * np.cos(phi), self.alpha_y * r * np.sin(phi), np.ones_like(r)])
        return m / np.sqrt((m * m).sum(axis=0))

    def solid_angle(self, p, q):
        r = p / (1.0 - p)
        z = self.directions(p, q)[2]
        return 2.0 * np.pi * self.alpha_x * self.alpha_y * r * (z / (1.0 - p)) ** 2 * z

    def coordinates(self, directions):
        x, y, z = directions
        above = z > 0.0
        z = np.where(above, z, 1.0)
        r = np.hypot(x / (self.alpha_x * z), y / (self.alpha_y * z))
        return np.where(above, r / (1.0 + r), np.nan), _azimuth(x / self.alpha_x, y / self.alpha_y)


@dataclass(frozen=True)
class Reflections:
    """The mirror images of one `wo`, (3,), in the normals of another chart of the upper hemisphere."""

    wo: np.ndarray
    normals: Tangents

    def directions(self, p, q):
        m = self.normals.directions(p, q)
        return 2.0 * (self.wo @ m) * m - self.wo[:, None]

    def solid_angle(self, p, q):
        return 4.0 * np.abs(self.wo @ self.normals.directions(p, q)) * self.normals.solid_angle(p, q)

    def coordinates(self, directions):
        m = directions + self.wo[:, None]
        m = m / np.sqrt((m * m).sum(axis=0))
        return self.normals.coordinates(np.where(m[2] < 0.0, -m, m))


def integrals(
    density: Callable[[np.ndarray], np.ndarray], chart: Chart, bins: tuple[int, int], tolerance: float = 1e-6
) -> np.ndarray:
    """The integral of `density` (per steradian) over each of the chart's (p, q) bins.

    Gauss-Legendre in every bin, halved until no bin moves by more than `tolerance` of the total.
    """
    node, weight = np.polynomial.legendre.leggauss(5)
    previous = None
    for pieces in (1, 2, 4, 8, 16):
        at, by = [], []
        for count in bins:
            cells = count * pieces
            at.append(((np.arange(cells)[:, None] + 0.5 + 0.5 * node) / cells).ravel())
            by.append(np.tile(0.5 * weight / cells, cells))
        p, q = (grid.ravel() for grid in np.meshgrid(*at, indexing="ij"))
        value = density(chart.directions(p, q)) * chart.solid_angle(p, q) * np.outer(*by).ravel()
        total = value.reshape(bins[0], pieces * node.size, bins[1], pieces * node.size).sum(axis=(1, 3))
        if previous is not None and np.abs(total - previous).max() <= tolerance * np.abs(total).sum():
            return total
        previous = total
    raise AssertionError(f"the quadrature has not settled: a bin still moves by {np.abs(total - previous).max():.1e}")


@dataclass(frozen=True)
class Result:
    """The statistic, its degrees of freedom, and the probability of one at least as large if the density is right."""

    statistic: float
    freedom: int
    p_value: float


def chi_square(
    samples: np.ndarray,
    density: Callable[[np.ndarray], np.ndarray],
    chart: Chart,
    bins: tuple[int, int] = (16, 24),
    least_expected: float = 5.0,
    tolerance: float = 1e-6,
) -> Result:
    """Compare `samples`, (3, n) directions, with `density`, a function of (3, k) directions per steradian.

    Cells that expect fewer than `least_expected` are pooled, the smallest first. A density whose integral exceeds 1 by more than
    the quadrature can err is refuted without a sample.
    """
    count = samples.shape[1]
    p, q = chart.coordinates(samples)
    known = np.isfinite(p) & np.isfinite(q)
    observed, _, _ = np.histogram2d(p[known], q[known], bins=bins, range=((0.0, 1.0), (0.0, 1.0)))
    expected = count * integrals(density, chart, bins, tolerance)
    if expected.sum() > count * (1.0 + 1e-4):
        return Result(float("inf"), expected.size, 0.0)
    observed = np.append(observed.ravel(), count - observed.sum())
    expected = np.append(expected.ravel(), max(count - expected.sum(), 0.0))

    order = np.argsort(expected)
    observed, expected = observed[order], expected[order]
    pooled = (
        max(
            int(np.searchsorted(np.cumsum(expected), least_expected)),
            int(np.searchsorted(expected, least_expected)) - 1,
        )
        + 1
    )
    observed = np.append(observed[:pooled].sum(), observed[pooled:])
    expected = np.append(expected[:pooled].sum(), expected[pooled:])
    statistic = float(((observed - expected) ** 2 / expected).sum())
    return Result(statistic, expected.size - 1, float(chi2.sf(statistic, expected.size - 1)))


def sidak(level: float, tests: int) -> float:
    """The level of each of `tests` independent tests that together have `level`."""
    return -float(np.expm1(np.log1p(-level) / tests))
