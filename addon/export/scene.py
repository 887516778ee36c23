# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole export: one walk over what the render's depsgraph holds."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import replace

import bpy
import numpy as np

from ...lib.effects.facts import Facts
from ...lib.errors import EtalonError, Refusal
from ...lib.scene.checks import validate
from ...lib.scene.findings import Finding
from ...lib.scene.lights import Light
from ...lib.scene.materials import Material
from ...lib.scene.matrices import affine
from ...lib.scene.mesh import Mesh, Object
from ...lib.scene.placements import LocalMesh, Placements
from ...lib.scene.scene import Scene, Transport
from ...lib.textures.hashes import hash_words, unit
from ...lib.textures.requirements import requirements
from ...lib.textures.skipped_tiles import skipped_tiles
from ...lib.wavefront.refuse import refuse_combinations
from .camera import read_camera
from .displacement import Displacer, User, find_undisplaceable
from .holdouts import hold_out, is_catcher, is_holdout
from .lights import read_light
from .links import LinkTable
from .materials import DEFAULT_MATERIAL, read_material, read_occlusion_distance, read_world
from .mesh import faces_of, read_mesh
from .mesh_attributes import unreadable
from .missing_libraries import find_missing_libraries, refuse_missing
from .motion import check_blur, read_motion
from .nodes.images import ImageTable
from .nodes.passive import is_passive
from .refusals import is_invisible, raise_any, read_rays, refuse_object, refuse_settings, refuse_unscattered
from .set_aside import find_missing_images, find_set_aside


def export_scene(
    depsgraph: bpy.types.Depsgraph,
    camera: bpy.types.Object | None = None,
    max_bounces: int | None = None,
    partial: bool = False,
    set_frame: Callable[[float], None] | None = None,
) -> Scene:
    """The scene that `depsgraph` holds, seen through `camera` (the scene's active one).

    The depsgraph must be one that Blender made for a render (`with_render_depsgraph`): the viewport's has other modifier
    levels and visibility. `max_bounces` is the scene's unless given. With `partial`, materials that are not simulated are
    exported as unknown ones. With `set_frame`, which evaluates it at another time, the scene's motion blur is exported.
    Raises Refused with all that is not simulated, or EtalonError for bad input.
    """
    scene, layer = depsgraph.scene_eval, depsgraph.view_layer_eval
    if depsgraph.mode != "RENDER":
        raise EtalonError(f"{scene.name}: was evaluated for the viewport; export it from with_render_depsgraph")
    camera = scene.camera if camera is None else camera.evaluated_get(depsgraph)
    if camera is None:
        raise EtalonError(f"{scene.name}: the scene has no camera; add one and make it the active camera")
    bounces = scene.cycles.max_bounces if max_bounces is None else max_bounces
    refusals: list[Refusal] = []
    refuse_settings(scene, layer, refusals)
    is_moving = set_frame is not None and check_blur(depsgraph, refusals)
    surroundings = layer.world_override or scene.world
    images = ImageTable(scene.frame_current, read_occlusion_distance(surroundings))
    view = read_camera(camera, scene.render, refusals)
    world = read_world(surroundings if layer.use_sky else None, images, refusals)
    materials = MaterialTable(layer.material_override, images, refusals, partial)
    refuse_missing(depsgraph, refusals)
    links = LinkTable(depsgraph, refusals)
    lights = _read_things(depsgraph, materials, links, refusals)
    _check_meshes(depsgraph, materials)
    raise_any(refusals)
    mesh = _read_meshes(depsgraph, materials, links, images)
    if mesh.triangle_count == 0:
        raise EtalonError(f"{scene.name}: the scene has no faces to render; add an object with a surface")
    _check_tiles(mesh, materials)
    raise_any(refusals)
    result = Scene(
        name=scene.name,
        mesh=mesh,
        materials=materials.materials,
        lights=lights,
        world=world,
        camera=view,
        transport=Transport(
            bounces,
            max(Transport().transparent_max_bounces, scene.cycles.transparent_max_bounces),
            scene.cycles.volume_bounces,
        ),
        images=images.images,
        blender=bpy.app.version[:2],
        findings=_find(depsgraph, mesh, images, set_frame is not None),
    )
    validate(result)
    refuse_combinations(result)
    if Facts(result).turbid:
        refuse_unscattered(depsgraph)
    return _with_motion(result, depsgraph, set_frame) if is_moving else result


def _with_motion(scene: Scene, depsgraph: bpy.types.Depsgraph, set_frame: Callable[[float], None]) -> Scene:
    """The scene with what moves of it."""
    moving = replace(scene, motion=read_motion(depsgraph, set_frame, scene))
    validate(moving)
    return moving


def _find(depsgraph: bpy.types.Depsgraph, mesh: Mesh, images: ImageTable, wants_blur: bool) -> tuple[Finding, ...]:
    """The findings that only Blender's data show."""
    missing = find_missing_images(tuple(images.missing)), find_missing_libraries()
    return (*missing[0], *missing[1], *find_set_aside(depsgraph, mesh, wants_blur))


class MaterialTable:
    """Collects the materials of the objects' slots, each once, and gives each an index."""

    def __init__(
        self, override: bpy.types.Material | None, images: ImageTable, refusals: list[Refusal], partial: bool
    ) -> None:
        self._override = override
        self._partial = partial
        self._images = images
        self._refusals = refusals
        self._indices: dict[tuple[str | None, bool], int] = {}
        self._materials: list[Material] = []

    @property
    def materials(self) -> tuple[Material, ...]:
        """All materials so far, in the order of their indices."""
        return tuple(self._materials)

    def of_slots(self, instance: bpy.types.DepsgraphObjectInstance, layer: bpy.types.ViewLayer) -> np.ndarray:
        """(slots,) indices of the materials in the slots of an instance of a mesh object.

        Without slots there is one, for Blender's default material.
        """
        slots = [slot.material for slot in instance.object.material_slots] or [None]
        held_out = is_holdout(instance, layer)
        return np.array([self._index(self._override or material, held_out) for material in slots], np.int32)

    def refuse_on_mesh(self, index: int, refusal: Refusal) -> None:
        """Refuse what the material `index` asks of a mesh.

        Where only parts are compared, the material is left out instead.
        """
        if self._partial:
            # Without its node tree, it is not known whether it emits.
            self._materials[index] = Material(self._materials[index].name, (), refusal.what)
        else:
            self._refusals.append(refusal)

    def _index(self, material: bpy.types.Material | None, held_out: bool) -> int:
        key = None if material is None else material.name_full, held_out
        if key not in self._indices:
            if held_out:
                made = hold_out(self._materials[self._index(material, False)])
                if made.volume is not None:
                    what = "the volume of a holdout"
                    self._refusals.append(Refusal(f"material '{material.name}'", what, "switch the holdout off"))
            else:
                made = DEFAULT_MATERIAL if material is None else self._read(material)
            self._indices[key] = len(self._materials)
            self._materials.append(made)
        return self._indices[key]

    def _read(self, material: bpy.types.Material) -> Material:
        if not self._partial:
            return read_material(material, self._images, self._refusals)
        refusals: list[Refusal] = []
        read = read_material(material, self._images, refusals)
        if not refusals:
            return read
        what = ", ".join(dict.fromkeys(refusal.what.strip(" ,") for refusal in refusals))
        passive = is_passive(material, is_placed=read.displacement is not None)
        return Material(material.name, (), what, passive=passive, displacement=read.displacement)


def _read_things(
    depsgraph: bpy.types.Depsgraph, materials: MaterialTable, links: LinkTable, refusals: list[Refusal]
) -> tuple[Light, ...]:
    """The lights; on the way, every object's refusals and materials."""
    lights: list[Light] = []
    checked: set[tuple[int, ...]] = set()
    for instance in depsgraph.object_instances:
        thing = instance.object
        if instance.show_self and thing.type == "LIGHT":
            rays = read_rays(instance, depsgraph.view_layer_eval)
            light = read_light(thing, affine(instance.matrix_world), rays, links.links_of(thing), refusals)
            if light is not None:
                lights.append(light)
            continue
        if is_invisible(instance):
            continue
        refuse_object(instance, depsgraph, checked, refusals)
        if instance.show_self and isinstance(thing.data, bpy.types.Mesh):
            materials.of_slots(instance, depsgraph.view_layer_eval)
    return tuple(lights)


def _check_meshes(depsgraph: bpy.types.Depsgraph, materials: MaterialTable) -> None:
    """Refuse what materials ask of meshes and the export cannot give."""
    _check_attributes(depsgraph, materials)
    _check_displacement(depsgraph, materials)


def _check_attributes(depsgraph: bpy.types.Depsgraph, materials: MaterialTable) -> None:
    """Refuse attributes of meshes that a material of the mesh reads and the export cannot."""
    seen: set[tuple[int, tuple[int, ...]]] = set()
    for instance in _mesh_instances(depsgraph):
        thing = instance.object
        mesh = thing.data
        slots = tuple(materials.of_slots(instance, depsgraph.view_layer_eval).tolist())
        if (mesh.as_pointer(), slots) in seen:
            continue
        seen.add((mesh.as_pointer(), slots))
        for index in dict.fromkeys(slots):
            for name in sorted(requirements([materials.materials[index]]).attributes):
                found = unreadable(faces_of(thing), name)
                if found is not None:
                    materials.refuse_on_mesh(index, Refusal(f"mesh '{mesh.name}'", *found))
            volume = materials.materials[index].volume
            for name in volume.attributes if volume is not None else ():
                if name in faces_of(thing).attributes:
                    what = f"attribute '{name}', by which a heterogeneous volume varies,"
                    materials.refuse_on_mesh(index, Refusal(f"mesh '{mesh.name}'", what, "rename it"))


def _mesh_instances(depsgraph: bpy.types.Depsgraph) -> Iterator[bpy.types.DepsgraphObjectInstance]:
    """Every instance of a mesh that some ray may meet."""
    for instance in depsgraph.object_instances:
        if instance.show_self and isinstance(instance.object.data, bpy.types.Mesh) and not is_invisible(instance):
            yield instance


def _check_displacement(depsgraph: bpy.types.Depsgraph, materials: MaterialTable) -> None:
    """Refuse displacement of meshes for which it is not simulated."""
    if not any(material.displacement for material in materials.materials):
        return
    users: dict[int, list[User]] = defaultdict(list)
    for instance in _mesh_instances(depsgraph):
        slots = tuple(materials.of_slots(instance, depsgraph.view_layer_eval).tolist())
        read = tuple(materials.materials[k] for k in slots)
        user = User(instance.object, affine(instance.matrix_world), slots, read)
        users[instance.object.data.as_pointer()].append(user)
    for of_one_mesh in users.values():
        for index, refusal in list(find_undisplaceable(of_one_mesh)):
            materials.refuse_on_mesh(index, refusal)


def _check_tiles(mesh: Mesh, materials: MaterialTable) -> None:
    """Refuse tiles of images that Cycles does not load although faces show them."""
    for index, number in list(skipped_tiles(mesh, materials.materials)):
        what = f"tile {number} of an image, which faces reach over without a corner in it (Cycles does not load it),"
        remedy = "cut the faces at the tiles' borders"
        materials.refuse_on_mesh(index, Refusal(f"material '{materials.materials[index].name}'", what, remedy))


def _read_meshes(
    depsgraph: bpy.types.Depsgraph, materials: MaterialTable, links: LinkTable, images: ImageTable
) -> Mesh:
    """Every instance of every mesh.

    Each mesh is read once, with what the materials ask of it, and then displaced.
    """
    needed = requirements(materials.materials)
    placements, displace = Placements(), Displacer(materials.materials, images.images)
    read: dict[int, LocalMesh] = {}
    for instance in _mesh_instances(depsgraph):
        thing = instance.object
        mesh = thing.data
        # Addresses of evaluated meshes hold for as long as the depsgraph does.
        key = mesh.as_pointer()
        if key not in read:
            faces = faces_of(thing)
            # A polygon of n corners is n - 2 triangles.
            placements.require_room(thing.name, len(faces.vertices), len(faces.loops) - 2 * len(faces.polygons))
            read[key] = read_mesh(faces, thing.name, needed.uv_maps, needed.generated, needed.attributes)
        if read[key].triangles.shape[1]:
            layer = depsgraph.view_layer_eval
            item, slots = _object(instance, layer, links), materials.of_slots(instance, layer)
            placements.add(item, displace(read[key], thing, item, slots), slots)
    return placements.join(needed.uv_maps, needed.generated, needed.attributes)


def _object(instance: bpy.types.DepsgraphObjectInstance, layer: bpy.types.ViewLayer, links: LinkTable) -> Object:
    """The properties of an object that materials can read.

    An instance has its instancer's colour, and an index of its own.
    """
    thing = instance.object
    if instance.is_instance:
        random = np.array([instance.random_id & 0xFFFFFFFF], np.uint32)
    else:
        random = hash_words(np.array([_hash_of_name(thing.name)], np.uint32), np.zeros(1, np.uint32))
    return Object(
        thing.name,
        affine(instance.matrix_world),
        tuple((instance.parent or thing).color),
        thing.pass_index,
        float(unit(random)[0]),
        read_rays(instance, layer),
        *links.sets_of(instance),
        links.links_of(thing),
        is_catcher(instance, layer),
    )


def _hash_of_name(name: str) -> int:
    """Cycles' hash of a string, 32 bits of a polynomial in 37."""
    value = 0
    for byte in name.encode():
        value = (37 * value + byte) & 0xFFFFFFFF
    return value
