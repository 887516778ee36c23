# SPDX-License-Identifier: GPL-3.0-or-later
"""The state of the paths that are still under way."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..scene.rays import COUNTS
from ..vectors import gather


@dataclass
class Paths:
    """Rays to be traced and what they carry; all arrays over the same n paths.

    pixel, sample: indices within the tile, intp. origin, direction, throughput (3, n). pdf (n,): the density with which the direction was
    sampled, inf for camera rays and delta lobes. `scatterings`: how often each has scattered, one number where all have as often.
    The next three are kept only where surfaces can be transparent, else
    None: the point of the last scattering, the distance travelled since, the number of surfaces passed. The next
    two are kept only where an index depends on the wavelength: the wavelength in nanometres, and whether the throughput still awaits
    its colour (bool). `ray_class` (n,), as sight.py has them, is kept only where rays of different kinds see different
    things. `depths` (3, n), how often each was reflected by diffuse and by other lobes and transmitted, is kept only where
    shaders ask. `left` (n,), the triangle that the ray left, -1 for none, and `left_uv` (2, n), its place there, are kept only where rays
    meet others in its plane. `receiver` (n,), the set of linked objects that scattered the ray, -1 for camera rays, is kept only where
    lights are linked. `medium` (n,), the number of what the ray is in (media.py), is kept only where there are volumes, and `in_volumes`
    (n,), how often each scattered in them, where they scatter. `cell` (n,), the cell of the grid of lights where each scattered last, is
    kept only where lights or their parts are chosen by place. `least_pdf` (n,), the least of all densities so far, is kept only where
    shaders average normals. `footprint` (n,), the radius of the pixel's cone in metres, and `spread` (n,), what it grows by for each metre,
    are kept only where shaders ask for the width of pixels. `at_camera` says that these are the camera rays themselves.
    """

    pixel: np.ndarray
    sample: np.ndarray
    origin: np.ndarray
    direction: np.ndarray
    throughput: np.ndarray
    pdf: np.ndarray
    scatterings: np.ndarray | int = 0
    scatter_origin: np.ndarray | None = None
    travelled: np.ndarray | None = None
    passed: np.ndarray | None = None
    wavelength: np.ndarray | None = None
    awaits_color: np.ndarray | None = None
    ray_class: np.ndarray | None = None
    depths: np.ndarray | None = None
    left: np.ndarray | None = None
    left_uv: np.ndarray | None = None
    receiver: np.ndarray | None = None
    medium: np.ndarray | None = None
    in_volumes: np.ndarray | None = None
    cell: np.ndarray | None = None
    least_pdf: np.ndarray | None = None
    footprint: np.ndarray | None = None
    spread: np.ndarray | None = None
    at_camera: bool = False

    @property
    def size(self) -> int:
        """Number of paths."""
        return self.pixel.shape[0]

    def may_scatter(self, most_bounces: int, volume_bounces: int) -> np.ndarray:
        """Which paths (n,) have not used up their bounces.

        The limits are `most_bounces` of all kinds, and `volume_bounces` in volumes.
        """
        may = np.less_equal(self.scatterings, most_bounces)
        return may if self.in_volumes is None else may & (self.in_volumes <= volume_bounces)

    def tally(self, distance: np.ndarray) -> np.ndarray:
        """Return the counts (len(COUNTS), n) that shaders ask for.

        They are those of rays that met something at `distance` (n,).
        """
        if self.depths is None:
            raise ValueError("these paths do not count")
        counts = np.broadcast_to(self.scatterings, distance.shape)
        passed = np.zeros(self.size) if self.passed is None else self.passed
        length = distance if self.travelled is None else self.travelled + distance
        return np.stack([counts, *self.depths, passed, length])

    def tally_of_shadows(self, index: np.ndarray) -> np.ndarray:
        """Return the counts (len(COUNTS), k) with which shadow rays leave where the paths at `index` scatter."""
        counts = self.tally(np.zeros(self.size))[:, index]
        counts[COUNTS.index("RAY_DEPTH")] += 1.0
        counts[COUNTS.index("RAY_LENGTH")] = 0.0
        return counts

    def take(self, index: np.ndarray) -> Paths:
        """The paths at `index`, as copies."""
        return replace(self, **{k: gather(a, index) for k, a in vars(self).items() if isinstance(a, np.ndarray)})

    @staticmethod
    def joined(first: Paths, second: Paths) -> Paths:
        """Both sets of paths, one after the other; camera rays only if both are."""
        if first.size == 0:
            return second
        pairs = {k: (a, getattr(second, k)) for k, a in vars(first).items()}
        both = {k: np.concatenate(ab, axis=-1) for k, ab in pairs.items() if isinstance(ab[0], np.ndarray)}
        return replace(first, **both, at_camera=first.at_camera and second.at_camera)
