# SPDX-License-Identifier: GPL-3.0-or-later
"""The truth of light between faces, in mpmath's arithmetic.

It follows the definitions; see exact.py.
"""

from __future__ import annotations

from mpmath import mp, mpf

from .exact import Values


def mean_transmittance(depth: mpf) -> Values:
    """The mean of exp(-x) from 0 to the depth."""
    return ((1 - mp.exp(-depth)) / depth,)


def free_path(depth: mpf, u: mpf) -> Values:
    """The inverse of the distribution (1 - exp(-depth t)) / (1 - exp(-depth)) of t in [0, 1]."""
    log = mp.log(1 - u * (1 - mp.exp(-depth)))  # pyright: ignore[reportAttributeAccessIssue]  mpmath adds it when loaded
    return (-log / depth,)


def distance_density(extinction: mpf, length: mpf, distance: mpf) -> Values:
    """Exponential, and 1 over the length."""
    return (extinction * mp.exp(-extinction * distance) / (1 - mp.exp(-extinction * length)),)


def _ends(along: mpf, beside: mpf, length: mpf) -> tuple[mpf, mpf]:
    """Under which angles the ends of a span are seen, from the place closest to the pivot."""
    ends = mp.atan(-along / beside), mp.atan((length - along) / beside)
    return ends  # pyright: ignore[reportReturnType]  its stub allows complex values


def angle(along: mpf, beside: mpf, length: mpf) -> Values:
    """The difference of the two."""
    first, last = _ends(along, beside, length)
    return (last - first,)


def equiangular(along: mpf, beside: mpf, length: mpf, u: mpf) -> Values:
    """Kulla and Fajardo 2012, eq. 6, from the origin on."""
    first, last = _ends(along, beside, length)
    return (along + beside * mp.tan(first + u * (last - first)),)


def equiangular_density(along: mpf, beside: mpf, length: mpf, share: mpf) -> Values:
    """Kulla and Fajardo 2012, eq. 5, at a share of the length."""
    first, last = _ends(along, beside, length)
    return (beside / ((last - first) * (beside**2 + (share * length - along) ** 2)),)
