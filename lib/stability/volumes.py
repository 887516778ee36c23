# SPDX-License-Identifier: GPL-3.0-or-later
"""The catalogue of light between faces.

It has free paths in volumes, and places at equal angles about a light.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..scattering import equiangular
from ..scattering.free_path import distance_density, mean_transmittance, sample_distance
from . import closed_forms, domain, exact_volumes
from .measure import Function

FAMILY = "volumes"


def _depths(rng: np.random.Generator, count: int) -> np.ndarray:
    """Optical depths from 1e-14 to 500."""
    return 10.0 ** rng.uniform(-14.0, 2.7, (1, count))


def _paths(rng: np.random.Generator, count: int) -> np.ndarray:
    """An optical depth of at most 30, and a uniform."""
    return np.concatenate([10.0 ** rng.uniform(-14.0, 1.5, (1, count)), domain.uniforms(rng, count)])


def _distances(rng: np.random.Generator, count: int) -> np.ndarray:
    """An extinction, a length and a distance within it."""
    depth, length = _depths(rng, count)[0], 10.0 ** rng.uniform(-4.0, 4.0, count)
    return np.stack([depth / length, length, length * rng.random(count)])


def _spans(rng: np.random.Generator, count: int) -> np.ndarray:
    """Draw spans of rays near a pivot, (3, n).

    These are where a ray comes closest to it, before or behind its origin, how close, and the length that counts.
    """
    along = rng.choice([-1.0, 1.0], count) * 10.0 ** rng.uniform(-4.0, 4.0, count)
    return np.stack([along, 10.0 ** rng.uniform(-6.0, 4.0, count), 10.0 ** rng.uniform(-6.0, 4.0, count)])


def _placed(rng: np.random.Generator, count: int) -> np.ndarray:
    return np.concatenate([_spans(rng, count), rng.uniform(0.01, 0.99, (1, count))])


def _span(a: np.ndarray) -> equiangular.Span:
    along, beside, length = a[:3]
    return equiangular.Span(along, beside, along**2 + beside**2, equiangular.angle(along, beside, length))


def volumes() -> list[Function]:
    """All functions of volumes.

    Each row is a title, the arguments, where they are drawn, the kernel and the truth.
    """
    span = ("along", "beside", "length")
    rows: list[tuple[str, tuple[str, ...], Callable, Callable, Callable]] = [
        (
            "mean transmittance",
            ("depth",),
            _depths,
            lambda a: mean_transmittance(a[0]),
            exact_volumes.mean_transmittance,
        ),
        (
            "free path on a way",
            ("depth", "u"),
            _paths,
            lambda a: sample_distance(a[0], np.ones(a.shape[1]), a[1]),
            exact_volumes.free_path,
        ),
        (
            "density of free paths",
            ("extinction", "length", "distance"),
            _distances,
            lambda a: distance_density(*a),
            exact_volumes.distance_density,
        ),
        ("angle of a span", span, _spans, lambda a: equiangular.angle(*a), exact_volumes.angle),
        (
            "equiangular distance",
            (*span, "u"),
            _placed,
            lambda a: equiangular.sample(_span(a), a[3]),
            exact_volumes.equiangular,
        ),
        (
            "equiangular density",
            (*span, "share"),
            _placed,
            lambda a: equiangular.density(_span(a), a[2] * a[3]),
            exact_volumes.equiangular_density,
        ),
    ]
    return [Function(FAMILY, *row, closed_forms.BOUND) for row in rows]
