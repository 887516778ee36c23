# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' own settings: each is read, set neutral, unable to change a still on the CPU, or refused.

Checked in Blender 4.5, 5.2 and 5.3. A setting that stands in no table must have its default.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from ...lib.errors import Refusal
from ..cycles import neutral

_PREVIEW = "steers the viewport"
_NOISE = "steers noise, memory or time, not the mean"
_DENOISING = "denoising is off"
_GUIDING = "path guiding is off"
_VOLUME = "volumes are refused"
_DICING = "adaptive subdivision is refused"
_OFF = "belongs to a setting that is off in the neutral state"
_PASS = "adds a pass or data beside the image"

READ: Mapping[str, frozenset[str]] = {
    "cycles": frozenset(
        [
            "max_bounces",
            "diffuse_bounces",
            "glossy_bounces",
            "transmission_bounces",
            "transparent_max_bounces",
            "dicing_camera",
            "seed",
        ]
    ),
    "light.cycles": frozenset({"is_portal"}),
}
"""By group: settings that the export or the renderer reads, sets per render, or refuses by name."""

IRRELEVANT: Mapping[str, Mapping[str, str]] = {
    "cycles": {
        _NOISE: "sample_offset sample_subset_length light_sampling_threshold direct_light_sampling_type use_light_tree"
        " min_light_bounces min_transparent_bounces debug_bvh_type debug_use_spatial_splits debug_use_hair_bvh"
        " debug_use_compact_bvh debug_bvh_time_steps debug_use_cpu_avx2 debug_use_cpu_sse42 debug_bvh_layout"
        " debug_use_cuda_adaptive_compile debug_use_optix_debug debug_use_hip_adaptive_compile"
        " debug_use_metal_adaptive_compile debug_use_texture_cache_eviction debug_texture_cache_preserve_unused tile_size",
        _PREVIEW: "preview_pause use_preview_denoising preview_denoiser preview_denoising_prefilter"
        " preview_denoising_quality preview_denoising_input_passes preview_denoising_start_sample"
        " preview_denoising_use_gpu preview_denoising_upscale_quality preview_samples preview_scrambling_distance"
        " use_preview_adaptive_sampling preview_adaptive_threshold preview_adaptive_min_samples"
        " volume_preview_step_rate preview_dicing_rate texture_limit texture_resolution ao_bounces",
        _DENOISING: "denoiser denoising_prefilter denoising_quality denoising_input_passes denoising_use_gpu",
        _GUIDING: "use_deterministic_guiding guiding_distribution_type guiding_directional_sampling_type"
        " use_surface_guiding surface_guiding_probability use_volume_guiding guiding_training_samples"
        " volume_guiding_probability use_guiding_direct_light use_guiding_mis_weights guiding_roughness_threshold",
        _VOLUME: "volume_bounces volume_step_rate volume_max_steps volume_biased",
        _DICING: "dicing_rate max_subdivisions offscreen_dicing_scale",
        _OFF: "adaptive_threshold adaptive_min_samples film_transparent_glass film_transparent_roughness filter_width"
        " camera_cull_margin distance_cull_margin rolling_shutter_type rolling_shutter_duration fast_gi_method"
        " ao_bounces_render bake_type",
    },
    "view_layer.cycles": {
        _PASS: "pass_debug_sample_count pass_render_time use_pass_volume_direct use_pass_volume_indirect"
        " use_pass_volume_scatter use_pass_volume_transmit use_pass_volume_majorant use_pass_shadow_catcher"
        " denoising_store_passes denoising_store_motion_passes denoising_pass_follow_reflections"
        " denoising_pass_use_albedo_roughness_weighting",
        _DENOISING: "use_denoising",
    },
    "object.cycles": {
        _OFF: "use_motion_blur use_deform_motion motion_steps use_camera_cull use_distance_cull ao_distance"
        " is_caustics_receiver",
        _DICING: "dicing_rate",
    },
    "light.cycles": {},
    "material.cycles": {
        _NOISE: "emission_sampling",
        _VOLUME: "volume_sampling volume_interpolation volume_step_rate homogeneous_volume",
    },
    "world.cycles": {
        _NOISE: "sampling_method sample_map_resolution",
        _VOLUME: "volume_sampling volume_interpolation volume_step_size homogeneous_volume",
    },
}
"""By group and reason: settings that cannot change the image of a still on the CPU."""

_NEUTRAL: Mapping[str, Iterable[str]] = {
    "cycles": neutral.CYCLES,
    "object.cycles": neutral.OBJECT_CYCLES,
    "light.cycles": neutral.LIGHT_CYCLES,
    "material.cycles": neutral.MATERIAL_CYCLES,
    "world.cycles": neutral.WORLD_CYCLES,
}


_undeclared: dict[str, tuple[str, ...]] = {}


def undeclared(group: str, settings: Any) -> tuple[str, ...]:
    """The properties of a group of settings that stand in no table; this Blender's, found once."""
    if group not in _undeclared:
        known = {"rna_type", "name", *READ.get(group, ()), *_NEUTRAL.get(group, ())}
        known.update(name for names in IRRELEVANT[group].values() for name in names.split())
        _undeclared[group] = tuple(p.identifier for p in settings.bl_rna.properties if p.identifier not in known)
    return _undeclared[group]


def refuse_undeclared(owner: str, group: str, settings: Any, refusals: list[Refusal]) -> None:
    """Append the settings that stand in no table and are not at their default."""
    for name in undeclared(group, settings):
        if _is_changed(settings, name):
            label = settings.bl_rna.properties[name].name
            refusals.append(Refusal(owner, f"Cycles' setting '{label}' ({name})", "set it back to its default"))


def _is_changed(settings: Any, name: str) -> bool:
    kind, value = settings.bl_rna.properties[name], getattr(settings, name)
    if kind.type == "COLLECTION":
        return len(value) > 0
    if kind.type == "POINTER":
        return value is not None
    if getattr(kind, "is_array", False):
        return tuple(value) != tuple(kind.default_array)
    # A dynamic enum has no default in its definition: it is changed once it was set.
    return settings.is_property_set(name) if kind.type == "ENUM" else value != kind.default
