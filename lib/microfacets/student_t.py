# SPDX-License-Identifier: GPL-3.0-or-later
"""Student-t distributions of slopes: the family between Phong, GGX and Beckmann.

Ribardiere et al. 2017.
alpha_x, alpha_y in (0, 1], () or (n,): the documents' sigma, Blender's roughness squared. Uniforms in [0, 1].
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..errors import EtalonError
from ..sampling.tables import LARGEST_UNIFORM
from ..sampling.warps import circle
from .directions import FLOOR, above_horizon, normal_from_tangents, stretched_sine_squared
from .distribution import Alpha, Distribution
from .masking import HIDDEN
from .student_slopes import lambda_by_beta, slope_tables

LARGEST_SHAPE = 1e4


@dataclass(frozen=True)
class StudentT(Distribution):
    """Student-t slopes, 3/2 < `g` <= 1e4.

    P22(r^2) = 1 / (pi alpha_x alpha_y (1 + r^2 / (g - 1))^g).
    g = 2 is GGX, and the limit of large g is Beckmann's. Phong's D = (n + 2) / (2 pi) cos^n is g = n/2 + 2 with alpha^2
    = 2 / (n + 2). At g = 3/2 the mean slope becomes infinite, and no surface masks by it. Raises EtalonError for a g
    out of range.
    """

    g: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.g) and 1.5 < self.g <= LARGEST_SHAPE):
            remedy = f"give more than 1.5 and at most {LARGEST_SHAPE:g}; Beckmann's is the limit of large g"
            raise EtalonError(f"Student-t distribution: g = {self.g:g} is out of range; {remedy}")

    def density(self, m: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
        """The density D(m), sr^-1, (n,).

        D = (1 + s / (g - 1))^-g / (pi alpha_x alpha_y m.z^4), s = (m.x^2/alpha_x^2 + m.y^2/alpha_y^2) / m.z^2.
        Ribardiere et al. 2017 (STD). `m` (3, n) unit, or of any length l, which gives D / l^4; zero where m.z <= 0.
        """
        z2 = np.square(np.maximum(m[2], FLOOR))
        excess = np.square(m[0] / alpha_x)
        excess += np.square(m[1] / alpha_y)
        excess /= z2 * (self.g - 1.0)
        base = 1.0 + excess
        d = np.power(base, -self.g)
        # What rounding has taken from the base is taken g times from D: it is given back.
        excess -= base - 1.0
        excess *= self.g
        excess /= base
        np.subtract(1.0, excess, out=excess)
        d *= excess
        z2 *= z2
        z2 *= np.pi * (alpha_x * alpha_y)
        d /= z2
        return above_horizon(m, d, 0.0)

    def smith_lambda(self, w: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
        """Smith's Lambda(w) from the table of this g, (n,), to 1e-11 of 1 + Lambda.

        `w` (3, n) unit; HIDDEN where w.z <= 0.
        The table is made from `smith_lambda_by_beta`.
        """
        sine = np.sqrt(stretched_sine_squared(w, alpha_x, alpha_y))
        return above_horizon(w, slope_tables(self.g).masking(sine, np.clip(w[2], FLOOR, 1.0)), HIDDEN)

    def smith_lambda_by_beta(self, w: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
        """Smith's exact Lambda(w) by the incomplete beta function, (n,).

        It is a hundred times slower than `smith_lambda`, with the same arguments.
        """
        sine = np.sqrt(np.maximum(stretched_sine_squared(w, alpha_x, alpha_y), FLOOR))
        return above_horizon(w, lambda_by_beta(np.clip(w[2], FLOOR, 1.0) / sine, self.g), HIDDEN)

    def sample_d_cos(self, alpha_x: Alpha, alpha_y: Alpha, u1: np.ndarray, u2: np.ndarray) -> np.ndarray:
        """Microfacet normal with density D(m) (m.n), (3, n).

        phi = 2 pi u1, tan(theta) = alpha sqrt((g - 1) ((1 - u2)^(-1 / (g - 1)) - 1)) (Ribardiere et al. 2017); the anisotropic lobe
        is the isotropic one stretched along x and y.
        """
        x, y = circle(u1)
        power = np.log1p(-np.minimum(u2, LARGEST_UNIFORM)) / (1.0 - self.g)
        tangent = np.sqrt((self.g - 1.0) * np.expm1(power))
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

        Stretch to roughness 1, sample the tangent along the view by the inversion of its exact distribution, the one across it by
        Student's t with one degree of freedom more, turn and stretch back. `wo` (3, n) unit with wo.z > 0 (others give some valid normal);
        `lambda_o` is Lambda(wo) where it is known.
        """
        if lambda_o is None:
            lambda_o = self.smith_lambda(wo, alpha_x, alpha_y)
        tables = slope_tables(self.g)
        x = wo[0] * alpha_x + 1e-150  # at normal incidence every azimuth is as good; this one has a direction
        y = wo[1] * alpha_y
        sine = np.sqrt(x * x + y * y)
        along = tables.visible_tangent(sine, np.clip(wo[2], FLOOR, 1.0), u1, lambda_o)
        across = tables.tangent_across(along, u2)
        cos_phi, sin_phi = x / sine, y / sine
        return normal_from_tangents(
            alpha_x * (cos_phi * along - sin_phi * across), alpha_y * (sin_phi * along + cos_phi * across)
        )
