# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene prepared for tracing: acceleration structure, materials, light samplers."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ..bsdfs.split import Split
from ..departures.catalogue import refuse_absent
from ..departures.light_below import LIGHT_BELOW
from ..departures.scene import departed
from ..effects.names import Effect
from ..effects.plan import Plan
from ..errors import EtalonError
from ..film.light_passes import Family
from ..lights.build import light_sampler
from ..lights.by_place import LightGrid
from ..lights.environment import EnvironmentSampler
from ..lights.light import LightSampler, Meetable
from ..lights.selection import LightSelection
from ..lights.sky import SunnySampler, suns_of
from ..microfacets.cycles_tables import cycles_tables
from ..scene.lights import Light, Switches
from ..scene.mesh import Mesh
from ..scene.occlusion import with_few_rays
from ..scene.rays import FLAGS, SCATTERED
from ..scene.scene import Scene
from ..settings.reference import Options
from ..surfaces.materials import PreparedMaterial
from ..surfaces.surface import SurfacePoints, SurfaceTables
from ..textures.evaluate import evaluate
from ..textures.fold import fold_scene, is_constant
from ..textures.images import ImageSet
from .arrivals import MOST, arriving_shares
from .bevels import Bevels
from .bodies import Bodies, exit_materials, objects_entered
from .casters import Casters
from .catchers import catching_faces
from .coplanar import OTHER_FACE, CoplanarFaces, find_coplanar
from .coplanar_lights import LIGHTS_IN_ONE_PLANE, CoplanarLights
from .direction import Directions
from .emissive import EmissiveMesh, places_on
from .emitter_names import EmitterNames, name_emitters
from .media import Media
from .occlusion import Occluders
from .probes import Probes
from .refuse import refuse_combinations, refuse_strategy
from .sight import Sight

# Groups of faces that are chosen by place, of one emissive mesh and of all: a table has a column for each.
_MOST_GROUPS_OF_MESH, _MOST_GROUPS = 128, 256


class Kernel:
    """Everything that tiles share; read-only once made.

    `scene` is as it stands after the departures, folded where the plan prunes. `lights` are the samplers of light objects, then the
    environment's, then the emissive mesh's, as far as the plan calls for them; `selection` picks among them; `meetable` are the light
    objects that rays meet by themselves, with their numbers. `sky` is the constant
    world's radiance (3, 1), or None. `emissive` are the emissive faces, one sampler for those of the same switches.
    `one_sided`: all light leaves a face on the side from which it is seen. `caster` meets all faces; `sight` says which rays meet which.
    `coplanar` has the faces that overlap others, where rays meet these at distance 0, `other_faces` those that rays meet in place of
    others; both belong to departures. `media` are the volumes, where there are any. `bodies` are the objects
    that light scatters inside of, `disks` probe those that it leaves by a disk;
    `exit_of` (materials,) numbers the entry of `materials` that says what faces do where it leaves.
    `occluders` cast the rays of ambient occlusion, and `bevels` the probes of Bevel nodes, where shaders ask for them.
    With `apart`, emissive faces have a sampler for each object, so that each sampler is of one emitter.
    A kernel `like` this one of the same mesh shares what depends on the mesh alone.
    Which stages run is said by flow.py and light_choice.py.
    """

    def __init__(
        self, scene: Scene, plan: Plan, options: Options, like: Kernel | None = None, apart: bool = False
    ) -> None:
        refuse_absent(scene, options.departures)
        refuse_combinations(scene)
        refuse_strategy(scene, options.strategy)
        scene = departed(scene, options.departures)
        folded = with_few_rays(fold_scene(scene))
        self.scene, self.plan, self.options = folded if plan.prunes else scene, plan, options
        self.apart = apart
        same = like if like is not None and like.scene.mesh is scene.mesh else None
        self._casters = Casters(scene.mesh, scene.camera.world_from_camera[:, 3]) if same is None else same._casters
        self.caster = self._casters.whole
        self.media = (
            Media(self.scene, self._casters)
            if plan.needs(Effect.VOLUMES) or plan.needs(Effect.VOLUME_SCATTERING)
            else None
        )
        self.catchers = catching_faces(scene.mesh) if plan.needs(Effect.SHADOW_CATCHERS) else None
        self.tables = SurfaceTables(scene.mesh) if same is None else same.tables
        self.images = ImageSet(
            scene.images,
            decode_first="texture interpolation" not in options.departures,
            alpha_in_codes="alpha in code values" in options.departures,
        )
        tables = cycles_tables(scene.blender) if "multiple-scattering tables" in options.departures else None
        self.materials = [PreparedMaterial(m, self.images, options, plan.prunes, tables) for m in self.scene.materials]
        self.material_of = np.append(scene.mesh.material_index, -1).astype(np.int16)  # a miss, -1, reads the last entry
        if plan.needs(Effect.SUBSURFACE):
            self._add_bodies(scene.mesh)
        objects = self._light_objects()
        self.lights: list[LightSampler] = [sampler for _, sampler in objects]
        self.environment = self._environment() if plan.needs(Effect.ENVIRONMENT_TABLE) else None
        meshes = self._emissive_meshes() if plan.needs(Effect.MESH_LIGHTS) else []
        self.emissive = tuple(sampler for _, sampler in meshes)
        self.lights += [light for light in (self.environment, *self.emissive) if light is not None]
        self.sky: np.ndarray | None = None
        radiance = folded.world.radiance
        if is_constant(radiance) and plan.needs(Effect.CONSTANT_WORLD) and not plan.needs(Effect.ENVIRONMENT_WORLD):
            world = np.asarray(radiance.value, np.float64)
            self.sky = np.broadcast_to(world, (3,))[:, None]
        self._arrives: np.ndarray | None = None
        self._selection = LightSelection(self.lights, self._grid(like)) if self.lights else None
        self.meetable = _meetable([sampler for _, sampler in objects])
        switches = [(light, False) for light, _ in objects]
        switches += [(Switches(rays=scene.world.rays), False)] * (self.environment is not None)
        switches += [(one, True) for one, _ in meshes]
        delta = np.array([light.delta for light in self.lights], bool)
        self.sight = Sight(scene, plan, self._casters, switches, delta)
        self.occluders = Occluders(self.scene, self._casters) if plan.needs(Effect.AMBIENT_OCCLUSION) else None
        self.bevels = Bevels(self.scene, self.tables, self._casters) if plan.needs(Effect.BEVELS) else None
        lit_from_below = LIGHT_BELOW in options.departures
        self.coplanar = find_coplanar(scene.mesh, options.departures)
        self.other_faces = (
            CoplanarFaces(scene.mesh, of_two_materials=True) if OTHER_FACE in options.departures else None
        )
        of_lights = [light for light, _ in objects], [sampler for _, sampler in objects]
        self.coplanar_lights = CoplanarLights(*of_lights) if LIGHTS_IN_ONE_PLANE in options.departures else None
        self.one_sided = not lit_from_below and not any(m.transmits for m in self.materials)

    def _add_bodies(self, mesh: Mesh) -> None:
        """Prepare the objects that light scatters inside of, and the faces where it leaves."""
        self.bodies = Bodies(mesh, self.scene.materials)
        entered = objects_entered(mesh, self.scene.materials, by_disk=True)
        self.disks = Probes(mesh.object_index, self._casters, entered)
        made, numbers = exit_materials(self.scene.materials)
        self.exit_of = numbers + len(self.materials)
        self.materials += [PreparedMaterial(m, self.images, self.options, self.plan.prunes) for m in made]

    def _light_objects(self) -> list[tuple[Light, LightSampler]]:
        """The light objects with their samplers; a plan that prunes leaves out the black ones."""
        pairs = [(light, light_sampler(light, self.caster.radius)) for light in self.scene.lights]
        return [pair for pair in pairs if pair[1].power > 0.0 or not self.plan.prunes]

    def _emissive_meshes(self) -> list[tuple[Switches, EmissiveMesh]]:
        """Samplers of the emissive faces, one for each group of equal switches.

        Faces that no scattered ray meets are in none.
        """
        mesh, emits = self.scene.mesh, self._emits
        of_objects = [(thing.rays, thing.links, thing.name if self.apart else "") for thing in mesh.objects]
        kinds = sorted(set(of_objects), key=lambda one: (one[0], one[1].receivers, one[1].blockers, one[2]))
        kind = np.array([kinds.index(one) for one in of_objects] or [0])[mesh.object_index]
        parts = [
            (Switches(rays=kinds[k][0], links=kinds[k][1]), np.flatnonzero(emits & (kind == k)))
            for k in np.unique(kind[emits])
        ]
        most = max(min(_MOST_GROUPS // max(len(parts), 1), _MOST_GROUPS_OF_MESH), 1)
        return [
            (switches, EmissiveMesh(self.tables, self.materials, self.caster.planes, part, most))
            for switches, part in parts
            if switches.rays & SCATTERED
        ]

    def _grid(self, like: Kernel | None) -> LightGrid | None:
        """The grid by which lights and emissive faces are chosen; None where no choice depends on the place.

        It is that of a kernel `like` this one where the lights are the same.
        """
        vertices = self.scene.mesh.vertices
        chooses = self.selects and len(self.lights) > 1
        self._arrives = self._arriving(like) if chooses else None
        if vertices.size == 0 or not (chooses or any(mesh.parts.power.size > 1 for mesh in self.emissive)):
            return None
        bounds = np.stack([vertices.min(axis=1), vertices.max(axis=1)])
        is_lit = np.array([material.scatters and not material.emits for material in self.materials])
        dark = np.flatnonzero(is_lit[self.scene.mesh.material_index])
        places = places_on(self.scene.mesh, dark) if self.emissive and dark.size else None
        inputs = self.lights, bounds, self.caster.radius, places, self._arrives
        made = None if like is None or like._selection is None else like._selection.grid
        grid = made if made is not None and made.is_of(*inputs) else LightGrid(*inputs)
        chosen = [mesh.choose_by_place(grid, self.lights.index(mesh)) for mesh in self.emissive]
        return grid if grid.useful or any(chosen) else None

    def _arriving(self, like: Kernel | None) -> np.ndarray | None:
        """What part of each light nothing hides; None where there are too many to ask.

        It is known where a kernel `like` this one has the same mesh, camera and number of lights.
        """
        if len(self.lights) > MOST:
            return None
        known = None if like is None else like._arrives
        is_same = like is not None and like._casters is self._casters and like.scene.camera is self.scene.camera
        if is_same and known is not None and known.size == len(self.lights):
            return known
        clear = np.array([material.transparent and not material.shadows for material in self.materials])
        clear_faces = clear[self.scene.mesh.material_index] if clear.any() else None
        return arriving_shares(self.lights, self.caster, self.scene.camera, clear_faces)

    @property
    def selection(self) -> LightSelection:
        """What picks among the lights; raises ValueError where there are none."""
        if self._selection is None:
            raise ValueError("there is no light to select")
        return self._selection

    @property
    def selects(self) -> bool:
        """Whether there is a choice of lights.

        The plan says so, or emissive objects were separated.
        """
        return self.plan.needs(Effect.LIGHT_SELECTION) or (self.apart and len(self.lights) > 1)

    @property
    def _emits(self) -> np.ndarray:
        """Whether the faces emit, (t,) bool."""
        return np.array([m.emits for m in self.materials])[self.scene.mesh.material_index]

    @cached_property
    def emitters(self) -> EmitterNames:
        """The names of the emitters, for a kernel made with `apart`.

        Raises EtalonError where volumes emit light, or where there are too many emitters.
        """
        if self.media is not None and self.media.emits:
            raise EtalonError(
                "light that volumes emit is no lamp's and no object's; leave --lights out (probe: --no-lights)"
            )
        objects = [light for light, _ in self._light_objects()]
        faces = [sampler.triangles for sampler in self.emissive]
        return name_emitters(objects, self.scene.mesh, self._emits, faces, self.plan)

    def _environment(self) -> EnvironmentSampler | SunnySampler:
        """The sampler of a world that depends on the direction, its suns apart."""
        world = self.scene.world
        suns = suns_of(world.radiance)
        if suns:
            return SunnySampler(self.world, world.table_resolution, suns, self.caster.radius)
        return EnvironmentSampler(self.world, world.table_resolution, self.caster.radius)

    @cached_property
    def families(self) -> tuple[Family, ...]:
        """The families that the lobes of the materials belong to, and the volumes that scatter."""
        found = {family for material in self.materials for families in material.families for family in families}
        if self.plan.needs(Effect.VOLUME_SCATTERING):
            found.add(Family.VOLUME)
        return tuple(family for family in Family if family in found)

    def split(self, material: int, size: int) -> Split:
        """What parts the light of so many points of a material by family."""
        numbers = {family: k for k, family in enumerate(self.families)}
        lobes = [tuple(numbers[family] for family in families) for families in self.materials[material].families]
        return Split(lobes, len(numbers), size)

    @cached_property
    def has_unknown(self) -> bool:
        """Whether any material is not known."""
        return any(material.unknown for material in self.materials)

    @cached_property
    def is_passive(self) -> bool:
        """Whether there are unknown materials, all of which only send on light that they receive."""
        unknown = [material for material in self.materials if material.unknown]
        return bool(unknown) and all(material.passive for material in unknown)

    def is_unknown(self, triangle: np.ndarray) -> np.ndarray:
        """Whether the materials of triangles (n,) are not known, (n,) bool."""
        unknown = np.array([material.unknown for material in self.materials])
        return np.take(unknown, np.take(self.material_of, triangle))

    def is_counted(self, triangle: np.ndarray) -> np.ndarray:
        """Whether triangles (n,) count among the transparent ones that a ray passes, (n,) bool.

        Those that only bound volumes do not.
        """
        counted = np.array([not material.only_bounds for material in self.materials])
        return np.take(counted, np.take(self.material_of, triangle))

    def world(self, direction: np.ndarray, flags: np.ndarray | int = 0) -> np.ndarray:
        """The world's radiance from unit directions (3, n), as rays of these `flags` see it."""
        radiance = evaluate(self.scene.world.radiance, Directions(direction, flags), self.images)
        return np.broadcast_to(radiance, direction.shape)

    def shadow_transparency(self, points: SurfacePoints) -> np.ndarray:
        """What shadow rays carry straight through points of any materials, (3, n)."""
        factor = np.zeros((3, points.size))
        points.flags = FLAGS["SHADOW"]
        material = np.take(self.material_of, points.triangle)
        for k in np.unique(material):
            if self.materials[k].transparent and not self.materials[k].shadows:
                index = np.flatnonzero(material == k)
                factor[:, index] = self.materials[k].transparency(points.at(index))
        return factor


def _meetable(samplers: list[LightSampler]) -> list[tuple[int, Meetable]]:
    """The lights that rays meet by themselves, with their places among the `samplers`."""
    met = [(k, sampler) for k, sampler in enumerate(samplers) if not sampler.delta]
    found = [(k, sampler) for k, sampler in met if isinstance(sampler, Meetable)]
    if len(found) < len(met):
        raise TypeError("a light that is not a delta light lacks what rays ask it")
    return found
