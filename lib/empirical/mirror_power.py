# SPDX-License-Identifier: GPL-3.0-or-later
"""Phong, modified Phong and Lafortune: powers of the cosine about one direction.

The exponent follows from alpha: (h.n)^N about the half vector, N = 2 / alpha^2 - 2 as Blender has it, is about as
wide as (r.i)^n about the mirror direction with n = N / 4, since a facet that turns by an angle turns the mirror
direction by twice that angle. Isotropic: alpha = sqrt(alpha_x alpha_y). The lobes of Phong and modified Phong are
white at normal incidence.
"""

from __future__ import annotations

from abc import abstractmethod
from copy import copy
from typing import Self

import numpy as np

from ..bsdfs.ashikhmin_shirley import exponent
from ..bsdfs.fresnels import part_of
from ..bsdfs.lobe import Lobe, to_rgb
from ..sampling.tables import LARGEST_UNIFORM
from ..sampling.warps import circle
from ..vectors import dot, orthonormal_basis


class MirrorPower(Lobe):
    """A lobe (a.i)^n about an axis a, sampled by its power.

    The density is (n + 1) / (2 pi) (a.i)^n per steradian.

    `wo` (3, n); alpha_x and alpha_y () or (n,) in (0, 1]. A subclass says its axis and what the value is beside the
    density.
    """

    def __init__(self, wo: np.ndarray, alpha_x: np.ndarray, alpha_y: np.ndarray) -> None:
        self._wo, self._n = wo, 0.25 * exponent(np.sqrt(alpha_x * alpha_y))
        self._axis, self._scale = self._shape(wo, self._n)
        self._above = wo[2] > 0.0

    def _shape(self, wo: np.ndarray, n: np.ndarray) -> tuple[np.ndarray, np.ndarray | float]:
        """Return the unit axis, (3, n), and a factor on the value, () or (n,).

        By default these are the mirror direction and 1.
        """
        return np.stack([-wo[0], -wo[1], wo[2]]), 1.0

    @abstractmethod
    def _over_density(self, wi: np.ndarray) -> np.ndarray:
        """Value f |cos theta_i| over the density at `wi` (3, n) above the surface, (n,)."""

    def _density(self, cosine: np.ndarray) -> np.ndarray:
        """Density at a cosine to the axis, (n,)."""
        return (self._n + 1.0) / (2.0 * np.pi) * np.power(np.maximum(cosine, 0.0), self._n)

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Value f |cos|, (3, n), and density, (n,)."""
        pdf = np.where(self._above & (wi[2] > 0.0), self._density(dot(self._axis, wi)), 0.0)
        return to_rgb(pdf * self._over_density(wi)), pdf

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Sample a direction, and return it with its weight and density.

        phi = 2 pi u1, cos(theta) = (1 - u2)^(1 / (n + 1)) about the axis (Lafortune and Willems 1994).
        """
        log_cos = np.log1p(-np.minimum(u2, LARGEST_UNIFORM)) / (self._n + 1.0)
        sine, cosine = np.sqrt(-np.expm1(2.0 * log_cos)), np.exp(log_cos)
        x, y = circle(u1)
        t, s = orthonormal_basis(self._axis)
        wi = t * (sine * x) + s * (sine * y) + self._axis * cosine
        lit = self._above & (wi[2] > 0.0)
        return wi, to_rgb(np.where(lit, self._over_density(wi), 0.0)), np.where(lit, self._density(cosine), 0.0)

    def part(self, index: np.ndarray) -> Self:
        """The same lobe at fewer points."""
        piece = copy(self)
        piece._wo, piece._axis = (np.take(v, index, axis=1) for v in (self._wo, self._axis))
        piece._n, piece._scale, piece._above = part_of(self._n, index), part_of(self._scale, index), self._above[index]
        return piece


class Phong(MirrorPower):
    """Phong 1975, as light, without the cosine by which every surface receives light.

    f cos = (n + 1) / (2 pi) (r.i)^n.

    So f = (n + 1) / (2 pi) (r.i)^n / (i.n) is not reciprocal, and seen from the light's side it reflects without a
    bound at grazing.
    """

    def _over_density(self, wi: np.ndarray) -> np.ndarray:
        return np.ones(wi.shape[1])


class ModifiedPhong(MirrorPower):
    """Modified Phong, which is reciprocal: f = (n + 2) / (2 pi) (r.i)^n.

    Lewis 1993, "Making shaders more physically plausible"; Lafortune and Willems 1994.
    """

    def _over_density(self, wi: np.ndarray) -> np.ndarray:
        return (self._n + 2.0) / (self._n + 1.0) * np.maximum(wi[2], 0.0)


class Lafortune(MirrorPower):
    """Lafortune's model with one lobe (Lafortune et al. 1997, eq. 8).

    f = (n + 2) / (2 pi) (cx i.x o.x + cy i.y o.y + cz i.z o.z)^n.

    `coefficients` are cx, cy and cz in [-1, 1]. (-1, -1, 1) is modified Phong; a smaller cz than |cx| tilts the lobe
    towards grazing, as real surfaces do; three positive ones send light back. Reciprocal.
    """

    def __init__(
        self, wo: np.ndarray, alpha_x: np.ndarray, alpha_y: np.ndarray, coefficients: tuple[float, float, float]
    ) -> None:
        self._coefficients = coefficients
        super().__init__(wo, alpha_x, alpha_y)

    def _shape(self, wo: np.ndarray, n: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        axis = np.array(self._coefficients)[:, None] * wo
        length = np.sqrt(dot(axis, axis))
        up = np.array([[0.0], [0.0], [1.0]])
        return np.where(length > 0.0, axis / np.where(length > 0.0, length, 1.0), up), np.power(length, n)

    def _over_density(self, wi: np.ndarray) -> np.ndarray:
        return self._scale * (self._n + 2.0) / (self._n + 1.0) * np.maximum(wi[2], 0.0)
