# SPDX-License-Identifier: GPL-3.0-or-later
"""Reflectances that microfacet lobes carry.

Called with the cosine at the microfacet they return (n,) or, coloured, (3, n).

Parameters are () or (n,); colours (3, 1) or (3, n). `part(index)` gives the same at fewer points.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Protocol, Self, overload

import numpy as np
from scipy.special import roots_legendre

from ..microfacets import fresnel
from ..microfacets.layers import average_reflectance
from ..vectors import gather


class Fresnel(Protocol):
    """What a lobe asks of its reflectance."""

    def __call__(self, cos: np.ndarray) -> np.ndarray:
        """Reflectance at the cosine (n,) in [0, 1] between light and microfacet."""
        ...

    def part(self, index: np.ndarray) -> Fresnel:
        """The same at fewer points."""
        ...


class AveragedFresnel(Fresnel, Protocol):
    """A reflectance whose mean over cosines colours multiple scattering."""

    @property
    def average(self) -> np.ndarray:
        """Integral of 2 c F(c) over c, (3, 1) or (3, n)."""
        ...


class CyclesFresnel(AveragedFresnel, Protocol):
    """A reflectance of Cycles, whose mean Cycles may take to be another."""

    @property
    def average_cycles(self) -> np.ndarray:
        """What Cycles takes for `average`."""
        ...


@overload
def part_of(value: np.ndarray, index: np.ndarray) -> np.ndarray: ...
@overload
def part_of(value: float, index: np.ndarray) -> float: ...
def part_of(value: np.ndarray | float, index: np.ndarray) -> np.ndarray | float:
    """`value` at the points `index`; what is the same at all points stays as it is."""
    if not isinstance(value, np.ndarray) or value.ndim == 0 or value.shape[-1] == 1:
        return value
    return gather(value, index)


@dataclass(frozen=True)
class _PerPoint:
    """Taking parts, for dataclasses whose fields are arrays."""

    def part(self, index: np.ndarray) -> Self:
        """The same at fewer points."""
        return type(self)(**{f.name: part_of(getattr(self, f.name), index) for f in fields(self)})


@dataclass(frozen=True)
class Dielectric(_PerPoint):
    """Exact unpolarised reflectance; `eta` is the index of the far side over the near side's."""

    eta: np.ndarray

    def __call__(self, cos: np.ndarray) -> np.ndarray:
        """Reflectance, (n,)."""
        return fresnel.dielectric(cos, self.eta)


@dataclass(frozen=True)
class Conductor(_PerPoint):
    """Exact unpolarised reflectance of a metal of complex index eta + i k, colour by colour."""

    eta: np.ndarray
    k: np.ndarray

    def __call__(self, cos: np.ndarray) -> np.ndarray:
        """Reflectance, (3, n)."""
        return fresnel.conductor(cos, self.eta, self.k)

    @property
    def average(self) -> np.ndarray:
        """Integral of 2 c F(c) over c, (3, 1) or (3, n)."""
        return _average(self)

    @property
    def average_cycles(self) -> np.ndarray:
        """Return the mean of the F82 curve through the same F(1) and F(1/7), as Cycles does.

        It is up to 2 % off for metals.
        """
        one = np.ones(1)
        f0, edge = self(one), self(one / 7.0)
        return F82(f0, edge / fresnel.schlick(one / 7.0, f0)).average


def _average(curve: Fresnel) -> np.ndarray:
    """Integral of 2 c F(c) over c by quadrature, (3, 1) or (3, n)."""
    node, weight = roots_legendre(24)
    cosines = 0.5 + 0.5 * node
    terms = (w * c * curve(np.full(1, c)) for c, w in zip(cosines, weight, strict=True))
    return sum(terms, start=np.zeros((3, 1)))


@dataclass(frozen=True)
class Schlick(_PerPoint):
    """Schlick's approximation from the colour `f0` at normal incidence to white at grazing."""

    f0: np.ndarray

    def __call__(self, cos: np.ndarray) -> np.ndarray:
        """Reflectance, (3, n)."""
        return fresnel.schlick(cos, self.f0)

    @property
    def average(self) -> np.ndarray:
        """Integral of 2 c F(c) over c: F0 + (1 - F0) / 21."""
        return self.f0 + (1.0 - self.f0) / 21.0


@dataclass(frozen=True)
class CookTorrance(_PerPoint):
    """The exact dielectric, for each colour channel by itself (Cook and Torrance 1982).

    Its index is the one that gives the colour `f0` at normal incidence.
    """

    f0: np.ndarray

    def __call__(self, cos: np.ndarray) -> np.ndarray:
        """Reflectance, (3, n)."""
        return fresnel.cook_torrance(cos, self.f0)

    @property
    def average(self) -> np.ndarray:
        """Integral of 2 c F(c) over c, (3, 1) or (3, n)."""
        return _average(self)


@dataclass(frozen=True)
class F82(_PerPoint):
    """Schlick's curve from `f0`, bent so that `tint` times its value is met at the cosine 1/7.

    F0 + (1 - F0) (1 - c)^5 - b c (1 - c)^6, clipped to [0, 1]; Kutz, Hasan and Edmondson 2021, "Novel aspects of the Adobe
    Standard Material", eq. 2.
    """

    f0: np.ndarray
    tint: np.ndarray

    @property
    def _b(self) -> np.ndarray:
        seventh = np.full(1, 1.0 / 7.0)
        return fresnel.schlick(seventh, self.f0) * (1.0 - self.tint) * (7.0 / (6.0 / 7.0) ** 6)

    def __call__(self, cos: np.ndarray) -> np.ndarray:
        """Reflectance, (3, n)."""
        m = 1.0 - cos
        m2 = m * m
        m5 = m2 * m2 * m
        return np.clip(self.f0 + (1.0 - self.f0) * m5 - self._b * (cos * (m5 * m)), 0.0, 1.0)

    @property
    def average(self) -> np.ndarray:
        """Integral of 2 c F(c) over c: F0 + (1 - F0) / 21 - b / 126, the clipping left out."""
        return np.clip(self.f0 + (1.0 - self.f0) / 21.0 - self._b / 126.0, 0.0, 1.0)

    @property
    def average_cycles(self) -> np.ndarray:
        """What Cycles takes for it: the same."""
        return self.average


@dataclass(frozen=True)
class TintedDielectric(_PerPoint):
    """The exact dielectric's curve, stretched to begin at the colour `f0` and to end at 1.

    It is that of Blender's Principled BSDF.
    """

    eta: np.ndarray
    f0: np.ndarray

    def __call__(self, cos: np.ndarray) -> np.ndarray:
        """Reflectance, (3, n)."""
        rise = fresnel.rise_to_grazing(cos, self.eta)
        return self.f0 + (1.0 - self.f0) * np.clip(rise, 0.0, 1.0)

    @property
    def average(self) -> np.ndarray:
        """Integral of 2 c F(c) over c, (3, 1) or (3, n)."""
        plain = reflectance_at_normal(self.eta)
        s = (average_reflectance(self.eta) - plain) / np.maximum(1.0 - plain, 1e-12)
        return self.f0 + (1.0 - self.f0) * s

    @property
    def average_cycles(self) -> np.ndarray:
        """Return the mean by which Cycles colours multiple scattering, (3, 1) or (3, n).

        It is a fit, up to 1 % off.

        Kulla and Conty 2017, "Revisiting Physically Based Shading at Imageworks", for the mean of the dielectric's
        curve.
        """
        eta = np.asarray(self.eta, np.float64)
        below = 0.997118 + eta * (0.1014 - eta * (0.965241 + eta * 0.130607))
        fit = np.where(eta < 1.0, below, (eta - 1.0) / (4.08567 + 1.00071 * eta))
        plain = reflectance_at_normal(eta)
        s = (fit - plain) / np.maximum(1.0 - plain, 1e-12)
        return self.f0 + (1.0 - self.f0) * np.clip(s, 0.0, 1.0)


def tinted_dielectric(eta: np.ndarray, tint: np.ndarray) -> TintedDielectric:
    """The curve whose beginning is multiplied by the colour `tint`."""
    return TintedDielectric(eta, np.clip(reflectance_at_normal(eta) * tint, 0.0, 1.0))


def reflectance_at_normal(eta: np.ndarray) -> np.ndarray:
    """((eta - 1) / (eta + 1))^2."""
    return np.square((eta - 1.0) / (eta + 1.0))
