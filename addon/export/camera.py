# SPDX-License-Identifier: GPL-3.0-or-later
"""The active camera as an affine map from the raster.

Sensor fit, shift, border and lens follow Cycles' rules.
"""

from __future__ import annotations

import math

import bpy
import numpy as np

from ...lib.errors import EtalonError, Refusal
from ...lib.scene.camera import PANORAMAS, Aperture, Camera
from ...lib.scene.matrices import affine, is_sheared
from ..host.frame import full_frame, rendered_region
from .properties.declared import refuse_undeclared

_KINDS = {"PERSP": "PERSPECTIVE", "ORTHO": "ORTHOGRAPHIC"}
_POLYNOMIAL = "FISHEYE_LENS_POLYNOMIAL"
_FISHEYES = ("FISHEYE_EQUIDISTANT", "FISHEYE_EQUISOLID", _POLYNOMIAL)

# Cycles' own lower bounds for the f-number and the focus distance.
_LEAST_FSTOP = 1e-5
_LEAST_FOCUS = 1e-5


def read_camera(camera: bpy.types.Object, render: bpy.types.RenderSettings, refusals: list[Refusal]) -> Camera | None:
    """Read the evaluated object `camera` for the raster that `render` describes.

    None where the camera is refused. With a render border the raster is the border's region alone, cropped or not, so
    that no pixel outside is simulated. Raises EtalonError when the object is no camera.
    """
    if camera.type != "CAMERA":
        raise EtalonError(f"{camera.name}: the scene looks through an object that is no camera; choose a camera object")
    data = camera.data
    owner = f"camera '{camera.name}'"
    before = len(refusals)
    refuse_undeclared(owner, "camera", data, refusals)
    refuse_undeclared(owner, "camera.dof", data.dof, refusals)
    kind = data.panorama_type if data.type == "PANO" else _KINDS.get(data.type)
    if kind is None:
        refusals.append(Refusal(owner, f"the lens type {data.type}", "make it perspective, orthographic or panoramic"))
    matrix = affine(camera.matrix_world)
    if not np.linalg.norm(matrix[:, :3], axis=0).all():
        refusals.append(Refusal(owner, "a scale of 0 along an axis", "give it a scale above 0"))
    elif is_sheared(matrix):
        refusals.append(Refusal(owner, "a sheared matrix", "apply the scale of its parents"))
    if len(refusals) > before:
        return None
    matrix[:, :3] /= np.linalg.norm(matrix[:, :3], axis=0)
    full_width, full_height = full_frame(render)
    left, bottom, width, height = rendered_region(render, full_width, full_height)
    plane = _panorama_plane if kind in PANORAMAS else _plane_from_raster
    return Camera(
        kind=kind,
        width=width,
        height=height,
        plane_from_raster=plane(data, render, full_width, full_height, left, bottom),
        world_from_camera=matrix,
        clip_start=data.clip_start,
        clip_end=data.clip_end,
        aperture=_aperture(data, matrix),
        field_of_view=data.fisheye_fov if kind in _FISHEYES else 2.0 * math.pi,
        polynomial=tuple(-getattr(data, f"fisheye_polynomial_k{k}") for k in range(5)) if kind == _POLYNOMIAL else (),
    )


def _plane_from_raster(
    data: bpy.types.Camera, render: bpy.types.RenderSettings, width: int, height: int, left: int, bottom: int
) -> np.ndarray:
    """(2, 3): raster to the plane at depth 1, or in metres for an orthographic camera."""
    extent = data.ortho_scale if data.type == "ORTHO" else _sensor(data) / data.lens
    scale = extent * _pixel(data, render, width, height)
    middle = np.array([width / 2 - left, height / 2 - bottom])
    offset = extent * np.array([data.shift_x, data.shift_y]) - scale * middle
    return np.column_stack([np.diag(scale), offset])


def _sensor(data: bpy.types.Camera) -> float:
    """The extent of the side of the sensor that is fitted, mm."""
    return data.sensor_height if data.sensor_fit == "VERTICAL" else data.sensor_width


def _pixel(data: bpy.types.Camera, render: bpy.types.RenderSettings, width: int, height: int) -> np.ndarray:
    """Width and height of a pixel as shares of the side that is fitted to the sensor."""
    aspect = np.array([render.pixel_aspect_x, render.pixel_aspect_y])
    size = aspect * (width, height)
    horizontal = data.sensor_fit == "HORIZONTAL" or (data.sensor_fit == "AUTO" and size[0] > size[1])
    return aspect / (size[0] if horizontal else size[1])


def _panorama_plane(
    data: bpy.types.Camera, render: bpy.types.RenderSettings, width: int, height: int, left: int, bottom: int
) -> np.ndarray:
    """(2, 3): raster to the plane that lib.scene.camera defines for the kind of panorama.

    The sensor's size matters for two of the fisheyes. A shift of 1 is the size of the frame.
    """
    size = np.array([width, height])
    sensor = _sensor(data) * _pixel(data, render, width, height) * size
    cylinder, half_fisheye = data.central_cylindrical_radius, 0.5 * data.fisheye_fov
    low, high = {
        "EQUIRECTANGULAR": ((data.longitude_min, data.latitude_min), (data.longitude_max, data.latitude_max)),
        "CENTRAL_CYLINDRICAL": (
            (data.central_cylindrical_range_u_min, data.central_cylindrical_range_v_min / cylinder),
            (data.central_cylindrical_range_u_max, data.central_cylindrical_range_v_max / cylinder),
        ),
        "EQUIANGULAR_CUBEMAP_FACE": ((-math.pi / 4.0,) * 2, (math.pi / 4.0,) * 2),
        "MIRRORBALL": ((-1.0, -1.0), (1.0, 1.0)),
        "FISHEYE_EQUIDISTANT": ((-half_fisheye,) * 2, (half_fisheye,) * 2),
        "FISHEYE_EQUISOLID": (-0.5 * sensor / data.fisheye_lens, 0.5 * sensor / data.fisheye_lens),
        _POLYNOMIAL: (-0.5 * sensor, 0.5 * sensor),
    }[data.panorama_type]
    low, high = np.array(low), np.array(high)
    scale = (high - low) / size
    offset = low + (high - low) * (data.shift_x, data.shift_y) + scale * (left, bottom)
    return np.column_stack([np.diag(scale), offset])


def _aperture(data: bpy.types.Camera, matrix: np.ndarray) -> Aperture | None:
    """The lens; None where everything is in focus.

    The focal length that the f-number divides is in millimetres in perspective. For an orthographic camera it is 1 m.
    """
    dof = data.dof
    if not dof.use_dof:
        return None
    fstop = max(dof.aperture_fstop, _LEAST_FSTOP)
    radius = (1.0 if data.type == "ORTHO" else data.lens * 1e-3) / (2.0 * fstop)
    blades = dof.aperture_blades if dof.aperture_blades >= 3 else 0
    focus = max(_focus_distance(dof, matrix), _LEAST_FOCUS)
    return Aperture(radius, blades, dof.aperture_rotation, dof.aperture_ratio, focus)


def _focus_distance(dof: bpy.types.CameraDOFSettings, matrix: np.ndarray) -> float:
    target = dof.focus_object
    if target is None:
        return dof.focus_distance
    position = affine(target.matrix_world)
    bone = target.pose.bones.get(dof.focus_subtarget) if target.pose else None
    point = position[:, 3] if bone is None else position[:, :3] @ np.array(bone.head) + position[:, 3]
    return abs(float((point - matrix[:, 3]) @ matrix[:, 2]))
