# SPDX-License-Identifier: GPL-3.0-or-later
"""Either side of a comparison: the renderer, and what it has rendered so far."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from ..film.film import Film, finite_pixels
from ..film.moments import Moments
from ..film.parts import Part
from ..film.regions import RegionMoments, Regions
from ..film.rendering import Rendering
from ..film.windows import Windows
from ..progress import Progress
from ..verdict.rare import describe_tails, is_steady, room_for_rare_light


class Replicates(Protocol):
    """What a comparison needs of either side: `settings` is what the report prints.

    `render` gives replicate number `replicate`, independent of all others, with `samples` per pixel, or of the pixels in `windows`
    alone. It raises Cancelled once `progress` says that the work is to end.
    """

    @property
    def name(self) -> str:
        """What the report calls it."""
        ...

    @property
    def settings(self) -> dict[str, Any]:
        """What the report prints."""
        ...

    def render(
        self,
        replicate: int,
        samples: int,
        progress: Progress = ...,
        windows: Windows | None = None,
    ) -> Rendering:
        """One replicate."""
        ...


class Renderer(Replicates, Protocol):
    """One whose image can still be chosen.

    `at_size` gives a renderer of the same view with fewer pixels, whose numbers divide its own; `with_passes` one whose images come with
    light passes.
    """

    def at_size(self, width: int, height: int) -> Renderer:
        """The same view on a smaller raster."""
        ...

    def with_passes(self, passes: Sequence[Part]) -> Renderer:
        """The same, with light passes."""
        ...


@dataclass(eq=False)
class Side:
    """One renderer's part: its `name` and `settings`, its film, and its regions' moments.

    Of each light pass that is compared, `passes` are the moments of the image and of the regions with a name,
    `pass_films` those of the pixels.
    """

    name: str
    settings: dict[str, Any]
    film: Film
    regions: RegionMoments
    passes: dict[Part, RegionMoments] = field(default_factory=dict)
    pass_films: dict[Part, Moments] = field(default_factory=dict)

    @classmethod
    def empty(cls, renderer: Replicates, regions: Regions, samples: int, passes: Sequence[Part] = ()) -> Side:
        """A side before its first replicate."""
        film = Film.empty(*regions.shape, samples)
        return cls(
            renderer.name,
            dict(renderer.settings),
            film,
            RegionMoments(regions),
            {name: RegionMoments(regions.named) for name in passes},
            {name: Moments.empty((*regions.shape, 3)) for name in passes},
        )

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
        for name, regions in self.passes.items():
            regions.exclude(pixels, self.pass_films[name], None if of is None else of[: len(regions.regions)])

    def rendered_apart(self, pixels: np.ndarray) -> np.ndarray:
        """The regions (K,) that some of these `pixels` (height, width) were rendered more or less often for than they count."""
        of_pixels, regions = self.film.moments.n, self.regions.regions
        apart = np.zeros(len(regions), bool)
        if not isinstance(of_pixels, np.ndarray):
            return apart
        shown = regions.weights[:, np.flatnonzero(pixels)].tocoo()
        row, column = shown.coords
        counts = np.broadcast_to(self.regions.moments.n, apart.shape)
        apart[row[of_pixels[pixels][column] != counts[row]]] = True
        return apart

    def add(self, rendering: Rendering, of: np.ndarray | None, weight: int = 1) -> None:
        """Add one replicate, with `weight` times the usual samples.

        It is added for the regions `of` (K,), or for all.
        """
        self.film.add(rendering, weight)
        if rendering.moments is not None:
            for regions in (self.regions, *self.passes.values()):
                regions.most_drawn = min(regions.most_drawn, rendering.moments / weight)
        self.regions.add(rendering.radiance, of, weight)
        where = None if rendering.windows is None else rendering.windows.mask
        for name, regions in self.passes.items():
            light = rendering.passes[name]
            light = np.where(finite_pixels(light)[..., None], light, np.nan)
            regions.add(light, None if of is None else of[: len(regions.regions)], weight)
            self.pass_films[name].add(light, where, weight)


def room_left_by(
    sides: tuple[Side, Side], cells: np.ndarray, level: float, bare: np.ndarray | bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """The relative difference (K,) that unmet light may make, and the samples (K,).

    No sample of both sides has met that light; the samples are those of the side with fewer. `cells` (K,) bool are the
    regions in which isolated bright samples are looked for; `level` is the chance that more is missing. Regions that
    are `bare` (K,), where no surface was seen, have no such samples as long as both sides are without noise there.
    """
    worth, least = 0.0, np.full(cells.shape, np.inf)
    steady = np.broadcast_to(bare, cells.shape)
    for side in sides:
        samples, series = side.regions.drawn(side.film.samples), side.regions.series
        tails = describe_tails(series[:, cells], samples[cells], side.regions.weights)
        worth = max(worth, float(tails.worth.max(initial=0.0)))
        least = np.minimum(least, samples * side.regions.moments.n)
        steady = steady & is_steady(series)
    return room_for_rare_light(np.where(steady, 0.0, worth), least, level), least
