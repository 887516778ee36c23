# SPDX-License-Identifier: GPL-3.0-or-later
"""Camera paths that follow Dirac lobes and gather photons where anything else scatters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy

from ..light_tracing.adjoint import light_toward, see_from
from ..light_tracing.dirac import may_be_dirac
from ..sampling.sobol import RandomTile, SobolTile
from ..surfaces.surface import SurfacePoints
from ..vectors import dot
from ..wavefront.kernel import Kernel
from ..wavefront.pass_through import Groups
from ..wavefront.paths import Paths
from ..wavefront.shade import Shaded
from ..wavefront.sums import PixelSums, StageClock
from ..wavefront.trace import Tracer
from .photons import Photons

# Photons on faces that are turned further away than this cosine belong to another surface.
LEAST_AGREEMENT = 0.7
# The inner disc has half the area of the whole one.
INNER = 0.5


class GatherTracer(Tracer):
    """Path tracing through Dirac lobes, with a photon density estimate at finite lobes.

    The estimate uses the photons within `radius`.

    L(wo) = sum over photons of f(light, wo) |light.n| / |light.ng| flux / (pi radius^2) (Jensen 1996). `sums` has the
    image, `excess` the difference between it and the photons' part from discs of half the area, which tells the bias.
    """

    def __init__(
        self, kernel: Kernel, uniforms: SobolTile | RandomTile, sums: PixelSums, photons: Photons, radius: float
    ) -> None:
        super().__init__(kernel, uniforms, sums, StageClock())
        self._sampling = replace(self._sampling, runs=False)
        self._photons, self._radius = photons, radius
        self.excess = PixelSums(sums.nonfinite.size)
        closures = [lobe.closure for material in kernel.scene.materials for lobe in material.lobes]
        self._has_dirac = any(may_be_dirac(closure) for closure in closures)

    def _shade(self, paths: Paths, points: SurfacePoints, offset: np.ndarray, groups: Groups, step: int) -> Paths:
        """Gather; follow what Dirac lobes scatter."""
        self._gather(paths, points, groups)
        if not self._has_dirac:
            return paths.take(np.empty(0, np.intp))
        return super()._shade(paths, points, offset, groups, step)

    def _selected(self, paths: Paths, shaded: Shaded) -> Shaded:
        """What Dirac lobes scatter."""
        if shaded.weight is None:
            return shaded
        return replace(shaded, weight=np.where(np.isfinite(shaded.pdf), 0.0, shaded.weight))

    def _gather(self, paths: Paths, points: SurfacePoints, groups: Groups) -> None:
        near = scipy.spatial.KDTree(points.position.T).sparse_distance_matrix(
            self._photons.tree, self._radius, output_type="ndarray"
        )
        at, photon, distance = near["i"], near["j"], near["v"]
        front = points.ng * points.side
        before = np.broadcast_to(paths.scatterings, paths.pixel.shape)[at] + self._photons.scatterings[photon]
        kept = dot(front[:, at], self._photons.front[:, photon]) > LEAST_AGREEMENT
        kept &= before <= self._flow.most_bounces
        order = np.flatnonzero(kept)
        order = order[np.argsort(at[order], kind="stable")]
        at, photon, distance = at[order], photon[order], distance[order]
        for material, start, stop in groups:
            prepared = self._kernel.materials[material]
            a, b = np.searchsorted(at, [start, stop])
            if prepared.scatters and b > a:
                self._add(paths, points, material, (at[a:b], photon[a:b], distance[a:b]))

    def _add(
        self,
        paths: Paths,
        points: SurfacePoints,
        material: int,
        pairs: tuple[np.ndarray, np.ndarray, np.ndarray],
    ) -> None:
        """Add the light of pairs (point, photon, distance), (k,) each, of one material."""
        at, photon, distance = pairs
        here = points.at(at)
        value = light_toward(self._kernel.materials[material], see_from(here, self._photons.light[:, photon]), here.wo)
        value *= self._photons.flux[:, photon] * paths.throughput[:, at]
        value /= np.abs(dot(here.ng, here.wo)) * (np.pi * self._radius**2)  # `light_toward` is of an area across wo
        self._sums.add(paths.pixel[at], value)
        inside = distance * distance < INNER * self._radius**2
        self.excess.add(paths.pixel[at], value * np.where(inside, 1.0 - 1.0 / INNER, 1.0))
