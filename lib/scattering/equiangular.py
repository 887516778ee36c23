# SPDX-License-Identifier: GPL-3.0-or-later
"""Places along a ray at equal angles as seen from a pivot.

They are dense where the ray comes close to a small light.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..vectors import dot

_LEAST = 1e-6
"""Of the pivot's distance from the ray's start: how near the ray may come to the pivot before the density stops to grow."""


class Span(NamedTuple):
    """Parts of rays, from their origins on, as seen from pivots; (n,) each.

    `along` is where the ray comes closest to the pivot, and `beside` how close, in metres; `square` the squared distance of the pivot from
    the origin, and `angle` that between the part's ends.
    """

    along: np.ndarray
    beside: np.ndarray
    square: np.ndarray
    angle: np.ndarray


def make_span(origin: np.ndarray, direction: np.ndarray, length: np.ndarray, pivot: np.ndarray) -> Span:
    """The parts of rays (3, n) over `length` (n,), as seen from `pivot` (3, n).

    `length` may be infinite.
    """
    offset = pivot - origin
    along = dot(offset, direction)
    away = np.sqrt(dot(offset, offset))
    offset = offset - along * direction
    beside = np.maximum(np.sqrt(dot(offset, offset)), np.maximum(_LEAST * away, 1e-30))
    return Span(along, beside, along * along + beside * beside, angle(along, beside, length))


def angle(along: np.ndarray, beside: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Return the angle under which a pivot sees `length` metres of a ray, (n,).

    The other parameters are as in `Span`.

    By the tangent of a difference, which does not cancel where the part is short or far away.
    """
    finite = np.isfinite(length)
    near = np.where(finite, length, 0.0)
    ends = np.arctan2(near * beside, beside * beside - along * (near - along))
    return np.where(finite, ends, 0.5 * np.pi + np.arctan2(along, beside))


def sample(part: Span, u: np.ndarray) -> np.ndarray:
    """Distances (n,) from the origin, uniform in the angle, by uniforms `u` in [0, 1).

    Kulla and Fajardo 2012, eq. 6, with the angle counted from the origin: square sin x / (beside cos x + along sin x), x = u angle.
    """
    x = u * part.angle
    sine = np.sin(x)
    return part.square * sine / (part.beside * np.cos(x) + part.along * sine)


def density(part: Span, distance: np.ndarray) -> np.ndarray:
    """Return the density of `distance` (n,) in `sample`, per metre.

    Kulla and Fajardo 2012, eq. 5.
    """
    off = distance - part.along
    return part.beside / (part.angle * (part.beside * part.beside + off * off))
