# SPDX-License-Identifier: GPL-3.0-or-later
"""Either side of a comparison: the renderer, and what it has rendered so far."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ..film.film import Film
from ..film.regions import RegionMoments, Regions
from ..film.rendering import Rendering
from ..film.windows import Windows
from ..progress import Progress


class Renderer(Protocol):
    """Either side: `settings` is what the report prints.

    `render` gives replicate number `replicate`, independent of all others, with `samples` per pixel, or of the pixels in `windows`
    alone. It raises Cancelled once `progress` says that the work is to end. `at_size` gives a renderer of the same view with fewer
    pixels, whose numbers divide its own.
    """

    name: str
    settings: dict[str, Any]

    def render(
        self,
        replicate: int,
        samples: int,
        progress: Progress = ...,
        windows: Windows | None = None,
    ) -> Rendering:
        """One replicate."""
        ...

    def at_size(self, width: int, height: int) -> Renderer:
        """The same view on a smaller raster."""


@dataclass(eq=False)
class Side:
    """One renderer's part: its `name` and `settings`, its film, and the moments of its regions."""

    name: str
    settings: dict[str, Any]
    film: Film
    regions: RegionMoments

    @classmethod
    def empty(cls, renderer: Renderer, regions: Regions, samples: int) -> Side:
        """A side before its first replicate."""
        film = Film.empty(*regions.shape, samples)
        return cls(renderer.name, dict(renderer.settings), film, RegionMoments(regions))

    @property
    def replicates(self) -> int:
        """How many it has rendered, of the whole image or of a part, counted by their weight."""
        return self.film.moments.most

    @property
    def whole(self) -> int:
        """How many it has rendered of the whole image."""
        return self.film.moments.least

    def exclude(self, pixels: np.ndarray, of: np.ndarray | None) -> None:
        """Leave `pixels` (height, width) out of the regions `of` (K,), or of all."""
        self.regions.exclude(pixels, self.film.moments, of)

    def add(self, rendering: Rendering, of: np.ndarray | None, weight: int = 1) -> None:
        """Take one replicate more, with `weight` times the usual samples, for the regions `of` (K,), or for all."""
        self.film.add(rendering, weight)
        self.regions.add(rendering.radiance, of, weight)
