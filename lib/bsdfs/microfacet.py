# SPDX-License-Identifier: GPL-3.0-or-later
"""Microfacet reflection and the strategies that sample it.

f = D(m) G(wi, wo, m) / (4 |wi.n| |wo.n|).

Fresnel is not part of it: Blender's Glossy BSDF has none, and a coloured factor multiplies outside.
"""

from __future__ import annotations

from copy import copy

import numpy as np

from ..microfacets import masking
from ..microfacets.directions import FLOOR
from ..microfacets.distribution import BoundedDistribution, Distribution
from ..sampling.warps import cosine_hemisphere, uniform_hemisphere
from ..vectors import dot, gather
from .fresnels import part_of
from .lobe import Lobe, to_rgb


class MicrofacetReflection(Lobe):
    """One glossy lobe; alpha_x and alpha_y () or (n,).

    `strategy`: 'visible', 'bounded' (distributions that have no bound then take 'visible'), 'd_cos', 'cosine', 'uniform';
    `masking_form`: 'correlated', 'separable', 'torrance_sparrow'.
    """

    def __init__(
        self,
        wo: np.ndarray,
        alpha_x: np.ndarray,
        alpha_y: np.ndarray,
        distribution: Distribution,
        masking_form: str,
        strategy: str,
    ) -> None:
        self._wo, self._alpha = wo, (alpha_x, alpha_y)
        self._distribution, self._masking, self._strategy = distribution, masking_form, strategy
        self._bound: np.ndarray | None = None
        self._sample_normals = distribution.sample_visible
        if strategy == "bounded" and isinstance(distribution, BoundedDistribution):
            self._bound = distribution.bound(wo, alpha_x, alpha_y)
            self._sample_normals = distribution.sample_bounded
        elif strategy == "bounded":
            self._strategy = "visible"
        self._lambda_o = distribution.smith_lambda(wo, alpha_x, alpha_y)
        self._above = wo[2] > 0.0
        self._cos_o = np.maximum(wo[2], FLOOR)
        self._pdf_of_d = self._reflected_visible()
        self._asks_unit_normals = masking_form == "torrance_sparrow" or strategy == "d_cos"

    def _reflected_visible(self) -> np.ndarray | None:
        """By what D is multiplied to give the density of wi, where that depends on wo alone, (n,)."""
        if self._bound is not None:  # Eto and Tokuyoshi 2023, eq. 7
            normal = 2.0 * self._lambda_o
            normal += self._bound
            normal += 1.0
            normal *= 2.0
        elif self._strategy == "visible":  # D G1 (wo.m) / cos_o, times 1 / (4 wo.m); Heitz 2014, eq. 2 and 17
            normal = 1.0 + self._lambda_o
            normal *= 4.0
        else:
            return None
        normal *= self._cos_o
        return np.divide(1.0, normal, out=normal)

    def _shadowing(self, wi: np.ndarray, m: np.ndarray) -> np.ndarray:
        """G(wi, wo, m) in the chosen form; Smith's do not ask how long m is."""
        if self._masking == "torrance_sparrow":
            return masking.torrance_sparrow(wi, self._wo, m)
        lambda_i = self._distribution.smith_lambda(wi, *self._alpha)
        form = masking.height_correlated if self._masking == "correlated" else masking.separable
        return form(lambda_i, self._lambda_o)

    def _pdf(self, wi: np.ndarray, m: np.ndarray, d: np.ndarray) -> np.ndarray:
        """Density per steradian of wi of the chosen strategy; `m` is the half vector."""
        if self._pdf_of_d is not None:
            return d * self._pdf_of_d
        if self._strategy == "d_cos":  # the documents' pdf(m) = D cos, times the Jacobian they leave out
            return d * m[2] / (4.0 * np.abs(dot(self._wo, m)))
        if self._strategy == "cosine":
            return np.clip(wi[2], 0.0, 1.0) * (1.0 / np.pi)
        return np.full(wi.shape[1], 0.5 / np.pi)

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Value f |cos|, (3, n), and density, (n,); zero below the surface."""
        m = wi + self._wo
        np.clip(m[2], FLOOR, np.inf, out=m[2])  # lit directions have it positive
        length2 = dot(m, m)
        if self._asks_unit_normals:
            m /= np.sqrt(length2)
            d = self._distribution.density(m, *self._alpha)
        else:
            d = self._distribution.density(m, *self._alpha)
            length2 *= length2
            d *= length2
        lit = wi[2] > 0.0
        lit &= self._above
        d *= lit
        pdf = self._pdf(wi, m, d)
        if self._pdf_of_d is None:
            pdf *= lit
        d *= self._shadowing(wi, m)
        d /= self._cos_o
        d *= 0.25
        return to_rgb(d), pdf

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction, weight f |cos| / pdf, (3, n), density."""
        if self._strategy in ("cosine", "uniform"):
            wi = (cosine_hemisphere if self._strategy == "cosine" else uniform_hemisphere)(u1, u2)
            value, pdf = self.evaluate(wi)
            return wi, value / np.maximum(pdf, 1e-300), pdf
        wo, alpha = self._wo, self._alpha
        if self._strategy == "d_cos":
            m = self._distribution.sample_d_cos(*alpha, u1, u2)
        else:
            m = self._sample_normals(wo, *alpha, u1, u2, self._lambda_o)
        cos_om = dot(wo, m)
        twice = 2.0 * cos_om
        wi = m * twice
        wi -= wo
        lit = wi[2] > 0.0
        lit &= self._above
        weight = self._shadowing(wi, m)
        if self._strategy == "d_cos":
            lit &= cos_om > 0.0
            weight *= cos_om / (self._cos_o * m[2])
        elif self._bound is not None:
            weight *= 0.5 * (self._bound + 1.0) + self._lambda_o
        else:  # D cancels: G2 / G1(wo)
            weight *= 1.0 + self._lambda_o
        weight *= lit
        pdf = self._pdf(wi, m, self._distribution.density(m, *alpha))
        pdf *= lit
        return wi, to_rgb(weight), pdf

    def part(self, index: np.ndarray) -> MicrofacetReflection:
        """The same lobe at fewer points."""
        piece = copy(self)
        piece._alpha = tuple(part_of(alpha, index) for alpha in self._alpha)
        for name in ("_wo", "_lambda_o", "_above", "_cos_o", "_bound", "_pdf_of_d"):
            value = getattr(self, name)
            setattr(piece, name, None if value is None else gather(value, index))
        return piece
