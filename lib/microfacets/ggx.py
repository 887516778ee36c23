# SPDX-License-Identifier: GPL-3.0-or-later
"""GGX (Trowbridge-Reitz, Walter et al. 2007), isotropic and anisotropic.

alpha_x, alpha_y in (0, 1], () or (n,): the documents' sigma, Blender's roughness squared. Uniforms in [0, 1].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..sampling.tables import LARGEST_UNIFORM
from ..sampling.warps import circle
from .directions import FLOOR, above_horizon, normal_from_tangents, stretched_sine_squared
from .distribution import Alpha, BoundedDistribution
from .masking import HIDDEN


@dataclass(frozen=True)
class GGX(BoundedDistribution):
    """GGX (Trowbridge-Reitz): D falls as the fourth power of the tangent."""

    def density(self, m: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
        """The density D(m) of GGX, sr^-1, (n,).

        D = 1 / (pi alpha_x alpha_y (m.x^2/alpha_x^2 + m.y^2/alpha_y^2 + m.z^2)^2).
        Walter et al. 2007, eq. 33; Heitz 2014, eq. 85. `m` (3, n) unit, or of any length l, which gives D / l^4; zero
        where m.z <= 0. The sine comes from x and y: from the cosine alone it cancels where alpha is small.
        """
        stretched = np.square(m[0] / alpha_x) + np.square(m[1] / alpha_y) + np.square(m[2])
        d = 1.0 / (np.square(stretched) * (np.pi * (alpha_x * alpha_y)))
        return above_horizon(m, d, 0.0)

    def smith_lambda(self, w: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
        """Smith's Lambda(w) = (sqrt(1 + s) - 1) / 2, (n,).

        s = (alpha_x^2 w.x^2 + alpha_y^2 w.y^2) / w.z^2.
        Heitz 2014, eq. 72 and 86, as s / (2 (1 + sqrt(1 + s))), which does not cancel. `w` (3, n) unit; HIDDEN where
        w.z <= 0.
        """
        sine2 = stretched_sine_squared(w, alpha_x, alpha_y)
        z = np.clip(w[2], FLOOR, 1.0)
        return above_horizon(w, 0.5 * sine2 / (z * (z + np.sqrt(z * z + sine2))), HIDDEN)

    def sample_d_cos(self, alpha_x: Alpha, alpha_y: Alpha, u1: np.ndarray, u2: np.ndarray) -> np.ndarray:
        """Sample a microfacet normal, (3, n), with density D(m) (m.n).

        phi = 2 pi u1, theta = atan(alpha sqrt(u2 / (1 - u2))).
        Walter et al. 2007, eq. 35 and 36; the anisotropic lobe is the isotropic one stretched along x and y.
        """
        x, y = circle(u1)
        u2 = np.minimum(u2, LARGEST_UNIFORM)
        tangent = np.sqrt(u2 / (1.0 - u2))
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

        Dupuy and Benyoub 2023: stretch to the hemisphere, add wo to a point uniform on the spherical cap z > -wo.z, stretch
        back.
        `wo` (3, n) unit with wo.z > 0 (others give some valid normal); `lambda_o` is Lambda(wo) where it is known.
        """
        return self._sample_cap(wo, alpha_x, alpha_y, u1, u2, lambda_o, None)

    def bound(self, wo: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
        """The factor k, (n,), by which the lower end of the cap can rise.

        No reflection that stays above the horizon is lost by it.
        k = (1 - a^2) s^2 / (s^2 + a^2 wo.z^2), a = min(alpha_x, alpha_y), s = 1 + |(wo.x, wo.y)| (Eto and Tokuyoshi
        2023, "Bounded VNDF sampling for Smith-GGX reflections", eq. 5 and 6).
        """
        a = np.minimum(alpha_x, alpha_y)
        a2 = np.minimum(a * a, 1.0)
        s2 = np.square(1.0 + np.sqrt(wo[0] * wo[0] + wo[1] * wo[1]))
        return (1.0 - a2) * s2 / (s2 + a2 * wo[2] * wo[2])

    def sample_bounded(
        self,
        wo: np.ndarray,
        alpha_x: Alpha,
        alpha_y: Alpha,
        u1: np.ndarray,
        u2: np.ndarray,
        lambda_o: np.ndarray | None = None,
    ) -> np.ndarray:
        """As `sample_visible`, from the smaller cap z > -k wo.z, k = `bound`.

        Fewer reflections lie below the horizon.
        Density of the reflected direction, per steradian: D(m) / (2 wo.z (k + 1 + 2 Lambda(o))) (Eto and Tokuyoshi
        2023, eq. 7).
        """
        return self._sample_cap(wo, alpha_x, alpha_y, u1, u2, lambda_o, self.bound(wo, alpha_x, alpha_y))

    def _sample_cap(
        self,
        wo: np.ndarray,
        alpha_x: Alpha,
        alpha_y: Alpha,
        u1: np.ndarray,
        u2: np.ndarray,
        lambda_o: np.ndarray | None,
        k: np.ndarray | None,
    ) -> np.ndarray:
        """Sample a visible normal from the cap z > -k wo.z (`k` None: 1).

        Stretch wo, add a point of the cap to it, stretch the sum back.
        """
        if lambda_o is None:
            lambda_o = self.smith_lambda(wo, alpha_x, alpha_y)
        # The stretched wo, whose length is wo.z (1 + 2 Lambda), made a unit vector.
        z = np.clip(wo[2], FLOOR, 1.0)
        length = z * (1.0 + 2.0 * lambda_o)
        x, y, z = wo[0] * alpha_x / length, wo[1] * alpha_y / length, z / length
        # The cap's z is 1 - drop: its sine comes out of drop, and the sum's z out of 1 - u2, without cancelling.
        height = 1.0 + (z if k is None else k * z)
        drop = height * u2
        sine = np.sqrt(np.clip(drop * (2.0 - drop), 0.0, 1.0))
        cap_x, cap_y = circle(u1)
        h = np.empty((3, u1.shape[0]))
        np.multiply(x + sine * cap_x, alpha_x, out=h[0])
        np.multiply(y + sine * cap_y, alpha_y, out=h[1])
        np.multiply(height, 1.0 - np.minimum(u2, LARGEST_UNIFORM), out=h[2])
        if k is not None:
            h[2] += z - k * z
        h /= np.sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2])
        return h
