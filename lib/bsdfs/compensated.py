# SPDX-License-Identifier: GPL-3.0-or-later
"""Compensation for the light that single scattering loses between microfacets.

It has the shape of the lobe itself (Blender's Multiscatter GGX).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..microfacets.albedo import average_albedo, directional_albedo
from ..microfacets.cycles_tables import Tables
from .lobe import Lobe, Wrapper

Albedos = tuple[Callable[..., np.ndarray], Callable[..., np.ndarray]]
EXACT: Albedos = (directional_albedo, average_albedo)


def multiple_scattering(
    cos_o: np.ndarray, alpha: float | np.ndarray, color: np.ndarray, albedos: Albedos = EXACT
) -> np.ndarray:
    """Return the factor, (3, n), that turns single scattering into all of the scattering.

    It is 1 + Fms (1 - E) / E with Fms = Fss Eavg / (1 - Fss (1 - Eavg)).

    Turquin 2019, "Practical multiple scattering compensation for microfacet models", eq. 15 and 16, with the colour
    of many bounces after Fdez-Aguera 2019. `cos_o` (n,); `alpha` () or (n,), sqrt(alpha_x alpha_y); `color` (3, 1) or
    (3, n), Fss, at least 0; `albedos` the functions E and Eavg. White gives 1 / E: no light is lost. It is not
    reciprocal: wi has no part in it. NaN where Fss (1 - Eavg) reaches 1: each bounce between facets then gives more
    light than the one before, and their sum is infinite.
    """
    directional, mean = albedos
    lost = 1.0 / directional(np.clip(cos_o, 0.0, 1.0), alpha)
    lost -= 1.0
    average = mean(alpha)
    left = 1.0 - color * (1.0 - average)
    factor = color * average / np.where(left > 0.0, left, np.nan) * lost
    factor += 1.0
    return factor


def albedos_of(tables: Tables | None) -> Albedos:
    """E and Eavg: by a layout of Cycles' tables, or the integrals themselves."""
    return EXACT if tables is None else (tables.directional_albedo, tables.average_albedo)


class Compensated(Wrapper):
    """`lobe` with its value and weight multiplied by `factor`, (3, n).

    Its directions and their density stay as they are.
    """

    def __init__(self, lobe: Lobe, factor: np.ndarray) -> None:
        super().__init__(lobe)
        self._factor = factor

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Coloured value (3, n) and density (n,)."""
        value, pdf = self._lobe.evaluate(wi)
        return self._factor * value, pdf

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction, coloured weight (3, n), density."""
        wi, weight, pdf = self._lobe.sample(u1, u2)
        return wi, self._factor * weight, pdf

    def part(self, index: np.ndarray) -> Compensated:
        """The same lobe at fewer points."""
        return Compensated(self._lobe.part(index), np.take(self._factor, index, axis=1))
