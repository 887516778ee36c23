# SPDX-License-Identifier: GPL-3.0-or-later
"""Homogeneous volumes: media that absorb, scatter and emit light between faces."""

from __future__ import annotations

from dataclasses import dataclass

Color = tuple[float, float, float]

NOTHING: Color = (0.0, 0.0, 0.0)
MOST_ANISOTROPY = 0.999
"""Beyond it Cycles clamps the anisotropy (kernel/closure/volume_henyey_greenstein.h)."""


@dataclass(frozen=True)
class Phase:
    """Light that a volume scatters, by Henyey and Greenstein's phase function.

    `scattering` is in 1/m; `anisotropy` g is about the direction of flight.
    The mean cosine of the angle is g, in (-1, 1); 0 scatters evenly in all directions.
    """

    scattering: Color
    anisotropy: float = 0.0


@dataclass(frozen=True)
class Volume:
    """One material's inside, or the air of the world: coefficients of linear Rec. 709.

    `absorption` in 1/m; what `phases` scatter comes on top of it. `emission` in W m^-3 sr^-1: radiance for each metre.
    Meshes that have one of the `attributes` would vary it from place to place.
    """

    absorption: Color = NOTHING
    phases: tuple[Phase, ...] = ()
    emission: Color = NOTHING
    attributes: tuple[str, ...] = ()

    @property
    def scattering(self) -> Color:
        """What all phases scatter, 1/m."""
        red, green, blue = (sum((phase.scattering[k] for phase in self.phases), 0.0) for k in range(3))
        return red, green, blue

    @property
    def extinction(self) -> Color:
        """What is absorbed or scattered, 1/m."""
        red, green, blue = (a + s for a, s in zip(self.absorption, self.scattering, strict=True))
        return red, green, blue

    @property
    def is_empty(self) -> bool:
        """Whether light passes as through a vacuum."""
        return not any((*self.extinction, *self.emission))
