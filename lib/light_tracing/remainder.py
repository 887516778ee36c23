# SPDX-License-Identifier: GPL-3.0-or-later
"""What light tracing leaves to path tracing.

These are emitters that the camera sees, and faces that send it light by a Dirac lobe.

The two share the paths by the first scattering that the camera sees. Where its density is finite, light tracing takes
the path; where it is a Dirac's, no point of the lens is ever in its direction, and path tracing takes it. Where there
is no scattering, path tracing does.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..sampling.sobol import RandomTile, SobolTile
from ..surfaces.surface import SurfacePoints
from ..wavefront.pass_through import Groups
from ..wavefront.paths import Paths
from ..wavefront.render import ReferenceRenderer
from ..wavefront.shade import Shaded
from ..wavefront.sums import PixelSums, StageClock
from ..wavefront.trace import Tracer
from .dirac import may_be_dirac


class RemainderRenderer(ReferenceRenderer):
    """Path tracing of what light tracing leaves out; see the file's docstring."""

    def tracer(self, uniforms: SobolTile | RandomTile, sums: PixelSums, clock: StageClock) -> Tracer:
        """What traces one tile."""
        return _RemainderTracer(self.kernel, uniforms, sums, clock)


class _RemainderTracer(Tracer):
    """Follows camera rays through Dirac lobes only, and from there all paths."""

    def _shade(self, paths: Paths, points: SurfacePoints, offset: np.ndarray, groups: Groups, step: int) -> Paths:
        """All that happens at the hits; nothing where no lobe is a Dirac's."""
        materials = self._kernel.scene.materials
        if not any(may_be_dirac(lobe.closure) for material in materials for lobe in material.lobes):
            return paths.take(np.empty(0, np.intp))
        return super()._shade(paths, points, offset, groups, step)

    def _selected(self, paths: Paths, shaded: Shaded) -> Shaded:
        """At the first scattering, what Dirac lobes scatter; after it everything."""
        first = np.broadcast_to(np.equal(paths.scatterings, 0), (paths.size,))
        direct = None if shaded.direct is None else np.where(first, 0.0, shaded.direct)
        weight = shaded.weight
        if weight is not None:
            weight = np.where(first & np.isfinite(shaded.pdf), 0.0, weight)
        return replace(shaded, direct=direct, weight=weight)
