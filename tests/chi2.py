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
    """The upper hemisphere by its tangents.

    They are (alpha_x r cos(2 pi q), alpha_y r sin(2 pi q)), r = p / (1 - p).
    """

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
    """The mirror images of one `wo`, (3,), in the normals of another chart.

    That chart covers the upper hemisphere.
    """

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

    Gauss-Legendre in cells that are quartered, each until it no longer moves by more than `tolerance` of the total (or of 0.01,
    where there is less): a horizon that crosses the chart is followed as far as it matters.
    """
    node, weight = np.polynomial.legendre.leggauss(5)
    node = 0.5 + 0.5 * node
    inside = [grid.ravel() for grid in np.meshgrid(node, node, indexing="ij")]
    weights = 0.25 * np.outer(weight, weight).ravel()

    def values(corner: np.ndarray, size: np.ndarray) -> np.ndarray:
        found = np.empty(corner.shape[1])
        for first in range(0, corner.shape[1], 4096):
            part = slice(first, first + 4096)
            p, q = ((c[part, None] + x * w[part, None]).ravel() for c, x, w in zip(corner, inside, size, strict=True))
            cells = (density(chart.directions(p, q)) * chart.solid_angle(p, q)).reshape(-1, weights.size)
            found[part] = cells @ weights * size[:, part].prod(axis=0)
        return found

    # The last bins of p are cut finely from the start: at the chart's rim, where normals lie down, a horizon can hide from both looks.
    edges = np.append(np.arange(bins[0]) / bins[0], 1.0 - 0.25 ** np.arange(1, 7) / bins[0])
    wide = np.append(np.diff(edges), 1.0 - edges[-1])
    corner, size = (
        np.stack([grid.ravel() for grid in np.meshgrid(along, across, indexing="ij")])
        for along, across in ((edges, np.arange(bins[1]) / bins[1]), (wide, np.full(bins[1], 1.0 / bins[1])))
    )
    owner = np.repeat(np.minimum(np.arange(edges.size), bins[0] - 1), bins[1]) * bins[1]
    owner += np.tile(np.arange(bins[1]), edges.size)
    coarse = values(corner, size)
    total = np.zeros(bins[0] * bins[1])
    scale = max(np.abs(coarse).sum(), 0.01)
    for _ in range(12):
        size = np.repeat(0.5 * size, 4, axis=1)
        corner = np.repeat(corner, 4, axis=1)
        corner += size * np.tile([[0, 0, 1, 1], [0, 1, 0, 1]], owner.size)
        fine = values(corner, size).reshape(-1, 4)
        settled = np.abs(fine.sum(axis=1) - coarse) <= tolerance * scale
        np.add.at(total, owner[settled], fine[settled].sum(axis=1))
        open_ = np.repeat(~settled, 4)
        corner, size, owner, coarse = corner[:, open_], size[:, open_], np.repeat(owner, 4)[open_], fine.ravel()[open_]
        if not owner.size:
            return total.reshape(bins)
    raise AssertionError(f"the quadrature has not settled in {owner.size} cells")


@dataclass(frozen=True)
class Result:
    """The statistic, its degrees of freedom, and its p-value.

    The p-value is the probability of a statistic at least as large if the density is right.
    """

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
    """Compare `samples`, (3, n) directions, with `density`.

    `density` is a function of (3, k) directions per steradian.

    Cells that expect fewer than `least_expected` are pooled, the smallest first. A density whose integral exceeds 1
    by more than the quadrature can err is refuted without a sample.
    """
    count = samples.shape[1]
    p, q = chart.coordinates(samples)
    known = np.isfinite(p) & np.isfinite(q)
    observed, _, _ = np.histogram2d(p[known], q[known], bins=bins, range=((0.0, 1.0), (0.0, 1.0)))
    expected = count * integrals(density, chart, bins, tolerance)
    if expected.sum() > count * (1.0 + 1e-4 + 100.0 * tolerance):
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
    if expected[0] <= 0.0:  # nothing is expected there: one sample refutes, none says nothing
        if observed[0] > 0:
            return Result(float("inf"), expected.size, 0.0)
        observed, expected = observed[1:], expected[1:]
    statistic = float(((observed - expected) ** 2 / expected).sum())
    if expected.size == 1:
        return Result(statistic, 0, 1.0)
    return Result(statistic, expected.size - 1, float(chi2.sf(statistic, expected.size - 1)))


def sidak(level: float, tests: int) -> float:
    """The level of each of `tests` independent tests that together have `level`."""
    return -float(np.expm1(np.log1p(-level) / tests))
