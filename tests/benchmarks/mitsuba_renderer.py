# SPDX-License-Identifier: GPL-3.0-or-later
"""Mitsuba 3 as a renderer of lib.scene arrays.

It has flat triangles, Lambert and glossy lobes, area, sphere and constant light. Its Smith term is the product of two
G1, Cycles' and the reference's the height-correlated one, and its lights hide what is behind them: its image differs by
some per cent, so only its noise is compared. Lights in front of the camera are hidden where the world is black.
"""

from __future__ import annotations

import time

import drjit as dr
import mitsuba as mi
import numpy as np
from etalon.lib.errors import Refusal, Refused
from etalon.lib.film.rendering import Rendering
from etalon.lib.scene.expressions import Constant
from etalon.lib.scene.lights import AreaLight, Light, SphereLight
from etalon.lib.scene.materials import Diffuse, Glossy, Material
from etalon.lib.scene.scene import Scene
from etalon.lib.textures.fold import fold

_REMEDY = "leave this scene out of the benchmark"


def _constant(expression: object, owner: str) -> np.ndarray:
    folded = fold(expression)
    if not isinstance(folded, Constant):
        raise Refused([Refusal(owner, "a texture", _REMEDY)])
    return np.broadcast_to(np.asarray(folded.value, float), (3,))


def _rgb(values: object) -> dict:
    return {"type": "rgb", "value": [float(v) for v in values]}


def _bsdf(material: Material) -> dict:
    if len(material.lobes) != 1:
        raise Refused([Refusal(material.name, "a mixture of lobes", _REMEDY)])
    lobe = material.lobes[0]
    closure, weight = lobe.closure, _constant(lobe.weight, material.name)
    if isinstance(closure, Diffuse) and not _constant(closure.roughness, material.name).any():
        inner = {"type": "diffuse", "reflectance": _rgb(weight * _constant(closure.color, material.name))}
    elif isinstance(closure, Glossy) and closure.distribution in ("GGX", "BECKMANN") and not closure.is_anisotropic:
        inner = {
            "type": "roughconductor",
            "material": "none",
            "distribution": closure.distribution.lower(),
            "alpha": float(_constant(closure.roughness, material.name)[0]) ** 2,
            "specular_reflectance": _rgb(weight * _constant(closure.color, material.name)),
        }
    else:
        raise Refused([Refusal(material.name, type(closure).__name__, _REMEDY)])
    return {"type": "twosided", "bsdf": inner}


def _light(light: Light) -> dict:
    emitter = {"type": "area", "radiance": _rgb(light.radiance)} if hasattr(light, "radiance") else None
    if isinstance(light, AreaLight) and light.shape == "RECTANGLE" and light.spread >= np.pi:
        u, v, n = (np.asarray(a, float) for a in (light.edge_u, light.edge_v, light.normal))
        if np.dot(np.cross(u, v), n) < 0.0:
            v = -v
        matrix = np.eye(4)
        matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = u / 2, v / 2, n, light.center
        return {"type": "rectangle", "to_world": mi.ScalarTransform4f(matrix), "emitter": emitter}
    if isinstance(light, SphereLight):
        return {"type": "sphere", "center": list(light.position), "radius": light.radius, "emitter": emitter}
    raise Refused([Refusal(light.name, type(light).__name__, _REMEDY)])


def _sensor(scene: Scene, sampler: str) -> dict:
    camera = scene.camera
    if camera.kind not in ("PERSPECTIVE", "ORTHOGRAPHIC") or camera.aperture is not None:
        raise Refused([Refusal(scene.name, "its camera", _REMEDY)])
    _, y, z, origin = camera.world_from_camera.T
    to_world = mi.ScalarTransform4f().look_at(list(origin), list(origin - z), list(y))
    half_width = 0.5 * float(camera.plane_from_raster[0, 0]) * camera.width
    if camera.kind == "PERSPECTIVE":
        kind = {"type": "perspective", "fov": float(np.degrees(2.0 * np.arctan(half_width))), "fov_axis": "x"}
    else:
        kind = {"type": "orthographic"}
        to_world = to_world @ mi.ScalarTransform4f().scale([half_width, half_width, 1.0])
    return {
        **kind,
        "near_clip": camera.clip_start,
        "far_clip": camera.clip_end,
        "to_world": to_world,
        "film": {
            "type": "hdrfilm",
            "width": camera.width,
            "height": camera.height,
            "pixel_format": "rgb",
            "component_format": "float32",
            "rfilter": {"type": "box"},
        },
        "sampler": {"type": sampler},
    }


def _meshes(scene: Scene) -> dict[str, object]:
    mesh, found = scene.mesh, {}
    if mesh.smooth.any():
        raise Refused([Refusal(scene.name, "smooth shading", _REMEDY)])
    for k in np.unique(mesh.material_index):
        triangles = mesh.triangles[:, mesh.material_index == k]
        used, index = np.unique(triangles, return_inverse=True)
        properties = mi.Properties()
        properties["bsdf"] = mi.load_dict(_bsdf(scene.materials[k]))
        made = mi.Mesh(f"material{k}", used.size, triangles.shape[1], props=properties)
        parameters = mi.traverse(made)
        parameters["vertex_positions"] = mesh.vertices[:, used].T.astype(np.float32).ravel()
        parameters["faces"] = index.reshape(triangles.shape).T.astype(np.uint32).ravel()
        parameters.update()
        found[f"material{k}"] = made
    return found


class MitsubaRenderer:
    """One variant of Mitsuba with one sampler; its replicates are its seeds."""

    def __init__(self, scene: Scene, variant: str, sampler: str, threads: int) -> None:
        self._variant, self._size = variant, (scene.camera.height, scene.camera.width)
        self.name = f"Mitsuba {mi.__version__} {variant}, {sampler}"
        mi.set_variant(variant)
        dr.set_thread_count(threads)
        depth = scene.transport.max_bounces + 2
        world = _constant(scene.world.radiance, "World")
        description = {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": depth, "hide_emitters": not world.any()},
            "sensor": _sensor(scene, sampler),
            **_meshes(scene),
            **{f"light{k}": _light(light) for k, light in enumerate(scene.lights)},
        }
        if world.any():
            description["world"] = {"type": "constant", "radiance": _rgb(world)}
        self._scene = mi.load_dict(description)
        self.settings = {"variant": variant, "sampler": sampler, "max_depth": depth, "threads": threads}

    def render(self, replicate: int, samples: int, progress: object = None, windows: object = None) -> Rendering:
        """One image; `seconds` until its pixels are there."""
        mi.set_variant(self._variant)
        start = time.perf_counter()
        pixels = np.array(mi.render(self._scene, spp=samples, seed=replicate), dtype=np.float64)
        seconds = time.perf_counter() - start
        return Rendering(pixels, np.zeros(self._size, np.int64), seconds, {}, pixels[..., 0].size * samples)
