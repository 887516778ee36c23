# SPDX-License-Identifier: GPL-3.0-or-later
"""Ashikhmin and Shirley's Phong model, as in Blender's Glossy BSDF.

It is the specular lobe without its Fresnel factor.
"""

from __future__ import annotations

import numpy as np

from ..microfacets.directions import FLOOR
from ..sampling.tables import LARGEST_UNIFORM
from ..sampling.warps import circle
from ..vectors import dot
from .fresnels import part_of
from .lobe import Lobe, to_rgb

_LEAST_ALPHA = 1e-4


def exponent(alpha: np.ndarray) -> np.ndarray:
    """Return the exponent n = 2 / alpha^2 - 2 that Blender uses for `alpha`.

    `alpha` is clipped to [1e-4, 1].
    """
    return 2.0 / np.clip(alpha, _LEAST_ALPHA, 1.0) ** 2 - 2.0


def sample_half_vector(nx: np.ndarray, ny: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> np.ndarray:
    """Sample a half vector, (3, n).

    Its density is proportional to (h.n)^e, e = (nx hx^2 + ny hy^2) / (1 - hz^2).

    Ashikhmin and Shirley 2000, eq. 6 to 9: tan(phi) = sqrt((nx + 1) / (ny + 1)) tan(2 pi u1), cos(theta) = (1 -
    u2)^(1 / (e + 1)). `nx` and `ny` not negative, () or (n,); `u1` and `u2` (n,) in [0, 1].
    """
    c, s = circle(u1)
    c = c * np.sqrt(ny + 1.0)
    s = s * np.sqrt(nx + 1.0)
    length2 = c * c + s * s
    e = (nx * c * c + ny * s * s) / length2
    log_cos = np.log1p(-np.minimum(u2, LARGEST_UNIFORM)) / (e + 1.0)
    sine = np.sqrt(-np.expm1(2.0 * log_cos) / length2)
    return np.stack([c * sine, s * sine, np.exp(log_cos)])


class AshikhminShirley(Lobe):
    """Ashikhmin and Shirley's specular lobe without its Fresnel factor.

    f = sqrt((nx + 1)(ny + 1)) / (8 pi) (h.n)^e / (h.o max(i.n, o.n)), e = (nx hx^2 + ny hy^2) / (1 - hz^2).

    Ashikhmin and Shirley 2000, eq. 4, with n = 2 / alpha^2 - 2 (Blender), alpha_x and alpha_y, () or (n,), in [1e-4,
    1]. Sampled by its half vectors, eq. 6 to 9.
    """

    def __init__(self, wo: np.ndarray, alpha_x: np.ndarray, alpha_y: np.ndarray) -> None:
        self._wo, self._alpha = wo, (alpha_x, alpha_y)
        self._nx, self._ny = exponent(alpha_x), exponent(alpha_y)
        self._above = wo[2] > 0.0

    def _lobe(self, wi: np.ndarray, m: np.ndarray, cos_om: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the value f |cos| and the density for wi = reflection of wo about m.

        `cos_om` is the cosine between m and both directions.
        """
        wo = self._wo
        x2, y2 = m[0] * m[0], m[1] * m[1]
        sine2 = x2 + y2
        e = np.where(sine2 > 0.0, (self._nx * x2 + self._ny * y2) / np.maximum(sine2, 1e-300), 0.0)
        # log(h.n) by the smaller of sine and cosine: a cosine near 1 has too few digits where e is large.
        log_cos = 0.5 * np.log1p(-np.minimum(sine2, 0.5))
        low = np.flatnonzero(sine2 > 0.5)
        log_cos[low] = np.log(np.maximum(m[2][low], FLOOR))
        pdf = np.exp(e * log_cos)
        pdf *= np.sqrt((self._nx + 1.0) * (self._ny + 1.0)) / (8.0 * np.pi)
        pdf /= np.maximum(cos_om, FLOOR)
        lit = (wi[2] > 0.0) & self._above & (m[2] > 0.0)
        pdf = np.where(lit, pdf, 0.0)
        return pdf * np.maximum(wi[2], 0.0) / np.maximum(np.maximum(wi[2], wo[2]), FLOOR), pdf

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Value f |cos|, (3, n), and density, (n,).

        h.o is half the length of wi + wo: as a scalar product it keeps no digits where the two are all but opposite.
        """
        m = wi + self._wo
        length = np.sqrt(dot(m, m))
        m /= np.where(length > 0.0, length, 1.0)
        value, pdf = self._lobe(wi, m, 0.5 * length)
        return to_rgb(value), pdf

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction, weight, density."""
        m = sample_half_vector(self._nx, self._ny, u1, u2)
        cos_om = dot(self._wo, m)
        wi = m * (2.0 * cos_om) - self._wo
        value, pdf = self._lobe(wi, m, cos_om)
        good = cos_om > 0.0
        weight = np.where(good & (pdf > 0.0), value / np.where(pdf > 0.0, pdf, 1.0), 0.0)
        return wi, to_rgb(weight), np.where(good, pdf, 0.0)

    def part(self, index: np.ndarray) -> AshikhminShirley:
        """The same lobe at fewer points."""
        return type(self)(np.take(self._wo, index, axis=1), *(part_of(a, index) for a in self._alpha))
