# SPDX-License-Identifier: GPL-3.0-or-later
"""A sky: its radiance as a table over the sphere, and the disc of its sun."""

from __future__ import annotations

from dataclasses import dataclass

from .expressions import Expression


@dataclass(frozen=True)
class SunDisc:
    """A limb-darkened disc of a sun.

    It is about `elevation` (radians above the horizon) and the sky's azimuth, `diameter` radians wide.
    Image `image` holds the radiance of its centre line in two texels, that of its lower edge and that of its upper
    edge. Its darkening is 1 - 0.6 (1 - sqrt(1 - r^2)), r the share of its radius. It adds to the sky, or `covers` it.
    """

    elevation: float
    diameter: float
    image: int
    covers: bool = False


@dataclass(frozen=True)
class Sky(Expression):
    """Radiance of a sky in direction `vector`.

    A table in image `image`, linear between texels, and the disc of a sun.
    The middle column looks along `azimuth` (radians from +x towards +y), which falls to the right. The row grows
    with the root of the elevation's magnitude on either side of the horizon, which lies between the two middle rows.
    """

    vector: Expression
    image: int
    azimuth: float
    sun: SunDisc | None = None
