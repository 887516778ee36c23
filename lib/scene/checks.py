# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a scene keeps the rules that its docstrings state.

Each defect is one line that names its owner.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from ..errors import SceneError
from ..plural import plural
from .camera import PANORAMAS, Camera
from .expressions import (
    Attribute,
    Constant,
    Coordinates,
    EnvironmentTexture,
    ImageTexture,
    RayCount,
    RayFlag,
    Undisplaced,
)
from .images import Image
from .lights import USUAL_FALLOFF, AreaLight, Cone, Light, PointLight, SphereLight, SpotLight, SunLight
from .materials import Emission, Transparent, WeightedClosure
from .mesh import FARTHEST, UNDISPLACED, UNDISPLACED_NORMAL, Mesh, near
from .motion import Motion
from .rays import COUNTS, COUNTS_OF_ALL_RAYS, COUNTS_OF_EMISSION, EVERY, FLAGS, STEADY_FLAGS
from .scene import Scene
from .sky import Sky, SunDisc
from .volumes import MOST_ANISOTROPY, Volume

_UNIT = 1e-3
_ENCODINGS = ("SRGB", "LINEAR", "DATA")
_INTENSITIES = ("intensity", "radiance", "emission", "irradiance")


def validate(scene: Scene) -> None:
    """Raise SceneError unless all arrays and numbers of `scene` keep their rules.

    The error names the object and its defect.
    """
    _check_mesh(scene.mesh, len(scene.materials))
    _check_camera(scene.camera)
    for light in scene.lights:
        _check_light(light)
        _check_rays(f"light '{light.name}'", light.rays)
    _check_rays("world", scene.world.rays)
    if scene.motion is not None:
        _check_motion(scene.motion, scene.mesh)
    for image in scene.images:
        _check_image(image)
    for material in scene.materials:
        _check_expressions(f"material '{material.name}'", material, scene)
        for lobe in material.lobes:
            _check_emission(f"material '{material.name}'", lobe)
        _check_volume(f"material '{material.name}'", material.volume)
    _check_expressions("world", scene.world, scene)
    _check_volume("world", scene.world.volume)
    _demand(min(scene.world.table_resolution) >= 1, "world", "its sampling table is empty")
    _demand(scene.transport.max_bounces >= 0, scene.name, "its number of bounces is negative")
    release = scene.blender is None or (len(scene.blender) == 2 and all(isinstance(n, int) for n in scene.blender))
    _demand(release, scene.name, f"its Blender release is {scene.blender}, not a major and a minor version")
    _demand(scene.transport.transparent_max_bounces >= 0, scene.name, "its number of transparent bounces is negative")


def _demand(holds: bool | np.bool_, owner: str, defect: str) -> None:
    if not holds:
        raise SceneError(f"{owner}: {defect}; repair it and export again")


def _check_rays(owner: str, rays: int) -> None:
    _demand(isinstance(rays, int) and 0 <= rays <= EVERY, owner, f"its mask of rays is {rays}, not of 0 to {EVERY}")


def _check_array(owner: str, name: str, array: np.ndarray, shape: tuple[int, ...], kinds: str) -> None:
    """Demand `shape`, one of the dtype `kinds`, and finite numbers."""
    _demand(array.shape == shape, owner, f"{name} has shape {array.shape}, not {shape}")
    _demand(array.dtype.kind in kinds, owner, f"{name} is of type {array.dtype}")
    _demand(array.dtype.kind != "f" or np.isfinite(array).all(), owner, f"{name} is not finite")


def _check_mesh(mesh: Mesh, materials: int) -> None:
    v, t = mesh.vertices.shape[-1], mesh.triangle_count
    for thing in mesh.objects:
        _check_array(f"object '{thing.name}'", "its transform", thing.world_from_object, (3, 4), "f")
        _check_rays(f"object '{thing.name}'", thing.rays)
        _demand(
            min(thing.receiver, thing.blocker) >= 0, f"object '{thing.name}'", "its set of linked objects is negative"
        )
    _check_array("mesh", "object_index", mesh.object_index, (t,), "i")
    _check_range("mesh", "object_index", mesh.object_index, len(mesh.objects))
    _check_array("mesh", "triangles", mesh.triangles, (3, t), "i")
    _check_range("mesh", "triangles", mesh.triangles, v)
    if mesh.vertices.shape == (3, v):
        _name_bad_vertices(mesh)
    _check_array("mesh", "vertices", mesh.vertices, (3, v), "f")
    _check_array("mesh", "material_index", mesh.material_index, (t,), "i")
    _check_range("mesh", "material_index", mesh.material_index, materials)
    _check_array("mesh", "smooth", mesh.smooth, (t,), "b")
    for name, uv in mesh.uvs.items():
        _check_array("mesh", f"UV map '{name}'", uv, (3, 2, t), "f")
    for name, values in mesh.attributes.items():
        _check_array("mesh", f"attribute '{name}'", values, (3, 6, t), "f")
    has_generated = mesh.generated.shape[-1] > 0
    _check_array("mesh", "generated", mesh.generated, (3, v if has_generated else 0), "f")
    has_normals = bool(mesh.smooth.any()) or mesh.corner_normals.shape[-1] > 0
    _check_array("mesh", "corner_normals", mesh.corner_normals, (3, 3, t if has_normals else 0), "f")
    length = np.einsum("kct,kct->kt", mesh.corner_normals, mesh.corner_normals)
    bad = (length == 0.0).any(axis=0)
    _demand(not bad.any(), _owner(mesh, bad), "a corner normal has no length")


def _name_bad_vertices(mesh: Mesh) -> None:
    bad = ~near(mesh.vertices)
    if bad.any():
        what = f"{plural(int(bad.sum()), 'coordinate')} of vertices not finite or beyond {FARTHEST:g}"
        _demand(False, _owner(mesh, bad.any(axis=0)[mesh.triangles].any(axis=0)), what)


def _owner(mesh: Mesh, triangles: np.ndarray) -> str:
    """The name of the object that the first of the marked triangles belongs to."""
    return f"object '{mesh.objects[mesh.object_index[np.argmax(triangles)]].name}'" if triangles.any() else "mesh"


def _check_range(owner: str, name: str, index: np.ndarray, count: int) -> None:
    _demand(index.size == 0 or (index.min() >= 0 and index.max() < count), owner, f"{name} leaves 0..{count - 1}")


def _check_camera(camera: Camera) -> None:
    _demand(camera.kind in ("PERSPECTIVE", "ORTHOGRAPHIC", *PANORAMAS), "camera", f"its kind is {camera.kind!r}")
    _demand(camera.width >= 1 and camera.height >= 1, "camera", "its image has no pixels")
    _check_array("camera", "plane_from_raster", camera.plane_from_raster, (2, 3), "f")
    _demand(np.linalg.det(camera.plane_from_raster[:, :2]) != 0.0, "camera", "its raster has no extent")
    _check_array("camera", "world_from_camera", camera.world_from_camera, (3, 4), "f")
    axes = camera.world_from_camera[:, :3]
    _demand(
        np.abs(axes.T @ axes - np.eye(3)).max() < _UNIT, "camera", "its axes are not at right angles and of unit length"
    )
    _demand(camera.clip_start < camera.clip_end, "camera", "its clip planes enclose nothing")
    _demand(0.0 < camera.field_of_view < math.inf, "camera", "its field of view is empty")
    _demand(all(map(math.isfinite, camera.polynomial)), "camera", "its polynomial is not finite")
    _demand(bool(camera.polynomial) or camera.kind != "FISHEYE_LENS_POLYNOMIAL", "camera", "its polynomial is missing")
    if camera.aperture is not None:
        lens = camera.aperture
        _demand(all(map(math.isfinite, _numbers(lens))), "camera", "its lens is not finite")
        _demand(lens.radius > 0.0 and lens.ratio > 0.0, "camera", "its lens has no extent")
        _demand(lens.blades == 0 or lens.blades >= 3, "camera", f"its lens has {lens.blades} blades")
        _demand(lens.focus_distance > 0.0, "camera", "its focus is not in front of it")


def _check_light(light: Light) -> None:
    owner = f"light '{light.name}'"
    _demand(
        isinstance(light, PointLight | SphereLight | SpotLight | SunLight | AreaLight), owner, "is of no known kind"
    )
    _demand(all(map(math.isfinite, _numbers(light))), owner, "is not finite")
    for name in _INTENSITIES:
        _demand(min(getattr(light, name, (0.0,))) >= 0.0, owner, f"its {name} is negative")
    _demand(light.falloff.power in (0, 1, 2) and light.falloff.smooth >= 0.0, owner, "its falloff is not known")
    if isinstance(light, SphereLight):
        _demand(light.radius > 0.0, owner, "its radius is not positive")
    elif isinstance(light, SpotLight):
        _demand(light.radius >= 0.0, owner, "its radius is negative")
        _check_cone(owner, light.cone)
    elif isinstance(light, SunLight):
        _check_unit(owner, light.direction)
        _demand(light.falloff == USUAL_FALLOFF, owner, "a sun is at no distance to fall off by")
        _demand(0.0 <= light.half_angle <= math.pi / 2.0, owner, "its angle leaves 0..180 degrees")
    elif isinstance(light, AreaLight):
        _check_unit(owner, light.normal)
        _demand(np.any(np.cross(light.edge_u, light.edge_v)), owner, "has no area")
        _demand(light.shape in ("RECTANGLE", "ELLIPSE"), owner, f"its shape is {light.shape!r}")
        _demand(0.0 < light.spread <= math.pi + _UNIT, owner, "its spread leaves 0..180 degrees")


def _check_cone(owner: str, cone: Cone) -> None:
    _check_unit(owner, cone.axis)
    _demand(-1e-6 <= cone.cos_half_angle < 1.0, owner, "its cone leaves 0..180 degrees")
    _demand(0.0 <= cone.blend <= 1.0, owner, "its blend leaves 0..1")


def _check_unit(owner: str, direction: tuple[float, float, float]) -> None:
    _demand(abs(math.hypot(*direction) - 1.0) < _UNIT, owner, "its direction is not of unit length")


def _check_motion(motion: Motion, mesh: Mesh) -> None:
    """Check that the keys belong to objects that are there.

    Those of objects that deform must have all vertices that the faces use, and normals where faces are smooth.
    """
    for what, keys in (("transform", motion.objects), ("vertex positions", motion.positions)):
        for index, values in keys.items():
            _demand(0 <= index < len(mesh.objects), "motion", f"it moves object {index}, which is not there")
            count = 4 if what == "transform" else np.unique(mesh.triangles[:, mesh.object_index == index]).size
            owner = mesh.objects[index].name
            _demand(len(values) >= 2, owner, f"its {what} has fewer than two keys")
            _check_array(owner, f"its {what} over time", values, (len(values), 3, count), "f")
    smooth = {index for index in motion.positions if mesh.smooth[mesh.object_index == index].any()}
    what = f"objects {sorted(smooth)} deform and have smooth faces, and {sorted(motion.normals)} have normals over time"
    _demand(motion.normals.keys() == smooth, "motion", what)
    for index, values in motion.normals.items():
        owner, what = mesh.objects[index].name, "its corner normals over time"
        shape = len(motion.positions[index]), 3, 3, int((mesh.object_index == index).sum())
        _check_array(owner, what, values, shape, "f")
        length = np.einsum("kcit,kcit->kct", values, values)
        _demand((np.abs(length - 1.0) < _UNIT).all(), owner, f"{what} are not of unit length")
    if motion.camera is not None:
        _demand(len(motion.camera) >= 2, "camera", "its motion has fewer than two keys")
        _check_array("camera", "its motion", motion.camera, (len(motion.camera), 3, 4), "f")


def _check_image(image: Image) -> None:
    owner = f"image '{image.name}'"
    _demand(image.encoding in _ENCODINGS, owner, f"its encoding is {image.encoding!r}")
    _demand(image.pixels.ndim == 3 and image.pixels.shape[2] == 4, owner, f"its pixels have shape {image.pixels.shape}")
    _demand(image.pixels.size > 0 and image.pixels.dtype.kind == "f", owner, "it has no pixels that are numbers")


def _check_expressions(owner: str, root: Any, scene: Scene) -> None:
    """Demand that all data that `root` reads exist, and that its constants are finite.

    The data are images, UV maps and generated coordinates.
    """
    for node in _nodes(root):
        if isinstance(node, ImageTexture | EnvironmentTexture | Sky | SunDisc):
            _demand(0 <= node.image < len(scene.images), owner, f"image {node.image} is not in the scene")
        elif isinstance(node, Constant):
            _demand(all(map(math.isfinite, _numbers(node))), owner, "a constant is not finite")
        elif isinstance(node, RayFlag):
            _demand(node.flag in FLAGS, owner, f"no ray is called '{node.flag}'")
        elif isinstance(node, RayCount):
            _demand(node.count in COUNTS, owner, f"nothing that rays count is called '{node.count}'")
            _demand(root is not scene.world, owner, "a world does not know how often a path has scattered")
        elif isinstance(node, Attribute):
            _demand(node.name in scene.mesh.attributes, owner, f"attribute '{node.name}' is missing")
        elif isinstance(node, Undisplaced):
            there = {UNDISPLACED, UNDISPLACED_NORMAL} <= scene.mesh.attributes.keys()
            _demand(there, owner, "the places of vertices before displacement are missing")
        elif isinstance(node, Coordinates) and root is not scene.world:
            _demand(node.kind != "UV" or node.uv_map in scene.mesh.uvs, owner, f"UV map '{node.uv_map}' is missing")
            there = scene.mesh.generated.shape[-1] > 0 or scene.mesh.triangle_count == 0
            _demand(node.kind != "GENERATED" or there, owner, "generated coordinates are missing")


def _check_emission(owner: str, lobe: WeightedClosure) -> None:
    """Demand that light samples and the rays that lobes choose see the same emission."""
    flags = (
        {node.flag for node in _nodes(lobe) if isinstance(node, RayFlag)} if isinstance(lobe.closure, Emission) else ()
    )
    _demand(set(flags) <= set(STEADY_FLAGS), owner, "its emission depends on the kind of ray")
    if isinstance(lobe.closure, Emission | Transparent):
        agreed = COUNTS_OF_ALL_RAYS if isinstance(lobe.closure, Transparent) else COUNTS_OF_EMISSION
        counted = {node.count for node in _nodes(lobe) if isinstance(node, RayCount)}
        _demand(counted <= set(agreed), owner, "its emission or transparency depends on how often a path has scattered")


def _check_volume(owner: str, volume: Volume | None) -> None:
    if volume is not None:
        _demand(all(map(math.isfinite, _numbers(volume))), owner, "its volume is not finite")
        coefficients = (*volume.absorption, *volume.emission, *(s for phase in volume.phases for s in phase.scattering))
        _demand(min(coefficients) >= 0.0, owner, "a coefficient of its volume is negative")
        turns = [abs(phase.anisotropy) for phase in volume.phases]
        _demand(max(turns, default=0.0) <= MOST_ANISOTROPY, owner, f"its anisotropy is beyond {MOST_ANISOTROPY}")


def _nodes(root: Any) -> Iterator[Any]:
    """Every dataclass instance below `root`, once, however often it is shared."""
    seen: set[int] = set()
    waiting = [root]
    while waiting:
        node = waiting.pop()
        if isinstance(node, tuple):
            waiting.extend(node)
        elif is_dataclass(node) and id(node) not in seen:
            seen.add(id(node))
            yield node
            waiting.extend(getattr(node, f.name) for f in fields(node))


def _numbers(node: Any) -> Iterator[float]:
    """Every number in a dataclass instance, its tuples and what it holds."""
    for one in _nodes(node):
        for f in fields(one):
            value = getattr(one, f.name)
            for number in value if isinstance(value, tuple) else (value,):
                if isinstance(number, int | float):
                    yield float(number)
