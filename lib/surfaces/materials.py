# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials prepared for shading.

Their lobes are sorted by what they do, and evaluated at surface points.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..bsdfs.mixture import Mixture
from ..bsdfs.toon import cone_half_angle
from ..departures.light_below import LIGHT_BELOW
from ..effects.facts import adding_lobes, is_zero
from ..microfacets.cycles_tables import Tables
from ..scene.expressions import WHITE, Expression, SurfaceNormal
from ..scene.materials import (
    Closure,
    Emission,
    Glass,
    GlossyToon,
    Material,
    Microfacets,
    Refraction,
    Subsurface,
    Translucent,
    Transparent,
)
from ..settings.reference import Options
from ..textures.evaluate import Evaluator, evaluate
from ..textures.fold import walk
from ..textures.images import ImageSet
from .lobes import Site, build
from .subsurface import DiskEntry, WalkEntry, make_entry, may_be_shallow
from .surface import SurfacePoints

# However little a lobe may reflect by its estimate, it is chosen this often.
_LEAST_ESTIMATE = 0.02


class PreparedMaterial:
    """One material, prepared to be evaluated at points.

    With `prunes` lobes that add nothing are left out.

    `shadows`: shadow rays take it for opaque. `only_bounds`: its faces do nothing but bound a volume.
    `tables`: those of Cycles, by which multiple scattering departs, or None.
    """

    def __init__(
        self, material: Material, images: ImageSet, options: Options, prunes: bool, tables: Tables | None = None
    ) -> None:
        self.name, self.unknown, self.passive = material.name, bool(material.unknown), material.passive
        self._images, self._options, self._tables = images, options, tables
        adding = adding_lobes(material) if prunes else material.lobes
        self._subsurface = [(x.weight, x.closure) for x in adding if isinstance(x.closure, Subsurface)]
        # Of a closure whose light all enters, nothing is left to reflect.
        lobes = [
            (x.weight, x.closure) for x in adding if not isinstance(x.closure, Subsurface) or may_be_shallow(x.closure)
        ]
        self._emissions = [(weight, closure) for weight, closure in lobes if isinstance(closure, Emission)]
        self._transparencies = [x for x in lobes if isinstance(x[1], Transparent)]
        self._scattering = [x for x in lobes if not isinstance(x[1], Emission | Transparent)]
        self.families = [closure.families for _, closure in self._scattering]
        self.emits = bool(self._emissions)
        self.only_bounds = material.only_bounds
        self.transparent = bool(self._transparencies) or self.only_bounds
        self.shadows = not material.transparent_shadows
        self.transmits = any(isinstance(closure, Glass | Refraction | Translucent) for _, closure in self._scattering)
        self.scatters = bool(self._scattering)
        self.enters = bool(self._subsurface)
        departs = LIGHT_BELOW in options.departures
        self._surface_normal = _surface_normal(closure for _, closure in self._scattering) if departs else None
        self.disperses = any(isinstance(x, Glass) and not is_zero(x.dispersion) for _, x in self._scattering)

    def _evaluate(self, expression: Expression, points: SurfacePoints) -> np.ndarray:
        return evaluate(expression, points, self._images)

    def _color(self, weight: Expression, closure: Closure, points: SurfacePoints) -> np.ndarray:
        """Colour times weight, (3, 1) or (3, n)."""
        return np.atleast_1d(self._evaluate(weight, points)) * self._evaluate(getattr(closure, "color", WHITE), points)

    def emission(self, points: SurfacePoints) -> np.ndarray:
        """Return the radiance that the surface emits towards the viewer, (3, 1) or (3, n).

        It is negative where the colour or the strength is.
        """
        total = np.zeros((3, 1))
        for weight, closure in self._emissions:
            strength = np.atleast_1d(self._evaluate(closure.strength, points))
            total = total + self._color(weight, closure, points) * strength
        return total

    def transparency(self, points: SurfacePoints) -> np.ndarray:
        """The factor on light that passes straight through, (3, 1) or (3, n)."""
        total = np.full((3, 1), float(self.only_bounds))
        for weight, closure in self._transparencies:
            total = total + self._color(weight, closure, points)
        return total

    def scattered_share(self, points: SurfacePoints) -> np.ndarray:
        """Return the mean colour of all that scatters, below the surface too, () or (n,).

        It is the weight of scattering beside transparency.
        """
        total = np.zeros(())
        for weight, closure in (*self._scattering, *self._subsurface):
            total = total + np.maximum(self._color(weight, closure, points), 0.0).mean(axis=0)
        return total

    def entries(
        self, points: SurfacePoints, wo: np.ndarray, t: np.ndarray, s: np.ndarray, n: np.ndarray
    ) -> tuple[list[WalkEntry | DiskEntry], np.ndarray, Site]:
        """Return what enters by each subsurface closure, what is reflected beside, and the site.

        What is reflected is an estimate, (n,). The site is that of both.

        The directions `wo` are local to the frame (t, s, n).
        """
        site = self._site(points, wo, t, s, n)
        reflected = np.zeros(points.size)
        for weight, closure in self._scattering:
            lobe, color = build(closure, site)
            size = np.maximum(np.atleast_1d(site.read(weight)) * color, 0.0).mean(axis=0)
            reflected = reflected + size * np.maximum(lobe.estimate, _LEAST_ESTIMATE)
        return [make_entry(weight, closure, site) for weight, closure in self._subsurface], reflected, site

    def alphas(self, points: SurfacePoints) -> np.ndarray:
        """Return the roughness squared of each scattering lobe, (lobes, n), as in `mixture`.

        It is inf for diffuse lobes.

        For a cone about the mirror direction it is the tangent of half its half angle: that of the facets that would
        reflect so far.
        """
        found = np.full((len(self._scattering), points.size), np.inf)
        for k, (_, closure) in enumerate(self._scattering):
            if isinstance(closure, GlossyToon):
                size, smooth = (self._evaluate(one, points) for one in (closure.size, closure.smooth))
                found[k] = np.tan(0.5 * cone_half_angle(size, smooth))
            elif isinstance(closure, Microfacets):
                found[k] = np.clip(self._evaluate(closure.roughness, points), 0.0, 1.0) ** 2
        return found

    def departing_normal(self, points: SurfacePoints) -> np.ndarray | None:
        """The normal (3, n) that a displacement's bump puts in the place of the shading normal, where that departs."""
        if self._surface_normal is None:
            return None
        return np.broadcast_to(self._evaluate(self._surface_normal, points), points.n.shape)

    def mixture(self, points: SurfacePoints, wo: np.ndarray, t: np.ndarray, s: np.ndarray, n: np.ndarray) -> Mixture:
        """Return the scattering lobes for local directions `wo` in the frame (t, s, n).

        A colour below 0 scatters nothing, as in Cycles.
        """
        site = self._site(points, wo, t, s, n)
        lobes, colors = [], []
        for weight, closure in self._scattering:
            lobe, color = build(closure, site)
            lobes.append(lobe)
            colors.append(np.maximum(np.atleast_1d(site.read(weight)) * color, 0.0))
        return Mixture(lobes, colors, points.size)

    def _site(self, points: SurfacePoints, wo: np.ndarray, t: np.ndarray, s: np.ndarray, n: np.ndarray) -> Site:
        return Site(points, Evaluator(points, self._images), wo, t, s, n, self._options, self._tables)


def _surface_normal(closures: Iterable[Closure]) -> SurfaceNormal | None:
    """The normal that a displacement gives the surface of these closures, where it does."""
    normals = (getattr(closure, "normal", None) for closure in closures)
    nodes = (node for normal in normals if normal is not None for node in walk(normal))
    return next((node for node in nodes if isinstance(node, SurfaceNormal)), None)
