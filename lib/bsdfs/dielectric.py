# SPDX-License-Identifier: GPL-3.0-or-later
"""Rough interfaces between two media: microfacets that reflect and refract.

Walter et al. 2007.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..microfacets import masking
from ..microfacets.directions import FLOOR
from ..microfacets.distribution import Distribution
from ..microfacets.fresnel import dielectric
from ..vectors import dot
from .fresnels import Dielectric, Fresnel, part_of
from .lobe import DeltaLobe, Lobe
from .specular import refract, refracted_widening

_SPLIT = 2.0**16


@dataclass(frozen=True)
class Interface:
    """The reflectance and the colours of an interface at one microfacet.

    It reflects F `reflection` and refracts (1 - F) `transmission`, colours (3, 1) or (3, n).

    Without a `fresnel` it refracts all, and under total reflection nothing (Blender's Refraction BSDF).
    """

    fresnel: Fresnel | None
    reflection: np.ndarray
    transmission: np.ndarray

    def shares(self, cos: np.ndarray, eta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the reflected and refracted colours (3, n) and the chance of reflection (n,).

        They are those at the cosine (n,). Reflection is sampled with that chance.
        """
        if self.fresnel is None:
            through = np.where(dielectric(cos, eta) < 1.0, 1.0, 0.0)
            return np.zeros((3, 1)), through * self.transmission, np.zeros_like(cos)
        f = self.fresnel(cos)
        reflected, refracted = f * self.reflection, (1.0 - f) * self.transmission
        mean = np.abs(reflected).mean(axis=0)
        total = mean + np.abs(refracted).mean(axis=0)
        return reflected, refracted, np.broadcast_to(mean / np.where(total > 0.0, total, 1.0), cos.shape)

    @property
    def is_plain(self) -> bool:
        """Whether nothing is tinted and the reflectance, if any, is the exact dielectric's."""
        exact = self.fresnel is None or isinstance(self.fresnel, Dielectric)
        return exact and bool(np.all(self.reflection == 1.0) and np.all(self.transmission == 1.0))

    def part(self, index: np.ndarray) -> Interface:
        """The same at fewer points."""
        fresnel = None if self.fresnel is None else self.fresnel.part(index)
        return Interface(fresnel, part_of(self.reflection, index), part_of(self.transmission, index))


class RoughDielectric(Lobe):
    """Microfacets of `alpha_x` and `alpha_y` between media of relative index `eta`.

    All are () or (n,). `eta` is the index of the far side over that of the near side, and is not 1.

    Reflection F D G / (4 |o.n|), refraction (1 - F) D G |i.m| |o.m| eta^2 / (|eta i + o|^2 |o.n|), the factor |i.n|
    included (Walter et al. 2007, eq. 20 and 21); radiance is not scaled by 1 / eta^2, as in Cycles. Visible normals
    are sampled, then reflection or refraction by their shares. `masking_form`: 'correlated' or 'separable' on either
    side; 'torrance_sparrow' where light is reflected, for which alone its cavities are, and 'correlated' where it is
    refracted. `backs_refract` lets `evaluate` count refraction through facets that a direction sees from behind,
    which no sample takes: a departure.
    """

    def __init__(
        self,
        wo: np.ndarray,
        alpha_x: np.ndarray,
        alpha_y: np.ndarray,
        eta: np.ndarray,
        distribution: Distribution,
        interface: Interface,
        masking_form: str = "correlated",
        backs_refract: bool = False,
    ) -> None:
        self._wo, self._alpha, self._eta = wo, (alpha_x, alpha_y), eta
        self._distribution, self._interface, self._form = distribution, interface, masking_form
        self._backs_refract = backs_refract
        self._above = wo[2] > 0.0
        self._cos_o = np.where(self._above, wo[2], 1.0)
        self._lambda_o = distribution.smith_lambda(wo, alpha_x, alpha_y)

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Coloured value (3, n) and density (n,), over the whole sphere."""
        wo, eta = self._wo, self._eta
        through = wi[2] < 0.0
        m = wi * np.where(through, eta, 1.0)
        m += wo
        length = np.sqrt(dot(m, m))
        m /= np.copysign(np.where(length > 0.0, length, 1.0), m[2])
        cos_om, cos_im = dot(wo, m), dot(wi, m)
        # A facet is seen from its front by wo, and by wi from the side on which wi lies.
        valid = self._above & (cos_om > 0.0) & np.where(through, cos_im < 0.0, wi[2] > 0.0)
        if self._backs_refract:
            valid |= self._above & through
            cos_om = np.abs(cos_om)
        reflected, refracted, chance = self._interface.shares(np.clip(cos_om, 0.0, 1.0), eta)
        d = np.where(valid, self._distribution.density(m, *self._alpha), 0.0)
        d /= self._cos_o
        d *= np.where(through, _refraction_factor(cos_om, cos_im, eta, length), 0.25)
        pdf = d / (1.0 + self._lambda_o)
        pdf *= np.where(through, 1.0 - chance, chance)
        d *= self._masking(wi, m, through)
        return np.where(through, refracted, reflected) * d, pdf

    def _masking(self, wi: np.ndarray, m: np.ndarray, through: np.ndarray) -> np.ndarray:
        """G of wo and of wi folded up to wo's side."""
        folded = np.stack([wi[0], wi[1], np.abs(wi[2])])
        lambda_i = self._distribution.smith_lambda(folded, *self._alpha)
        if self._form == "separable":
            return masking.separable(lambda_i, self._lambda_o)
        smith = masking.height_correlated(lambda_i, self._lambda_o)
        if self._form == "torrance_sparrow":
            return np.where(through, smith, masking.torrance_sparrow(wi, self._wo, m))
        return smith

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction, coloured weight (3, n), density.

        The digits of `u1` beyond the sixteenth serve again to choose between reflection and refraction.
        """
        wo, eta = self._wo, self._eta
        m = self._distribution.sample_visible(wo, *self._alpha, u1, u2, self._lambda_o)
        cos_om = dot(wo, m)
        reflected, refracted, chance = self._interface.shares(np.clip(cos_om, 0.0, 1.0), eta)
        digits = u1 * _SPLIT
        digits -= np.floor(digits)
        through = digits >= chance
        sin2 = (1.0 - cos_om * cos_om) / (eta * eta)
        cos_t = np.sqrt(np.maximum(1.0 - sin2, 0.0))
        wi = m * np.where(through, cos_om / eta - cos_t, 2.0 * cos_om)
        wi -= wo * np.where(through, 1.0 / eta, 1.0)
        valid = self._above & (cos_om > 0.0) & np.where(through, (wi[2] < 0.0) & (sin2 < 1.0), wi[2] > 0.0)
        weight = self._masking(wi, m, through)  # G2 / G1(wo): D and the Jacobian cancel
        weight *= 1.0 + self._lambda_o
        share = np.where(through, 1.0 - chance, chance)
        weight *= np.where(valid, 1.0 / np.maximum(share, FLOOR), 0.0)
        length = np.abs(eta * cos_t - cos_om)  # |eta wi + wo|: the tangential parts cancel
        pdf = self._distribution.density(m, *self._alpha)
        pdf /= self._cos_o * (1.0 + self._lambda_o)
        pdf *= np.where(through, _refraction_factor(cos_om, cos_t, eta, length), 0.25) * share
        pdf *= valid
        return wi, np.where(through, refracted, reflected) * weight, pdf

    def part(self, index: np.ndarray) -> RoughDielectric:
        """The same lobe at fewer points."""
        return RoughDielectric(
            np.take(self._wo, index, axis=1),
            part_of(self._alpha[0], index),
            part_of(self._alpha[1], index),
            part_of(self._eta, index),
            self._distribution,
            self._interface.part(index),
            self._form,
            self._backs_refract,
        )


class SmoothInterface(DeltaLobe):
    """A smooth interface that tints.

    It samples the mirror direction or Snell's direction, by the shares of `interface`.
    """

    def __init__(self, wo: np.ndarray, eta: np.ndarray, interface: Interface) -> None:
        self._wo, self._eta, self._interface = wo, eta, interface

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """One of the two directions, coloured weight (3, n)."""
        wo = self._wo
        refracted, _ = refract(wo, self._eta)
        toward, beyond, chance = self._interface.shares(np.clip(wo[2], 0.0, 1.0), self._eta)
        through = u1 >= chance
        share = np.where(through, 1.0 - chance, chance)
        weight = np.where(through, beyond, toward) * np.where(wo[2] > 0.0, 1.0 / np.maximum(share, FLOOR), 0.0)
        mirrored = np.stack([-wo[0], -wo[1], wo[2]])
        return np.where(through, refracted, mirrored), weight, np.full(wo.shape[1], np.inf)

    def widening(self, wi: np.ndarray) -> np.ndarray:
        """Solid angle about `wi` per solid angle about wo, (n,)."""
        return refracted_widening(self._wo, wi, self._eta)

    def part(self, index: np.ndarray) -> SmoothInterface:
        """The same lobe at fewer points."""
        return SmoothInterface(np.take(self._wo, index, axis=1), part_of(self._eta, index), self._interface.part(index))


def _refraction_factor(cos_om: np.ndarray, cos_im: np.ndarray, eta: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Return the factor of refraction that takes the place of 1/4 in reflection.

    It is |i.m| |o.m| eta^2 / |eta i + o|^2, with |eta i + o| = `length` (Walter et al. 2007, eq. 17).
    """
    return np.abs(cos_om * cos_im) * np.square(eta / np.maximum(length, FLOOR))
