# SPDX-License-Identifier: GPL-3.0-or-later
"""Departures in what a surface does: a lobe that misstates its density, and the distributions that lead to it."""

from __future__ import annotations

from collections.abc import Set
from types import ModuleType, SimpleNamespace

import numpy as np

from ..bsdfs.ashikhmin_shirley import AshikhminShirley, sample_half_vector
from ..bsdfs.fresnels import part_of
from ..bsdfs.mixture import Lobe
from ..microfacets import beckmann
from ..vectors import dot

RATIONAL = SimpleNamespace(
    density=beckmann.density,
    smith_lambda=beckmann.smith_lambda_rational,
    # Samples follow the exact Lambda, whatever the lobe's.
    sample_visible=lambda wo, alpha_x, alpha_y, u1, u2, _: beckmann.sample_visible(wo, alpha_x, alpha_y, u1, u2),
    sample_d_cos=beckmann.sample_d_cos,
)
"""Beckmann's distribution with the rational Lambda in place of the exact one, both in masking and in the density."""


class Misstated:
    """`lobe`, stating 1 / `factor` (n,) of its density: its samples, drawn as before, weigh `factor` times as much."""

    def __init__(self, lobe: Lobe, factor: np.ndarray) -> None:
        self._lobe, self._factor = lobe, factor
        self.delta = lobe.delta

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The lobe's value, and the density it states."""
        value, pdf = self._lobe.evaluate(wi)
        return value, pdf / self._factor

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction, weight f |cos| / stated density, the stated density."""
        wi, weight, pdf = self._lobe.sample(u1, u2)
        return wi, weight * self._factor, pdf / self._factor

    def part(self, index: np.ndarray) -> Misstated:
        """The same lobe at fewer points."""
        return Misstated(self._lobe.part(index), part_of(self._factor, index))


class StrayAshikhminShirley(AshikhminShirley):
    """The lobe whose half vectors that face away from wo give samples, too.

    Such a half vector m, (m.wo) < 0, leads to 2 |m.wo| m - wo, which is no mirror direction. It weighs as the sample that
    has the half vector m and this vector's component along the normal, which is longer than a unit vector's. Beside other
    lobes Cycles evaluates those at the same vector; here they are evaluated at the unit direction.
    """

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction, weight, the density that Cycles states."""
        m = sample_half_vector(self._nx, self._ny, u1, u2)
        cos_om = np.abs(dot(self._wo, m))
        wi = m * (2.0 * cos_om) - self._wo
        value, pdf = self._lobe(wi, m, cos_om)
        return wi / np.sqrt(dot(wi, wi)), np.where(pdf > 0.0, value / np.where(pdf > 0.0, pdf, 1.0), 0.0), pdf


def ashikhmin_shirley_form(departures: Set[str]) -> type[AshikhminShirley]:
    """The lobe by the way in which it is sampled."""
    return StrayAshikhminShirley if "Ashikhmin-Shirley sampling" in departures else AshikhminShirley


def beckmann_form(departures: frozenset[str]) -> ModuleType | SimpleNamespace:
    """Beckmann's distribution with the Lambda by which it masks."""
    return RATIONAL if "rational Beckmann Lambda" in departures else beckmann


def oren_nayar_form(departures: Set[str]) -> int | None:
    """The power of the colour with which Oren-Nayar's multiple scattering begins, or None where there is none."""
    if "Oren-Nayar without multiple scattering" in departures:
        return None
    return 3 if "Oren-Nayar colour" in departures else 2


def with_stated_density(
    lobe: Lobe, wo: np.ndarray, alpha_x: np.ndarray, alpha_y: np.ndarray, departures: frozenset[str]
) -> Lobe:
    """A Beckmann lobe of visible normals, made by `beckmann_form`, that states its density by the Lambda asked for.

    A lobe states D (wo.m) / (wo.n (1 + Lambda)) with the Lambda by which it masks; samples have the exact one in any case.
    """
    masks_rational = "rational Beckmann Lambda" in departures
    states_rational = "rational Beckmann density" in departures
    if masks_rational == states_rational:
        return lobe
    exact = 1.0 + beckmann.smith_lambda(wo, alpha_x, alpha_y)
    rational = 1.0 + beckmann.smith_lambda_rational(wo, alpha_x, alpha_y)
    return Misstated(lobe, rational / exact if states_rational else exact / rational)
