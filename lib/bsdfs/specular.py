# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth interfaces: mirror, glass, refraction.

Their densities are infinite, and their values are 0 for all directions.
"""

from __future__ import annotations

import numpy as np

from ..microfacets import fresnel
from .lobe import DeltaLobe, to_rgb


def refract(wo: np.ndarray, eta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return Snell's direction on the far side, (3, n), and where there is none, (n,) bool.

    There is none under total internal reflection.

    `eta` is the index of the far side over that of wo's side.
    """
    inverse = 1.0 / eta
    sin2 = (wo[0] * wo[0] + wo[1] * wo[1]) * (inverse * inverse)
    total = sin2 >= 1.0
    cos = np.sqrt(np.maximum(1.0 - sin2, 0.0))
    return np.stack([-wo[0] * inverse, -wo[1] * inverse, -cos]), total


def refracted_widening(wo: np.ndarray, wi: np.ndarray, eta: np.ndarray) -> np.ndarray:
    """Return the solid angle about `wi` per solid angle about `wo`, (n,).

    It is cos_o / (eta^2 cos_i) beyond the interface, else 1.

    Snell's law differentiated: n^2 cos dw is the same on both sides (Veach 1997, section 5.2).
    """
    beyond = np.abs(wo[2]) / np.maximum(np.square(eta) * np.abs(wi[2]), 1e-300)
    return np.where(wi[2] < 0.0, beyond, 1.0)


class Mirror(DeltaLobe):
    """Perfect reflection about the normal."""

    def __init__(self, wo: np.ndarray) -> None:
        self._wo = wo

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The mirror direction with weight 1."""
        wo = self._wo
        above = np.where(wo[2] > 0.0, 1.0, 0.0)
        return np.stack([-wo[0], -wo[1], wo[2]]), to_rgb(above), np.full(wo.shape[1], np.inf)

    def part(self, index: np.ndarray) -> Mirror:
        """The same lobe at fewer points."""
        return Mirror(np.take(self._wo, index, axis=1))


class SmoothDielectric(DeltaLobe):
    """A smooth interface of relative index `eta` (far side over near side), (n,).

    With `fresnel_reflection` glass: reflection with the exact Fresnel probability, else refraction. Without it refraction
    alone, which is nothing under total internal reflection. Radiance is not scaled by 1 / eta^2, as in Cycles.
    """

    def __init__(self, wo: np.ndarray, eta: np.ndarray, fresnel_reflection: bool) -> None:
        self._wo, self._eta, self._reflects = (
            wo,
            np.broadcast_to(np.asarray(eta, np.float64), wo.shape[1:]),
            fresnel_reflection,
        )

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """One of the two directions, weight 1 (0 where there is none)."""
        wo = self._wo
        refracted, total = refract(wo, self._eta)
        weight = np.where(wo[2] > 0.0, 1.0, 0.0)
        if not self._reflects:
            weight[total] = 0.0
            return refracted, to_rgb(weight), np.full(wo.shape[1], np.inf)
        reflectance = fresnel.dielectric(np.clip(wo[2], 0.0, 1.0), self._eta)
        mirrored = np.stack([-wo[0], -wo[1], wo[2]])
        return np.where(u1 < reflectance, mirrored, refracted), to_rgb(weight), np.full(wo.shape[1], np.inf)

    def widening(self, wi: np.ndarray) -> np.ndarray:
        """Solid angle about `wi` per solid angle about wo, (n,)."""
        return refracted_widening(self._wo, wi, self._eta)

    def part(self, index: np.ndarray) -> SmoothDielectric:
        """The same lobe at fewer points."""
        return SmoothDielectric(np.take(self._wo, index, axis=1), self._eta[index], self._reflects)
