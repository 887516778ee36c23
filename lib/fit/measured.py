# SPDX-License-Identifier: GPL-3.0-or-later
"""Observations from a measured BRDF.

Directions cover its lobe, and the noise is estimated from the scatter of its table.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..errors import EtalonError
from ..measured.brdf import MeasuredBrdf
from ..measured.merl import SHAPE, TRUSTED_COSINE, Merl, directions_of_angles
from ..measured.read import read_measured
from ..vectors import dot
from .observations import Observations, plain_observations

DEFAULT_NOISE = 0.01
"""Taken for an RGL file, whose tables are smooth: their scatter says nothing about the measurement."""
_LEAST_NOISE = 1e-3
_HALF_ANGLES = 40
_AZIMUTHS = 8
_VIEWS = np.radians([5.0, 20.0, 35.0, 50.0, 65.0, 75.0])


def observe_brdf(path: Path, noise: float | None = None) -> Observations:
    """Values of a MERL or RGL file with the relative standard error `noise`.

    None: as the file's scatter shows. Raises EtalonError for a file that cannot be used, or without light.
    """
    brdf = read_measured(path)
    wi, wo = _merl_directions() if isinstance(brdf, Merl) else _directions(brdf)
    values = brdf.evaluate(wi, wo)
    if not np.isfinite(values).all():
        raise EtalonError(
            f"{path}: {np.count_nonzero(~np.isfinite(values)):,} values are missing; fetch the file again"
        )
    if noise is None:
        noise = scatter(brdf.values) if isinstance(brdf, Merl) else DEFAULT_NOISE
    return plain_observations(wi, wo, values, noise, not brdf.isotropic, str(path))


def scatter(values: np.ndarray) -> float:
    """Relative noise of a MERL table, at least 0.1 %.

    It comes from third differences along phi_d, where a BRDF is smooth. It is the median of |third difference| / mean
    of the four, over that of a normal variable of variance 1 + 9 + 9 + 1.
    """
    part = values[:, 2:60:4, 5:60:5]
    four = np.stack([part[..., k : 177 + k] for k in range(4)])
    third = np.abs(four[3] - 3.0 * four[2] + 3.0 * four[1] - four[0]) / np.maximum(four.mean(axis=0), 1e-300)
    usable = third[np.isfinite(third)]
    median = float(np.median(usable)) if usable.size else 0.0
    return max(median / (0.6745 * float(np.sqrt(20.0))), _LEAST_NOISE)


def _merl_directions() -> tuple[np.ndarray, np.ndarray]:
    """The middles of some cells of a MERL table.

    Both directions lie within 80 degrees of the normal.
    """
    k, d, p = (
        a.ravel() + 0.5
        for a in np.meshgrid(
            np.arange(0, SHAPE[0], 3), np.arange(2, SHAPE[1], 9), np.arange(5, SHAPE[2], 45), indexing="ij"
        )
    )
    wi, wo = directions_of_angles(np.square(k / 90.0) * 0.5 * np.pi, np.radians(d), np.radians(p))
    inside = np.flatnonzero((wi[2] > TRUSTED_COSINE) & (wo[2] > TRUSTED_COSINE))
    return wi[:, inside], wo[:, inside]


def _directions(brdf: MeasuredBrdf) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of directions whose half vectors lie densest about the normal.

    Views have all azimuths where these matter.
    """
    theta = 0.5 * np.pi * np.square((np.arange(_HALF_ANGLES) + 0.5) / _HALF_ANGLES)
    phi = 2.0 * np.pi * (np.arange(_AZIMUTHS) + 0.25) / _AZIMUTHS
    turns = np.zeros(1) if brdf.isotropic else np.radians([10.0, 50.0, 100.0, 140.0])
    view, turn, t, p = (a.ravel() for a in np.meshgrid(_VIEWS, turns, theta, phi, indexing="ij"))
    m = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)])
    wo = np.stack([np.sin(view) * np.cos(turn), np.sin(view) * np.sin(turn), np.cos(view)])
    wi = 2.0 * dot(wo, m) * m - wo
    inside = np.flatnonzero((wi[2] > TRUSTED_COSINE) & (dot(wo, m) > 0.0))
    return wi[:, inside], wo[:, inside]
