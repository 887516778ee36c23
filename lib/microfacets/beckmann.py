# SPDX-License-Identifier: GPL-3.0-or-later
"""Beckmann's distribution, isotropic and anisotropic.

alpha_x, alpha_y in (0, 1], () or (n,): the documents' sigma, Blender's roughness squared (sqrt(2) times the rms slope).
Uniforms in [0, 1].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import erfc, ndtri

from ..sampling.tables import LARGEST_UNIFORM
from ..sampling.warps import circle
from .directions import FLOOR, above_horizon, normal_from_tangents, stretched_sine_squared
from .distribution import Alpha, Distribution
from .masking import HIDDEN
from .visible_slope import visible_tangent

_SQRT_PI = float(np.sqrt(np.pi))
_RATIONAL_END = 0.39**-0.5
# 1 - 1.259 a + 0.396 a^2 = 0.396 ((a - middle)^2 - gap): as printed it cancels where it all but vanishes, at a near 1.6.
_RATIONAL_MIDDLE = 1.5896464646464648
_RATIONAL_GAP = 0.0017233573104785227


@dataclass(frozen=True)
class Beckmann(Distribution):
    """Beckmann's distribution: Gaussian slopes."""

    def density(self, m: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
        """Beckmann's D(m), sr^-1, (n,).

        D = exp(-(m.x^2/alpha_x^2 + m.y^2/alpha_y^2) / m.z^2) / (pi alpha_x alpha_y m.z^4).
        Walter et al. 2007, eq. 25; the documents' sampling slide (the model slide's 2 sigma^2 integrates to 2). `m`
        (3, n) unit, or of any length l, which gives D / l^4; zero where m.z <= 0.
        """
        z2 = np.square(np.maximum(m[2], FLOOR))
        d = np.exp(-(np.square(m[0] / alpha_x) + np.square(m[1] / alpha_y)) / z2) / (
            np.square(z2) * (np.pi * (alpha_x * alpha_y))
        )
        return above_horizon(m, d, 0.0)

    def smith_lambda(self, w: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
        """Smith's exact Lambda(w) = exp(-a^2) / (2 a sqrt(pi)) - erfc(a) / 2, (n,).

        a = w.z / |(alpha_x w.x, alpha_y w.y)|; Heitz 2014, eq. 66.
        `w` (3, n) unit; HIDDEN where w.z <= 0.
        """
        a = _slope_ratio(w, alpha_x, alpha_y)
        value = 0.5 * (np.exp(-a * a) / (_SQRT_PI * a) - erfc(a))
        return above_horizon(w, np.maximum(value, 0.0), HIDDEN)

    def sample_d_cos(self, alpha_x: Alpha, alpha_y: Alpha, u1: np.ndarray, u2: np.ndarray) -> np.ndarray:
        """Sample a microfacet normal, (3, n), with density D(m) (m.n).

        phi = 2 pi u1, theta = atan(sqrt(-alpha^2 log(1 - u2))).
        The documents' example 2; the anisotropic lobe is the isotropic one stretched along x and y.
        """
        x, y = circle(u1)
        tangent = np.sqrt(-np.log1p(-np.minimum(u2, LARGEST_UNIFORM)))
        return normal_from_tangents(alpha_x * tangent * x, alpha_y * tangent * y)

    def sample_visible(
        self,
        wo: np.ndarray,
        alpha_x: Alpha,
        alpha_y: Alpha,
        u1: np.ndarray,
        u2: np.ndarray,
        lambda_o: np.ndarray | None = None,
    ) -> np.ndarray:
        """Microfacet normal visible from `wo`, density `densities.pdf_visible`, (3, n), z > 0.

        Stretch to roughness 1, sample the tangent along the view by the inversion of its exact distribution and the one
        across it as a Gaussian, turn and stretch back (Heitz and d'Eon 2014). `wo` (3, n) unit with wo.z > 0 (others give some
        valid normal); `lambda_o` is the exact Lambda(wo) where it is known.
        """
        if lambda_o is None:
            lambda_o = self.smith_lambda(wo, alpha_x, alpha_y)
        x = wo[0] * alpha_x + 1e-150  # at normal incidence every azimuth is as good; this one has a direction
        y = wo[1] * alpha_y
        sine = np.sqrt(x * x + y * y)
        along = visible_tangent(sine, np.clip(wo[2], FLOOR, 1.0), u1, lambda_o)
        across = np.sqrt(0.5) * ndtri(np.clip(u2, 0.5 - 0.5 * LARGEST_UNIFORM, LARGEST_UNIFORM))
        cos_phi, sin_phi = x / sine, y / sine
        return normal_from_tangents(
            alpha_x * (cos_phi * along - sin_phi * across), alpha_y * (sin_phi * along + cos_phi * across)
        )


def smith_lambda_rational(w: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
    """A rational fit to Beckmann's Lambda(w), (n,).

    (1 - 1.259 a + 0.396 a^2) / (3.535 a + 2.181 a^2) where 1 / a^2 > 0.39, else 0.
    Walter et al. 2007, eq. 27 (Heitz 2014, eq. 69) with the bound that Cycles puts in place of a < 1.6. 1 + Lambda is
    up to 0.31 % off the exact one, with a jump at the bound. `w` (3, n) unit; HIDDEN where w.z <= 0.
    """
    a = np.minimum(_slope_ratio(w, alpha_x, alpha_y), _RATIONAL_END)
    fit = 0.396 * (np.square(a - _RATIONAL_MIDDLE) - _RATIONAL_GAP) / (a * (3.535 + 2.181 * a))
    return above_horizon(w, np.where(a < _RATIONAL_END, fit, 0.0), HIDDEN)


def _slope_ratio(w: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
    """The cotangent a of w, as seen by the stretched surface.

    a = w.z / |(alpha_x w.x, alpha_y w.y)|, bounded at both ends.
    """
    sine = np.sqrt(np.maximum(stretched_sine_squared(w, alpha_x, alpha_y), FLOOR))
    return np.clip(w[2], FLOOR, 1.0) / sine
