# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' least biased state, and the way back.

Every property that was changed returns, whatever happens in between. What each row does to the image was measured on
Cycles itself; a row that only changes the noise has no place here, except for those of scenes with one light.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np

from ...lib.errors import EtalonError

# The length of the sample sequence of a pixel. Persistent data keeps the first length it met, so it is one for all renders.
SEQUENCE = 8192

CYCLES = {
    "device": "CPU",
    "feature_set": "SUPPORTED",  # until 4.5: experimental dicing of meshes
    "shading_system": False,  # no OSL
    "use_adaptive_sampling": False,  # stops early where it happens to look converged
    "use_denoising": False,
    "time_limit": 0.0,
    "use_animated_seed": False,
    "sampling_pattern": "AUTOMATIC",
    "scrambling_distance": 1.0,
    "auto_scrambling_distance": False,
    "use_layer_samples": "IGNORE",
    "use_sample_subset": True,  # sample 0 of a pixel is its centre, in every seed
    "samples": SEQUENCE,
    "use_auto_tile": False,
    "sample_clamp_direct": 0.0,
    "sample_clamp_indirect": 0.0,
    "blur_glossy": 0.0,
    "caustics_reflective": True,
    "caustics_refractive": True,
    "use_guiding": False,
    "use_fast_gi": False,
    "pixel_filter_type": "BOX",  # the table of the others is off by up to 1/1023 pixel
    "use_pixel_jitter": False,
    "film_exposure": 1.0,
    "use_camera_cull": False,
    "use_distance_cull": False,
    "texture_limit_render": "OFF",
    "texture_resolution_render": 1.0,
}
ONE_LIGHT = {
    # With nothing to choose, the light tree costs a sixth of the time and saves no noise. Without it the threshold would count.
    "use_light_tree": False,
    "light_sampling_threshold": 0.0,
}
RENDER = {
    "engine": "CYCLES",
    "film_transparent": False,
    "use_simplify": False,
    "use_compositing": False,
    "use_sequencer": False,
    "use_freestyle": False,
    "use_multiview": False,
    "use_stamp": False,
    "use_render_cache": False,
    "use_texture_cache": False,  # reads textures from copies at lower resolutions, which blur them
    "use_auto_generate_texture_cache": False,
    "use_placeholder": False,
    "use_overwrite": True,
    "save_output": True,
    "use_file_extension": True,
    "use_crop_to_border": True,
    "dither_intensity": 0.0,
    "threads_mode": "FIXED",
}
MOTION_BLUR = {"use_motion_blur": False}
# In this order: setting the media type changes the format, and that the mode and the depth.
_IMAGE = {
    "media_type": "IMAGE",
    "file_format": "OPEN_EXR",
    "color_mode": "RGB",
    "color_depth": "32",
    "exr_codec": "NONE",
    "color_management": "FOLLOW_SCENE",
}
VIEW_LAYER = {"use_solid": True}
# With it, the image of a scene with shadow catchers has none of what the catchers show.
CATCHERS_APART = {"use_pass_shadow_catcher": True}
OBJECT = {
    # moves the origins of shadow rays on smooth meshes
    "shadow_terminator_geometry_offset": 0.0,
    "shadow_terminator_normal_offset": 0.0,
    "shadow_terminator_shading_offset": 0.0,
}
OBJECT_CYCLES = {
    "shadow_terminator_geometry_offset": 0.0,
    "shadow_terminator_offset": 0.0,
    "use_adaptive_subdivision": False,
    "is_caustics_caster": False,
}
_MODIFIER = {"use_adaptive_subdivision": False}
# Cycles takes a Bump node's slope from a difference over this share of a pixel, the default; files from before Blender 4.5 have 1.
BUMP_FILTER_WIDTH = float(np.float32(0.1))
MATERIAL_CYCLES = {"use_bump_map_correction": False}
LIGHT = {"use_soft_falloff": False}  # a disk turned to the shading point instead of a sphere
LIGHT_CYCLES = {"use_multiple_importance_sampling": True, "is_caustics_light": False}
WORLD_CYCLES = {"max_bounces": 1024, "is_caustics_light": False}


@dataclass
class Changes:
    """What was set and has to come back.

    `settings` maps each setting's path to its neutral value, whether or not it had to change (per object, material and light once);
    `refused` names the properties that would not take it, `held` lists what belongs to data with animation or drivers.
    """

    settings: dict[str, Any] = field(default_factory=dict)
    refused: list[str] = field(default_factory=list)
    held: list[tuple[Any, str, Any]] = field(default_factory=list)
    _before: list[tuple[Any, str, Any]] = field(default_factory=list)

    def remember(self, owner: Any, names: Iterable[str]) -> None:
        """Have the properties that `owner` has of `names` put back, the last of them first."""
        self._before.extend((owner, name, getattr(owner, name)) for name in names if hasattr(owner, name))

    def set(self, owner: Any, name: str, value: Any) -> None:
        """Give `owner` the value if it has such a property, and remember the one it had."""
        if getattr(owner, name, value) == value:
            return
        self.remember(owner, (name,))
        try:
            setattr(owner, name, value)
        except (AttributeError, TypeError, RuntimeError):
            self.refused.append(f"{owner.id_data.name}: {name}")

    def set_all(self, label: str, owners: Iterable[Any], values: dict[str, Any]) -> None:
        """Set each of `values` on each of `owners`; `label` starts its path in `settings`."""
        owners = list(owners)
        for name, value in values.items():
            known = False
            for owner in owners:
                if not hasattr(owner, name):
                    continue
                known = True
                self.set(owner, name, value)
                if owner.id_data.animation_data is not None:
                    self.held.append((owner, name, value))
            if known:
                self.settings[f"{label}.{name}"] = value

    def undo(self) -> None:
        """Put everything back, last change first.

        Data that was deleted meanwhile is left out.
        """
        while self._before:
            owner, name, value = self._before.pop()
            with suppress(ReferenceError):
                if getattr(owner, name) != value:
                    setattr(owner, name, value)


@contextmanager
def neutral(
    scene: bpy.types.Scene,
    *,
    max_bounces: int | None = None,
    threads: int | None = None,
    motion_blur: bool = False,
    one_light: bool = False,
) -> Iterator[Changes]:
    """Put Cycles into its least biased state for `scene`, and restore everything at the end.

    It is restored after an exception too.

    max_bounces: of a path, in Cycles' count, and of each kind of scattering; None: the scene's. threads: None: the
    scene's choice. motion_blur: keep the scene's motion blur, on or off, with its shutter. one_light: one light object is
    all that shines (lib/effects/light_sources.py), so that the light tree is switched off.

    May be nested: only what differs is touched. One `neutral` held around many renders keeps the
    scene's data in Cycles between them (persistent data), which costs memory and saves each its synchronisation.
    Export inside it too: some of what it sets (simplify, transparent bounces, adaptive subdivision) is seen by the
    exporter. Animation and drivers of what it sets are muted meanwhile. Raises EtalonError where a linked file does
    not let them be, or where there is no Cycles.
    """
    if not hasattr(scene, "cycles"):
        raise EtalonError("Cycles is not there; enable the add-on Cycles Render Engine in Blender's preferences")
    changes = Changes()
    try:
        _set_scene(changes, scene, scene.cycles.max_bounces if max_bounces is None else max_bounces, threads)
        _set_motion_blur(changes, scene.render, motion_blur)
        if one_light:
            changes.set_all("cycles", [scene.cycles], ONE_LIGHT)
        _set_data(changes)
        _mute_animation(changes)
        yield changes
    finally:
        changes.undo()


def _set_scene(changes: Changes, scene: bpy.types.Scene, max_bounces: int, threads: int | None) -> None:
    cycles, render = scene.cycles, scene.render
    if cycles.samples != SEQUENCE:
        changes.set(render, "use_persistent_data", False)
    changes.set_all("cycles", [cycles], CYCLES)
    bounces = ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces")
    changes.set_all("cycles", [cycles], dict.fromkeys(bounces, max_bounces))
    changes.set_all("cycles", [cycles], {"transparent_max_bounces": max(cycles.transparent_max_bounces, 64)})
    threads = render.threads if threads is None else threads
    changes.set_all("render", [render], RENDER | {"threads": threads})
    changes.remember(render.image_settings, reversed(_IMAGE))
    changes.set_all("image_settings", [render.image_settings], _IMAGE)
    changes.set_all("view_layer", scene.view_layers, VIEW_LAYER)
    # Lights have the flag by default; theirs says what the catchers show (Cycles' `Scene::has_shadow_catcher`).
    if any(thing.is_shadow_catcher and thing.type != "LIGHT" for thing in bpy.data.objects):
        changes.set_all("view_layer.cycles", (layer.cycles for layer in scene.view_layers), CATCHERS_APART)
    changes.set_all("render", [render], {"use_persistent_data": True})


def _set_motion_blur(changes: Changes, render: bpy.types.RenderSettings, keep: bool) -> None:
    """Switch motion blur off.

    With `keep`, leave it and the shutter as they are, safe from animation.
    """
    kept = {name: getattr(render, name) for name in ("use_motion_blur", "motion_blur_shutter", "motion_blur_position")}
    changes.set_all("render", [render], kept if keep else MOTION_BLUR)


def _set_data(changes: Changes) -> None:
    data = bpy.data
    changes.set_all("object", data.objects, OBJECT)
    changes.set_all("object.cycles", (o.cycles for o in data.objects), OBJECT_CYCLES)
    changes.set_all("modifier", (m for o in data.objects for m in o.modifiers), _MODIFIER)
    changes.set_all("Bump node.Filter Width", _filter_widths(), {"default_value": BUMP_FILTER_WIDTH})
    changes.set_all("material.cycles", (m.cycles for m in data.materials), MATERIAL_CYCLES)
    changes.set_all("light", data.lights, LIGHT)
    changes.set_all("light.cycles", (light.cycles for light in data.lights), LIGHT_CYCLES)
    changes.set_all("world.cycles", (w.cycles for w in data.worlds), WORLD_CYCLES)


def _filter_widths() -> Iterator[bpy.types.NodeSocket]:
    """The sockets Filter Width of all Bump nodes; there are none before Blender 4.5."""
    trees = (*(material.node_tree for material in bpy.data.materials), *bpy.data.node_groups)
    for node in (node for tree in trees if tree is not None for node in tree.nodes):
        if node.bl_idname == "ShaderNodeBump" and "Filter Width" in node.inputs:
            yield node.inputs["Filter Width"]


def _mute_animation(changes: Changes) -> None:
    """Mute the animation channels that would overwrite what was set.

    A render evaluates animation and drivers again.
    """
    for owner, name, value in changes.held:
        data = owner.id_data
        if data.animation_data is None:
            continue
        path = _data_path(owner, name)
        for curve in (*data.animation_data.drivers, *_curves(data)):
            if curve.data_path != path:
                continue
            changes.set(curve, "mute", True)
            if not curve.mute:  # of a linked library's action
                raise EtalonError(
                    f"{data.name}: {path} is animated or driven, and must stay at {value}; mute its channel"
                )


def _data_path(owner: Any, name: str) -> str:
    """The path of a property from its datablock.

    Blender does not find that of a view layer's settings of Cycles.
    """
    layers = getattr(owner.id_data, "view_layers", ())
    layer = next((one for one in layers if one.cycles == owner), None)
    return owner.path_from_id(name) if layer is None else f"{layer.path_from_id('cycles')}.{name}"


def _curves(data: bpy.types.ID) -> Iterator[bpy.types.FCurve]:
    """Yield the animation curves of a datablock's action and of its NLA strips.

    Actions have layers from Blender 4.4 on. There, `fcurves` are those of the first slot alone; from 5.0 on it is gone.
    """
    tracks = data.animation_data.nla_tracks
    actions = [data.animation_data.action, *(strip.action for track in tracks for strip in track.strips)]
    for action in filter(None, actions):
        if not hasattr(action, "layers"):
            yield from action.fcurves
        else:
            bags = (bag for layer in action.layers for strip in layer.strips for bag in strip.channelbags)
            yield from (curve for bag in bags for curve in bag.fcurves)
