# SPDX-License-Identifier: GPL-3.0-or-later
"""Departures in surface closures.

They are a lobe that states a wrong density, and the distributions that lead to it.
"""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass

import numpy as np

from ..bsdfs.ashikhmin_shirley import AshikhminShirley, sample_half_vector
from ..bsdfs.fresnels import part_of
from ..bsdfs.lobe import Lobe, Wrapper, to_rgb
from ..microfacets.beckmann import Beckmann, smith_lambda_rational
from ..microfacets.distribution import Alpha, Distribution
from ..vectors import dot


@dataclass(frozen=True)
class RationalBeckmann(Beckmann):
    """Beckmann's distribution with the rational Lambda in place of the exact one.

    Both the masking and the density use it.
    """

    def smith_lambda(self, w: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
        """Return the fit to Lambda, (n,)."""
        return smith_lambda_rational(w, alpha_x, alpha_y)

    def sample_visible(
        self,
        wo: np.ndarray,
        alpha_x: Alpha,
        alpha_y: Alpha,
        u1: np.ndarray,
        u2: np.ndarray,
        lambda_o: np.ndarray | None = None,
    ) -> np.ndarray:
        """Sample by the exact Lambda, whatever the lobe's `lambda_o`, (3, n)."""
        return super().sample_visible(wo, alpha_x, alpha_y, u1, u2, super().smith_lambda(wo, alpha_x, alpha_y))


class Misstated(Wrapper):
    """A lobe that states 1 / `factor` (n,) of its density.

    Its samples are drawn as before and have `factor` times the weight.
    """

    def __init__(self, lobe: Lobe, factor: np.ndarray) -> None:
        super().__init__(lobe)
        self._factor = factor

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
        weight = np.where(pdf > 0.0, value / np.where(pdf > 0.0, pdf, 1.0), 0.0)
        return wi / np.sqrt(dot(wi, wi)), to_rgb(weight), pdf


def ashikhmin_shirley_form(departures: Set[str]) -> type[AshikhminShirley]:
    """The lobe by the way in which it is sampled."""
    return StrayAshikhminShirley if "Ashikhmin-Shirley sampling" in departures else AshikhminShirley


def distribution_form(distribution: Distribution, departures: Set[str]) -> Distribution:
    """The distribution with the Lambda by which it masks: Beckmann's may be the rational one."""
    rational = isinstance(distribution, Beckmann) and "rational Beckmann Lambda" in departures
    return RationalBeckmann() if rational else distribution


def oren_nayar_form(departures: Set[str]) -> int | None:
    """Return the power of the colour that starts Oren-Nayar's multiple scattering.

    None where there is no multiple scattering.
    """
    if "Oren-Nayar without multiple scattering" in departures:
        return None
    return 3 if "Oren-Nayar colour" in departures else 2


def with_stated_density(
    lobe: Lobe,
    distribution: Distribution,
    wo: np.ndarray,
    alpha_x: np.ndarray,
    alpha_y: np.ndarray,
    departures: Set[str],
) -> Lobe:
    """Build a lobe of visible normals that states its density by the Lambda asked for.

    The lobe has `distribution`, which comes from `distribution_form`.

    That is Beckmann's only; other lobes stay as they are. A lobe states D (wo.m) / (wo.n (1 + Lambda)) with the
    Lambda by which it masks; samples have the exact one in any case.
    """
    masks_rational = "rational Beckmann Lambda" in departures
    states_rational = "rational Beckmann density" in departures
    if not isinstance(distribution, Beckmann) or masks_rational == states_rational:
        return lobe
    exact = 1.0 + Beckmann().smith_lambda(wo, alpha_x, alpha_y)
    rational = 1.0 + smith_lambda_rational(wo, alpha_x, alpha_y)
    return Misstated(lobe, rational / exact if states_rational else exact / rational)
