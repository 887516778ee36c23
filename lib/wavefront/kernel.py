# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene made ready for tracing: acceleration structure, prepared materials, light samplers."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ..departures.catalogue import refuse_absent
from ..departures.scene import departed
from ..effects.plan import Plan
from ..lights.build import light_sampler, light_samplers
from ..lights.environment import EnvironmentSampler
from ..lights.selection import LightSelection
from ..lights.sky import SunnySampler, suns_of
from ..microfacets.cycles_tables import cycles_tables
from ..scene.scene import Scene
from ..surfaces.materials import PreparedMaterial
from ..surfaces.surface import SurfacePoints, SurfaceTables
from ..textures.evaluate import evaluate
from ..textures.fold import fold
from ..textures.images import ImageSet
from .camera_caster import CameraCaster
from .direction import Directions
from .emissive import EmissiveMesh
from .options import Options
from .raycaster import Raycaster


class Kernel:
    """Everything that tiles share; read-only once made.

    `lights` are the samplers of light objects, then the environment's, then the emissive mesh's, as far as the plan calls for them;
    `selection` picks among them. `sky` is the constant world's radiance (3, 1), or None. `lit_from_below` lets light sampling reach
    below smooth-shaded faces; `one_sided`: all light leaves a face on the side from which it is seen. `hides`: some objects hide
    from camera rays, whose `camera_caster` is another one then. The flags say which stages run. A kernel `like` this one of the same mesh
    shares what depends on the mesh alone.
    """

    def __init__(self, scene: Scene, plan: Plan, options: Options, like: Kernel | None = None) -> None:
        refuse_absent(scene, options.departures)
        scene = departed(scene, options.departures)
        self.scene, self.plan, self.options = scene, plan, options
        same_mesh = like is not None and like.scene.mesh is scene.mesh
        self.caster = like.caster if same_mesh else Raycaster(scene.mesh)
        self.hides = plan.needs("hidden objects")
        self.camera_caster = self.caster
        if self.hides:
            self.camera_caster = like.camera_caster if same_mesh else CameraCaster(scene.mesh)
        self.tables = like.tables if same_mesh else SurfaceTables(scene.mesh)
        self.images = ImageSet(scene.images, decode_first="texture interpolation" not in options.departures)
        tables = cycles_tables(scene.blender) if "multiple-scattering tables" in options.departures else None
        self.materials = [PreparedMaterial(m, self.images, options, plan.prunes, tables) for m in scene.materials]
        self.material_of = np.append(scene.mesh.material_index, -1).astype(np.int16)  # a miss, -1, reads the last entry
        radius = self.caster.radius
        if plan.prunes:
            self.lights = light_samplers(scene.lights, radius)
        else:
            self.lights = [light_sampler(light, radius) for light in scene.lights]
        self.sky: np.ndarray | None = None
        self.environment: EnvironmentSampler | SunnySampler | None = None
        self.asks_world = plan.needs("environment world")
        if plan.needs("environment table"):
            resolution, suns = scene.world.table_resolution, suns_of(scene.world.radiance)
            if suns:
                self.environment = SunnySampler(self.world, resolution, suns, radius)
            else:
                self.environment = EnvironmentSampler(self.world, resolution, radius)
            self.lights.append(self.environment)
        if plan.needs("constant world") and not self.asks_world:
            world = np.asarray(fold(scene.world.radiance).value, np.float64)
            self.sky = np.maximum(np.broadcast_to(world, (3,)), 0.0)[:, None]
        self.emissive: EmissiveMesh | None = None
        if plan.needs("mesh lights") and any(m.emits for m in self.materials):
            self.emissive = EmissiveMesh(self.tables, self.materials, self.caster.planes)
            self.lights.append(self.emissive)
        self.selection = LightSelection(self.lights) if self.lights else None
        self.light_is_delta = np.array([light.delta for light in self.lights], bool)
        # Light sampling is called for by lights that nothing else finds, and wherever it is one of the strategies.
        wanted = bool(self.light_is_delta.any()) or (bool(self.lights) and options.direct != "bsdf")
        self.samples_lights = wanted and plan.needs("light sampling")
        self.selects_lights = plan.needs("light selection") and bool(self.lights)
        self.weighs = options.direct == "mis" and plan.needs("multiple importance sampling")
        self.lit_from_below = "light below the face" in options.departures
        self.one_sided = not self.lit_from_below and not any(m.transmits for m in self.materials)
        self.asks_visibility = plan.needs("shadow rays") or self.lit_from_below
        self.has_choices = plan.needs("light selection") or plan.needs("several lobes")
        self.samples_lobes, self.last_rays = plan.needs("scattered rays"), plan.needs("last rays")
        self.last_hits, self.emission = plan.needs("last hits"), plan.needs("emission")
        self.second_hits, self.several_materials = plan.needs("second hits"), plan.needs("several materials")
        self.most_bounces = scene.transport.max_bounces if plan.needs("indirect light") else 0
        self.roulette = options.russian_roulette and plan.needs("Russian roulette")

    @cached_property
    def has_unknown(self) -> bool:
        """Whether any material is not known."""
        return any(material.unknown for material in self.materials)

    def is_unknown(self, triangle: np.ndarray) -> np.ndarray:
        """Whether the materials of triangles (n,) are not known, (n,) bool."""
        unknown = np.array([material.unknown for material in self.materials])
        return np.take(unknown, np.take(self.material_of, triangle))

    def world(self, direction: np.ndarray) -> np.ndarray:
        """The world's radiance from unit directions (3, n)."""
        radiance = evaluate(self.scene.world.radiance, Directions(direction), self.images)
        return np.broadcast_to(np.maximum(radiance, 0.0), direction.shape)

    def transparency(self, points: SurfacePoints) -> np.ndarray:
        """Straight-through factor at points of any materials, (3, n)."""
        factor = np.zeros((3, points.size))
        material = np.take(self.material_of, points.triangle)
        for k in np.unique(material):
            if self.materials[k].transparent:
                index = np.flatnonzero(material == k)
                factor[:, index] = self.materials[k].transparency(points.at(index))
        return factor
