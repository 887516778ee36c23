# SPDX-License-Identifier: GPL-3.0-or-later
"""What layers leave of light for those below them (Blender's Principled BSDF)."""

from __future__ import annotations

import numpy as np

from ..microfacets.cycles_tables import layer_share_cycles
from ..microfacets.layers import layer_albedo
from .compensated import CYCLES, multiple_scattering
from .fresnels import tinted_dielectric


def layer_reflectance(
    cos_o: np.ndarray, alpha: np.ndarray, eta: float, tint: np.ndarray, compensated: bool
) -> np.ndarray:
    """Directional albedo (3, n) of a glossy layer of index `eta` and `tint`, (3, 1) or (3, n); `cos_o` (n,), `alpha` () or (n,).

    It is that of the lobe itself, `compensated` for multiple scattering where the lobe is: nothing is lost between layers.
    """
    if eta == 1.0:
        return np.zeros((3, cos_o.size))
    curve = tinted_dielectric(np.float64(eta), tint)
    from_normal, to_grazing = layer_albedo(cos_o, alpha, eta)
    albedo = curve.f0 * from_normal + to_grazing
    return albedo * multiple_scattering(cos_o, alpha, curve.average) if compensated else albedo


def layer_reflectance_cycles(
    cos_o: np.ndarray, alpha: np.ndarray, eta: float, tint: np.ndarray, compensated: bool
) -> np.ndarray:
    """The same as Cycles estimates it, from tables: f0 + (1 - f0) times `layer_share_cycles`, as if single scattering lost nothing.

    What the compensation takes from coloured light is taken off again.
    """
    curve = tinted_dielectric(np.float64(eta), tint)
    albedo = curve.f0 + (1.0 - curve.f0) * layer_share_cycles(cos_o, alpha, eta)
    if not compensated:
        return albedo
    return albedo * multiple_scattering(cos_o, alpha, curve.average, CYCLES) * CYCLES[0](cos_o, alpha)


def beneath_layer(
    distribution: str,
    eta: float,
    tint: np.ndarray,
    roughness: np.ndarray,
    weight: np.ndarray,
    cos_wo: np.ndarray,
    tabulated: bool = False,
) -> np.ndarray:
    """1 - weight times the largest colour of the layer's albedo, (n,), at least 0.

    The largest, so that a tinted layer leaves no tint of its complement below (Blender's choice). `tabulated`: the albedo is Cycles'
    estimate.
    """
    alpha = np.clip(roughness, 0.0, 1.0) ** 2
    reflectance = layer_reflectance_cycles if tabulated else layer_reflectance
    albedo = reflectance(cos_wo, alpha, eta, tint, distribution == "MULTI_GGX")
    return np.maximum(1.0 - weight * albedo.max(axis=0), 0.0)


def coat_tint(ior: np.ndarray, tint: np.ndarray, weight: np.ndarray, cos_wo: np.ndarray) -> np.ndarray:
    """(1 - weight) + weight tint^(1 / cos), (3, n): Beer's law along the refracted view through a coat of thickness 1."""
    ior = np.maximum(ior, 1.0)
    inside = np.sqrt((ior - 1.0) * (ior + 1.0) + cos_wo * cos_wo) / ior
    return (1.0 - weight) + weight * np.maximum(tint, 0.0) ** (1.0 / inside)
