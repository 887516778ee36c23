# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that depend on the angle of view: Fresnel and Layer Weight."""

from __future__ import annotations

import numpy as np

from ..microfacets.fresnel import dielectric

_LEAST_INDEX = 1e-5


def fresnel_factor(ior: np.ndarray, cos_wo: np.ndarray, backfacing: np.ndarray) -> np.ndarray:
    """Return the exact dielectric reflectance at |n.wo| (n,) from the side of the viewer.

    Inside, the index is inverted.
    """
    ior = np.maximum(ior, _LEAST_INDEX)
    return dielectric(cos_wo, np.where(backfacing, 1 / ior, ior))


def layer_weight_fresnel(blend: np.ndarray, cos_wo: np.ndarray, backfacing: np.ndarray) -> np.ndarray:
    """Layer Weight's Fresnel: the index of refraction is 1 / (1 - blend)."""
    return fresnel_factor(1 / np.maximum(1 - blend, _LEAST_INDEX), cos_wo, backfacing)


def layer_weight_facing(blend: np.ndarray, cos_wo: np.ndarray) -> np.ndarray:
    """Return Layer Weight's Facing: 1 - |n.wo|^b.

    b goes from 0 through 1 at blend 0.5 to infinity at blend 1.
    """
    blend = np.clip(blend, 0.0, 1.0 - 1e-5)
    exponent = np.where(blend < 0.5, 2 * blend, 0.5 / (1 - blend))
    return 1 - cos_wo**exponent
