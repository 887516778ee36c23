# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own properties of what the export reads, by kind of struct.

Checked in Blender 4.5, 5.2 and 5.3. Properties that every datablock has, those that an add-on registered, and
read-only values are in no table: they set nothing.
"""

from __future__ import annotations

from collections.abc import Mapping

from ....lib.blender_versions import Versions
from ...cycles import neutral
from .known import Group

_EDITING = "steers the viewport, the editors or the timeline"
_EEVEE = "belongs to other render engines"
_EVALUATED = "is in what Blender evaluates: matrices, instances, meshes"
_FILE = "steers how the image is written or shown, not its radiance"
_PASS = "adds a pass or data beside the image"
_OFF = "belongs to a setting that is refused or off in the neutral state"
_BAKING = "steers baking, which is not rendering"
_PHYSICS = "steers simulations, whose result Blender evaluates"

BLENDER_GROUPS: Mapping[str, Group] = {
    "colorspace": Group(
        values={"working_space": "Linear Rec.709"},
        neutral={"says where the color configuration comes from": "working_space_interop_id ocio_config_*"},
        versions={Versions("5.3"): "ocio_config_*"},
    ),
    "scene": Group(
        read="camera world render view_layers collection",
        neutral={
            _EDITING: "frame_start frame_end frame_step frame_preview_* use_preview_range lock_frame_selection_to_range"
            " show_subframe show_keys_from_selected_only sync_mode keying_sets keying_sets_all tool_settings unit_settings"
            " safe_areas timeline_markers transform_orientation_slots cursor grease_pencil annotation active_clip display"
            " time_jump_unit time_jump_delta allow_preroll playback_loop_mode wrap_timeline_navigation",
            _EVALUATED: "background_set objects frame_current frame_subframe frame_float",
            _FILE: "use_stamp_note node_tree use_nodes compositing_node_group compositor_effects sequence_editor"
            " view_settings display_settings sequencer_colorspace_settings",
            _PHYSICS: "use_custom_simulation_range simulation_frame_start simulation_frame_end rigidbody_world gravity"
            " use_gravity use_audio use_audio_scrub audio_*",
            _EEVEE: "eevee grease_pencil_settings hydra",
        },
        versions={
            Versions(None, "4.5"): "node_tree grease_pencil",
            Versions("5.0"): "time_jump_unit time_jump_delta allow_preroll playback_loop_mode compositing_node_group"
            " annotation",
            Versions("5.3"): "wrap_timeline_navigation compositor_effects",
        },
    ),
    "render": Group(
        read="resolution_x resolution_y resolution_percentage pixel_aspect_x pixel_aspect_y use_border border_min_x"
        " border_min_y border_max_x border_max_y threads use_persistent_data"
        " motion_blur_shutter motion_blur_position motion_blur_shutter_curve",
        neutral={
            _EDITING: "preview_pixel_size sequencer_gl_preview use_lock_interface",
            _EVALUATED: "frame_map_old frame_map_new fps fps_base",
            _FILE: "image_settings ffmpeg filepath ppm_factor ppm_base use_stamp_* stamp_* metadata_input"
            " use_single_layer compositor_* use_compositor_frames_cache use_sequencer_override_scene_strip",
            _OFF: "simplify_* use_simplify_normals views stereo_views views_format line_thickness_mode line_thickness",
            _EEVEE: "filter_size hair_type hair_subdiv use_high_quality_normals anisotropic_filter",
            _BAKING: "bake bake_* use_bake_*",
        },
        held=(*neutral.RENDER, *neutral.MOTION_BLUR),
        versions={
            Versions(None, "4.5"): "bake_* use_bake_*",
            Versions("5.0"): "anisotropic_filter save_output use_texture_cache use_auto_generate_texture_cache",
            Versions("5.3"): "use_compositor_frames_cache",
        },
    ),
    "view_layer": Group(
        read="use_sky material_override world_override use_motion_blur use_freestyle layer_collection objects depsgraph",
        neutral={
            _PASS: "use_pass_* pass_* aovs active_aov active_aov_index lightgroups active_lightgroup active_lightgroup_index",
            _OFF: "samples use_ao use_strand use_volumes use_grease_pencil freestyle_settings",
            _EVALUATED: "use",
            _EDITING: "active_layer_collection",
            _EEVEE: "eevee",
        },
        held=neutral.VIEW_LAYER,
    ),
    "layer_collection": Group(
        read="holdout indirect_only",
        neutral={_EVALUATED: "collection children exclude", _EDITING: "hide_viewport"},
    ),
    "object": Group(
        read="data material_slots matrix_world modifiers particle_systems pose pass_index color visible_camera"
        " visible_diffuse visible_glossy visible_transmission visible_shadow visible_volume_scatter is_holdout is_shadow_catcher light_linking",
        values={
            "type": "MESH CURVE SURFACE META FONT CURVES POINTCLOUD VOLUME GPENCIL GREASEPENCIL ARMATURE LATTICE EMPTY LIGHT"
            " LIGHT_PROBE CAMERA SPEAKER"
        },
        neutral={
            _EVALUATED: "parent parent_type parent_vertices parent_bone parent_bone_head_tail_factor"
            " use_parent_final_indices track_axis up_axis location rotation_* scale dimensions delta_* matrix_local"
            " matrix_basis matrix_parent_inverse constraints vertex_groups add_rest_position_attribute hide_render"
            " show_instancer_for_render instance_type use_instance_vertices_rotation use_instance_faces_scale"
            " instance_faces_scale instance_collection active_shape_key active_shape_key_index show_only_shape_key",
            _EDITING: "active_material active_material_index use_camera_lock_parent lock_* empty_* image_user"
            " show_empty_image_* use_empty_image_alpha hide_viewport hide_select hide_surface_pick"
            " show_instancer_for_viewport display_* display show_bounds show_name show_axis show_texture_space show_wire"
            " show_all_edges show_transparent show_in_front use_shape_key_edit_mode use_mesh_mirror_*"
            " animation_visualization motion_path",
            _PHYSICS: "field collision soft_body rigid_body rigid_body_constraint use_simulation_cache",
            _EEVEE: "hide_probe_* use_grease_pencil_lights shader_effects lineart",
            _PASS: "lightgroup",
            "steers the Raycast node, which is refused": "visible_raycast",
        },
        held=neutral.OBJECT,
        versions={Versions("5.0"): "parent_bone_head_tail_factor hide_surface_pick visible_raycast"},
    ),
    "light": Group(
        read="use_temperature color temperature_color use_shadow exposure normalize node_tree use_nodes energy"
        " shadow_soft_size spot_blend spot_size angle size size_y spread",
        values={"type": "POINT SUN SPOT AREA", "shape": "SQUARE RECTANGLE DISK ELLIPSE"},
        neutral={
            "goes into temperature_color": "temperature",
            "Cycles ignores it": "specular_factor diffuse_factor transmission_factor volume_factor",
            _EEVEE: "use_custom_distance cutoff_distance shadow_buffer_clip_start shadow_filter_radius"
            " shadow_maximum_resolution use_shadow_jitter shadow_jitter_overblur use_absolute_resolution shadow_cascade_*",
            _EDITING: "use_square show_cone",
        },
        held=neutral.LIGHT,
    ),
    "camera": Group(
        read="clip_start clip_end lens sensor_width sensor_height ortho_scale shift_x shift_y fisheye_fov fisheye_lens"
        " latitude_min latitude_max longitude_min longitude_max fisheye_polynomial_k0 fisheye_polynomial_k1"
        " fisheye_polynomial_k2 fisheye_polynomial_k3 fisheye_polynomial_k4 central_cylindrical_range_u_min"
        " central_cylindrical_range_u_max central_cylindrical_range_v_min central_cylindrical_range_v_max"
        " central_cylindrical_radius dof",
        values={
            "type": "PERSP ORTHO PANO CUSTOM",
            "sensor_fit": "AUTO HORIZONTAL VERTICAL",
            "panorama_type": "EQUIRECTANGULAR EQUIANGULAR_CUBEMAP_FACE MIRRORBALL FISHEYE_EQUIDISTANT FISHEYE_EQUISOLID"
            " FISHEYE_LENS_POLYNOMIAL CENTRAL_CYLINDRICAL",
        },
        neutral={
            "goes into lens": "angle angle_x angle_y lens_unit",
            _EDITING: "passepartout_alpha display_size show_* composition_guide_color background_images",
            _OFF: "stereo custom_*",
        },
        versions={Versions("5.0"): "composition_guide_color"},
    ),
    "camera.dof": Group(
        read="use_dof focus_object focus_subtarget focus_distance aperture_fstop aperture_blades aperture_rotation"
        " aperture_ratio"
    ),
    "world": Group(
        read="color light_settings node_tree use_nodes",
        neutral={
            _EEVEE: "use_eevee_finite_volume probe_resolution sun_threshold sun_angle use_sun_shadow"
            " sun_shadow_maximum_resolution sun_shadow_filter_radius use_sun_shadow_jitter sun_shadow_jitter_overblur",
            _PASS: "mist_settings lightgroup",
        },
    ),
    "world.cycles_visibility": Group(
        read="camera diffuse glossy transmission scatter",
        neutral={"Cycles ignores it": "shadow"},
    ),
    "material": Group(
        read="pass_index node_tree use_nodes diffuse_color use_transparent_shadow",
        values={"displacement_method": "BUMP DISPLACEMENT BOTH"},
        neutral={
            _EEVEE: "surface_render_method blend_method alpha_threshold use_transparency_overlap show_transparent_back"
            " use_backface_culling use_backface_culling_shadow use_backface_culling_lightprobe_volume"
            " use_raytrace_refraction use_screen_refraction use_sss_translucency refraction_depth thickness_mode"
            " use_thickness_from_shadow volume_intersection_method max_vertex_displacement line_color line_priority"
            " grease_pencil lineart",
            _EDITING: "preview_render_type use_preview_world texture_paint_* paint_active_slot paint_clone_slot"
            " specular_color roughness specular_intensity metallic",
        },
    ),
    "mesh": Group(
        read="vertices edges loops polygons vertex_normals corner_normals loop_triangles loop_triangle_polygons uv_layers"
        " attributes color_attributes texspace_location texspace_size materials",
        values={"normals_domain": "POINT FACE CORNER"},
        neutral={
            _EVALUATED: "polygon_normals vertex_colors skin_vertices shape_keys use_auto_texspace auto_texspace",
            _EDITING: "uv_layer_clone uv_layer_clone_index uv_layer_stencil uv_layer_stencil_index remesh_*"
            " use_remesh_* use_mirror_* use_paint_* radial_symmetry",
        },
        versions={Versions("5.0"): "radial_symmetry"},
    ),
    "image": Group(
        read="filepath packed_file pixels colorspace_settings",
        values={
            "source": "FILE SEQUENCE MOVIE GENERATED VIEWER TILED",
            "type": "IMAGE MULTILAYER UV_TEST RENDER_RESULT COMPOSITING",
            "alpha_mode": "STRAIGHT PREMUL CHANNEL_PACKED NONE",
            "file_format": "AVIF JPEG OPEN_EXR PNG WEBP BMP CINEON DPX IRIS JPEG2000 HDR TARGA TARGA_RAW TIFF"
            " OPEN_EXR_MULTILAYER FFMPEG",
        },
        neutral={
            "is in the pixels": "filepath_raw packed_files generated_* use_generated_float use_half_precision",
            _EDITING: "use_view_as_render display_aspect resolution render_slots tiles seam_margin",
            "belongs to views_format, which is refused": "stereo_3d_format",
        },
    ),
}
"""By kind of struct: what is known of it.

In no table on purpose, so that another value than the default is refused: a mesh's `texco_mesh` and `texture_mesh`, an image's
`use_multiview`, `views_format` and
`use_deinterlace`.
"""
