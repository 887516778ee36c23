# SPDX-License-Identifier: GPL-3.0-or-later
"""The world: radiance from every direction that leaves the scene."""

from __future__ import annotations

from dataclasses import dataclass

from .expressions import BLACK, Expression
from .rays import SEEN
from .volumes import Volume


@dataclass(frozen=True)
class World:
    """The light and the medium around the scene.

    `radiance` is a colour expression of the direction ('GENERATED' coordinates), W m^-2 sr^-1.
    `table_resolution` (width, height) is that of the equirectangular sampling table; it only steers where samples go.
    `rays` is the mask of the rays that see the world (rays.py). `volume` fills all space, None: nothing does.
    """

    radiance: Expression = BLACK
    table_resolution: tuple[int, int] = (1024, 512)
    rays: int = SEEN
    volume: Volume | None = None
