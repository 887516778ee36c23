# SPDX-License-Identifier: GPL-3.0-or-later
"""Refusals, by name, of settings, objects and lights that are not simulated."""

from __future__ import annotations

import bpy

from ...lib.errors import Refusal, Refused
from ...lib.scene.rays import CAMERA, RAY_NAMES
from .properties.declared import refuse_undeclared

# Object types that Cycles renders and the reference does not.
UNSUPPORTED_TYPES = {
    "CURVES": "hair curves",
    "POINTCLOUD": "a point cloud",
    "VOLUME": "a volume",
    "GREASEPENCIL": "grease pencil",
    "GPENCIL": "grease pencil",
}
_LEAVE_OUT = "do not render it"
_SHOW_OBJECTS = "set Render As of its particles to Object, or do not render it"
# Blender converts hair, points and grease pencil to loose points and edges, which no renderer shows. These ways give faces.
_REMEDIES = {
    "CURVES": "give them faces (geometry nodes: Curve to Mesh with a Curve Circle as its profile), or do not render them",
    "POINTCLOUD": "put spheres in its place (geometry nodes: Instance on Points with an Ico Sphere), or do not render it",
}


def raise_any(refusals: list[Refusal]) -> None:
    """Raise Refused where there are refusals, each once."""
    if refusals:
        raise Refused(list(dict.fromkeys(refusals)))


def refuse_settings(scene: bpy.types.Scene, layer: bpy.types.ViewLayer, refusals: list[Refusal]) -> None:
    """Append the evaluated scene's and view layer's settings that are not simulated."""
    render = scene.render
    settings = {
        "Simplify": ("use_simplify", render.use_simplify),
        "stereoscopy": ("use_multiview", render.use_multiview),
    }
    owner = f"scene '{scene.name}'"
    for what, (name, on) in settings.items():
        if on:
            refusals.append(Refusal(owner, what, "switch it off", f"scene.render.{name}=false"))
    if hasattr(bpy.data, "colorspace"):  # since Blender 5.0
        refuse_undeclared("the file", "colorspace", bpy.data.colorspace, refusals)
    refuse_undeclared(owner, "scene", scene, refusals)
    refuse_undeclared(owner, "render", render, refusals)
    refuse_undeclared(owner, "cycles", scene.cycles, refusals)
    owner = f"view layer '{layer.name}'"
    if not layer.use_solid:
        refusals.append(Refusal(owner, "leaving out its surfaces", "include it again"))
    refuse_undeclared(owner, "view_layer", layer, refusals)
    refuse_undeclared(owner, "view_layer.cycles", layer.cycles, refusals)
    _refuse_layer_collections(layer.layer_collection, refusals)


def _refuse_layer_collections(collection: bpy.types.LayerCollection, refusals: list[Refusal]) -> None:
    """Append the unknown settings of a collection in the view layer, and of those in it."""
    refuse_undeclared(f"collection '{collection.name}'", "layer_collection", collection, refusals)
    for child in collection.children:
        _refuse_layer_collections(child, refusals)


def refuse_object(
    instance: bpy.types.DepsgraphObjectInstance,
    depsgraph: bpy.types.Depsgraph,
    checked: set[tuple[int, ...]],
    refusals: list[Refusal],
) -> None:
    """Append the parts of an object, mesh or not, or its instancer that are not simulated.

    `checked` collects the objects whose properties were checked: thousands of instances of one object are checked once.
    """
    thing = instance.object
    owner = f"object '{thing.name}'"
    if instance.show_particles and _has_strands(thing):
        # The emitter may have faces that are to be rendered: what leaves out the hair alone depends on its modifiers.
        refusals.append(Refusal(owner, "particle hair", _SHOW_OBJECTS))
    if not instance.show_self:
        return
    _refuse_properties(instance, owner, checked, refusals)
    kind = unsupported_kind(thing)
    if kind and not _is_empty(thing):
        hidden = f"{_path(thing)}.hide_render=true" if instance.parent is None else ""
        refusals.append(Refusal(owner, kind, _REMEDIES.get(thing.type, _LEAVE_OUT), hidden))
    elif isinstance(thing.data, bpy.types.Mesh) and _is_adaptive(thing, depsgraph.scene_eval):
        refusals.append(Refusal(owner, "adaptive subdivision", "switch it off"))


def _refuse_properties(
    instance: bpy.types.DepsgraphObjectInstance, owner: str, checked: set[tuple[int, ...]], refusals: list[Refusal]
) -> None:
    """Append changed properties of an object, its mesh and its instancer that no table has."""
    thing = instance.object
    # Blender shows each instance as a temporary copy of its object: only the original and the data have addresses that last.
    lasting = (thing.original, thing.data, instance.parent and instance.parent.original)
    key = tuple(0 if one is None else one.as_pointer() for one in lasting)
    if key in checked:
        return
    checked.add(key)
    refuse_undeclared(owner, "object", thing, refusals)
    refuse_undeclared(owner, "object.cycles", thing.cycles, refusals)
    if instance.parent is not None:
        refuse_undeclared(f"object '{instance.parent.name}'", "object", instance.parent, refusals)
    if isinstance(thing.data, bpy.types.Mesh):
        refuse_undeclared(f"mesh '{thing.data.name}'", "mesh", thing.data, refusals)


def read_rays(instance: bpy.types.DepsgraphObjectInstance, layer: bpy.types.ViewLayer) -> int:
    """The mask of the rays that meet the object or light.

    It and its instancer set the mask. Camera rays are removed where its collections are indirect only.
    """
    both = (instance.object, instance.parent or instance.object)
    rays = sum(bit for name, bit in RAY_NAMES.items() if all(getattr(one, f"visible_{name}") for one in both))
    return rays & ~CAMERA if both[1].indirect_only_get(view_layer=layer) else rays


def is_invisible(instance: bpy.types.DepsgraphObjectInstance) -> bool:
    """Whether no ray at all sees the object, so that Cycles leaves it out."""
    both = (instance.object, instance.parent or instance.object)
    return not any(all(getattr(one, f"visible_{ray}") for one in both) for ray in RAY_NAMES)


def refuse_unscattered(depsgraph: bpy.types.Depsgraph) -> None:
    """Raise Refused where rays that volumes scatter would miss something.

    They must meet all objects and lights, and see the world.
    """
    remedy = "switch it on"
    refusals = []
    for instance in depsgraph.object_instances:
        both = (instance.object, instance.parent or instance.object)
        if instance.show_self and not all(one.visible_volume_scatter for one in both) and not is_invisible(instance):
            what = "ray visibility Volume Scatter off, beside a volume that scatters,"
            refusals.append(Refusal(f"object '{instance.object.name}'", what, remedy))
    world = depsgraph.scene_eval.world
    if world is not None and not world.cycles_visibility.scatter:
        what = "ray visibility Volume Scatter off, beside a volume that scatters,"
        refusals.append(Refusal(f"world '{world.name}'", what, remedy))
    raise_any(refusals)


def refuse_light(light: bpy.types.Object, refusals: list[Refusal]) -> None:
    """Append a light's switches and kinds of light that are not simulated."""
    data = light.data
    cycles = data.cycles
    switches = {
        "shadow caustics": cycles.is_caustics_light,
    }
    owner = f"light '{light.name}'"
    refuse_undeclared(owner, "object", light, refusals)
    refuse_undeclared(owner, "light", data, refusals)
    refuse_undeclared(owner, "light.cycles", cycles, refusals)
    refusals.extend(Refusal(owner, what, "set it back to its default") for what, on in switches.items() if on)


def is_portal(data: bpy.types.Light) -> bool:
    """Whether a light shows Cycles where light of the world comes in, and gives none itself."""
    return data.type == "AREA" and data.cycles.is_portal


def _path(thing: bpy.types.Object) -> str:
    """The data path of an object, as `--set` takes it."""
    return f'objects["{bpy.utils.escape_identifier(thing.name)}"]'


def _is_adaptive(thing: bpy.types.Object, scene: bpy.types.Scene) -> bool:
    """Whether Cycles dices the object itself.

    That is a switch of the modifier; before Blender 5.0 it was an experimental one of the object.
    """
    surfaces = [one for one in thing.modifiers if one.type == "SUBSURF" and one.show_render]
    if bpy.app.version >= (5, 0, 0):
        return any(one.use_adaptive_subdivision for one in surfaces)
    return bool(surfaces) and thing.cycles.use_adaptive_subdivision and scene.cycles.feature_set == "EXPERIMENTAL"


def unsupported_kind(thing: bpy.types.Object) -> str | None:
    """The kind of a thing that Cycles or Blender would show and the reference would not.

    None where there is no such difference.
    """
    if thing.type in UNSUPPORTED_TYPES:
        return UNSUPPORTED_TYPES[thing.type]
    return "smoke" if _is_smoke(thing) else None


def _is_empty(thing: bpy.types.Object) -> bool:
    """Whether an evaluated object of curves or points has none left.

    Its modifiers then made something else of them.
    """
    return isinstance(thing.data, bpy.types.Curves | bpy.types.PointCloud) and not len(thing.data.points)


def refuse_smoke(scene: bpy.types.Scene) -> None:
    """Raise Refused where `scene` renders smoke.

    Call it before the scene is evaluated: Blender can crash on a simulation without its cache.
    """
    smoky = [thing for thing in scene.objects if not thing.hide_render and _is_smoke(thing)]
    if smoky:
        raise Refused(
            [Refusal(f"object '{x.name}'", "smoke", "do not render it", f"{_path(x)}.hide_render=true") for x in smoky]
        )


def _is_smoke(thing: bpy.types.Object) -> bool:
    domains = [
        one.domain_settings
        for one in thing.modifiers
        if one.type == "FLUID" and one.show_render and one.fluid_type == "DOMAIN"
    ]
    return any(settings is not None and settings.domain_type == "GAS" for settings in domains)


def _has_strands(thing: bpy.types.Object) -> bool:
    settings = [
        modifier.particle_system.settings
        for modifier in thing.modifiers
        if modifier.type == "PARTICLE_SYSTEM" and modifier.show_render
    ]
    return any(one.type == "HAIR" and one.render_type == "PATH" for one in settings)
