# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' own properties, by group. Checked in Blender 4.5, 5.2 and 5.3."""

from __future__ import annotations

from collections.abc import Mapping

from ....lib.blender_versions import Versions
from ...cycles import neutral
from .known import Group

_PREVIEW = "steers the viewport"
_NOISE = "steers noise, memory or time, not the mean"
_DENOISING = "denoising is off"
_GUIDING = "path guiding is off"
_VOLUME = "steers volumes that vary, which are refused, or only their noise"
_DICING = "adaptive subdivision is refused"
_OFF = "belongs to a setting that is off in the neutral state"
_PASS = "adds a pass or data beside the image"

CYCLES_GROUPS: Mapping[str, Group] = {
    "cycles": Group(
        read="max_bounces diffuse_bounces glossy_bounces transmission_bounces volume_bounces transparent_max_bounces dicing_camera seed"
        " rolling_shutter_type",
        neutral={
            _NOISE: "sample_offset sample_subset_length light_sampling_threshold direct_light_sampling_type use_light_tree"
            " min_light_bounces min_transparent_bounces debug_bvh_type debug_use_spatial_splits debug_use_hair_bvh"
            " debug_use_compact_bvh debug_bvh_time_steps debug_use_cpu_avx2 debug_use_cpu_sse42 debug_bvh_layout"
            " debug_use_cuda_adaptive_compile debug_use_optix_debug debug_use_hip_adaptive_compile"
            " debug_use_metal_adaptive_compile debug_use_texture_cache_eviction debug_texture_cache_preserve_unused"
            " tile_size",
            _PREVIEW: "preview_pause use_preview_denoising preview_denoiser preview_denoising_prefilter"
            " preview_denoising_quality preview_denoising_input_passes preview_denoising_start_sample"
            " preview_denoising_use_gpu preview_denoising_upscale_quality preview_samples preview_scrambling_distance"
            " use_preview_adaptive_sampling preview_adaptive_threshold preview_adaptive_min_samples"
            " volume_preview_step_rate preview_dicing_rate texture_limit texture_resolution ao_bounces",
            _DENOISING: "denoiser denoising_prefilter denoising_quality denoising_input_passes denoising_use_gpu",
            _GUIDING: "use_deterministic_guiding guiding_distribution_type guiding_directional_sampling_type"
            " use_surface_guiding surface_guiding_probability use_volume_guiding guiding_training_samples"
            " volume_guiding_probability use_guiding_direct_light use_guiding_mis_weights guiding_roughness_threshold",
            _VOLUME: "volume_step_rate volume_max_steps volume_biased",
            _DICING: "dicing_rate max_subdivisions offscreen_dicing_scale",
            _OFF: "adaptive_threshold adaptive_min_samples film_transparent_glass film_transparent_roughness filter_width"
            " camera_cull_margin distance_cull_margin rolling_shutter_duration fast_gi_method"
            " ao_bounces_render bake_type",
        },
        held=neutral.CYCLES,
        versions={
            Versions(None, "4.5"): "feature_set",
            Versions("5.0"): "debug_texture_cache_preserve_unused debug_use_texture_cache_eviction texture_resolution"
            " texture_resolution_render use_pixel_jitter volume_biased",
            Versions("5.3"): "preview_denoising_upscale_quality",
        },
    ),
    "view_layer.cycles": Group(
        neutral={
            _PASS: "pass_debug_sample_count pass_render_time use_pass_volume_direct use_pass_volume_indirect"
            " use_pass_volume_scatter use_pass_volume_transmit use_pass_volume_majorant use_pass_shadow_catcher"
            " denoising_store_passes denoising_store_motion_passes denoising_pass_follow_reflections"
            " denoising_pass_use_albedo_roughness_weighting",
            _DENOISING: "use_denoising",
        },
        versions={
            Versions("5.0"): "denoising_pass_follow_reflections denoising_pass_use_albedo_roughness_weighting"
            " pass_render_time use_pass_volume_majorant use_pass_volume_scatter use_pass_volume_transmit",
            Versions("5.3"): "denoising_store_motion_passes",
        },
    ),
    "object.cycles": Group(
        read="use_motion_blur use_deform_motion motion_steps",
        neutral={
            _OFF: "use_camera_cull use_distance_cull ao_distance is_caustics_receiver",
            _DICING: "dicing_rate",
        },
        held=neutral.OBJECT_CYCLES,
        versions={Versions(None, "4.5"): "dicing_rate use_adaptive_subdivision"},
    ),
    "light.cycles": Group(read="is_portal max_bounces", held=neutral.LIGHT_CYCLES),
    "material.cycles": Group(
        neutral={
            _NOISE: "emission_sampling",
            _VOLUME: "volume_sampling volume_interpolation volume_step_rate homogeneous_volume",
        },
        held=neutral.MATERIAL_CYCLES,
        versions={Versions(None, "4.5"): "homogeneous_volume"},
    ),
    "world.cycles": Group(
        neutral={
            _NOISE: "sampling_method sample_map_resolution",
            _VOLUME: "volume_sampling volume_interpolation volume_step_size homogeneous_volume",
        },
        held=neutral.WORLD_CYCLES,
        versions={Versions(None, "4.5"): "homogeneous_volume"},
    ),
}
"""By group: what is known of it. `world.cycles.use_shadows` stands in no table on purpose: the reference has no such world."""
