# SPDX-License-Identifier: GPL-3.0-or-later
"""The data that a fit explains.

They are values of f |n.wi| at pairs of directions, or their means over pixels, with the noise of each.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..vectors import dot

LEAST_SHARE = 1e-3
"""Relative noise of a value does not fall below this share of that of the largest value of its colour."""

_ONE_COSINE = 1e-3


@dataclass(frozen=True)
class Observations:
    """`values` (c, n) of c colours with independent noise, and their directions.

    Directions `wi`, `wo` are (3, m) in local frames. Value j is the sum of weight times f |n.wi| over the directions
    from `first`[j] on, up to the next. Its variance is `variances` (c, n) plus that of the relative `noise`.
    `degrees` are the degrees of freedom of the variances, infinite where they are known. `anisotropic` says that the
    frames' azimuths mean something.
    """

    wi: np.ndarray
    wo: np.ndarray
    weights: np.ndarray
    first: np.ndarray
    values: np.ndarray
    variances: np.ndarray
    noise: float
    degrees: float
    anisotropic: bool
    source: str
    level: np.ndarray | None = None

    @property
    def colors(self) -> int:
        """The number of colours."""
        return self.values.shape[0]

    def collect(self, terms: np.ndarray) -> np.ndarray:
        """Sums of weight times `terms` (..., m) for each value, (..., n)."""
        if len(self.first) == len(self.weights):
            return terms * self.weights
        return np.add.reduceat(terms * self.weights, self.first, axis=-1)

    def at_level(self, level: np.ndarray) -> Observations:
        """The same observations, with relative noise taken of `level` (c, n).

        `level` takes the place of the noisy values themselves.
        """
        return replace(self, level=level)

    @cached_property
    def deviations(self) -> np.ndarray:
        """Standard error of each value, (c, n)."""
        level = np.abs(self.values if self.level is None else self.level)
        largest = np.max(np.abs(self.values), axis=1, keepdims=True)
        return np.sqrt(self.variances + np.square(self.noise * np.maximum(level, LEAST_SHARE * largest)))

    @cached_property
    def diffuse(self) -> np.ndarray:
        """What a white diffuse surface would give, (n,)."""
        return self.collect(np.maximum(self.wi[2], 0.0) / np.pi)

    @cached_property
    def cosines(self) -> np.ndarray:
        """Cosine between each direction and the half vector, (m,)."""
        return np.sqrt(np.clip(0.5 + 0.5 * dot(self.wi, self.wo), 0.0, 1.0))

    @property
    def tells_fresnel(self) -> bool:
        """Whether light meets the microfacets at more than one angle.

        A far sun and a far camera make it one angle.
        """
        return float(np.ptp(self.cosines)) > _ONE_COSINE

    @property
    def inflation(self) -> float:
        """The mean square of a residual over its estimated error where the model holds.

        It is 1, or more for few degrees of freedom.
        """
        return 1.0 if np.isinf(self.degrees) else self.degrees / (self.degrees - 2.0)

    @property
    def rise(self) -> float:
        """By what factor chi^2 rises more from its least to the truth than where errors are known.

        Of v degrees of freedom, the mean of a weight w = 1 / (estimated variance) is v / (v - 2) of the right one, and that of
        its square v^2 / ((v - 2) (v - 4)). The rise for each parameter has the mean E[w^2] / E[w] = v / (v - 4) over
        many values: values whose errors are underestimated have too much weight.
        """
        return 1.0 if np.isinf(self.degrees) else self.degrees / (self.degrees - 4.0)


def plain_observations(
    wi: np.ndarray, wo: np.ndarray, values: np.ndarray, noise: float, anisotropic: bool, source: str
) -> Observations:
    """Observations from values of f |n.wi|, (c, n), at pairs of directions (3, n).

    `noise` is their relative standard error.
    """
    count = wi.shape[1]
    return Observations(
        wi, wo, np.ones(count), np.arange(count), values, np.zeros_like(values), noise, np.inf, anisotropic, source
    )
