# SPDX-License-Identifier: GPL-3.0-or-later
"""What light tracing of a whole image does not simulate, each by name."""

from __future__ import annotations

import numpy as np

from ..effects.names import Effect
from ..errors import EtalonError, Refusal, Refused
from ..scene.camera import PANORAMAS
from ..scene.expressions import Constant
from ..scene.lights import USUAL_FALLOFF, SphereLight, SpotLight
from ..scene.materials import Material, Sheen, Subsurface, Toon
from ..wavefront.kernel import Kernel
from .dirac import may_be_dirac, varies

_REMEDY = "render with a strategy of path tracing"
# Below it sheen has no lobe for some directions: seen from there, what it sends to others would never be sampled.
_LEAST_SHEEN = 0.15


def refuse_unsupported(kernel: Kernel) -> None:
    """Raise Refused for each thing of the scene that light tracing does not simulate.

    Raises EtalonError for departures.
    """
    if kernel.options.departures:
        raise EtalonError("light tracing reproduces no departures; leave out --depart, or use another --strategy")
    scene = kernel.scene
    refusals = [Refusal(f"material '{m.name}'", what, _REMEDY) for m in scene.materials for what in _of_material(m)]
    if scene.camera.kind in PANORAMAS:
        refusals.append(Refusal("the camera", "light tracing to a panoramic camera", _REMEDY))
    if scene.motion is not None:
        refusals.append(Refusal("the scene", "motion blur by light tracing", _REMEDY))
    if kernel.plan.needs(Effect.DISPERSION):
        refusals.append(Refusal("the scene", "dispersion by light tracing", _REMEDY))
    refusals += [Refusal("the scene", what, _REMEDY) for what in masks_not_traced(kernel)]
    for light in scene.lights:
        if isinstance(light, SphereLight | SpotLight) and light.radius > 0.0 and _is_entered(kernel, light):
            what = "light tracing of the light that a sphere sends to faces inside it"
            refusals.append(Refusal(f"light '{light.name}'", what, _REMEDY))
    if refusals:
        raise Refused(refusals)


def masks_not_traced(kernel: Kernel) -> list[str]:
    """Return the masks of rays in the scene that paths from the lights do not support.

    Also names volumes, ambient occlusion, bevels and unusual lights, if the scene has any.
    """
    names = {
        Effect.RAY_KINDS: "ray visibility by light tracing",
        Effect.SHADOW_CATCHERS: "shadow catchers by light tracing",
        Effect.SHADOWS_APART: "shadow visibility by light tracing",
        Effect.LIGHTS_WITHOUT_SHADOWS: "lights without shadows by light tracing",
        Effect.LINKED_LIGHTS: "light linking by light tracing",
        Effect.LINKED_SHADOWS: "shadow linking by light tracing",
        Effect.LIGHT_BOUNCES: "limits of a light's bounces by light tracing",
        Effect.VOLUMES: "volumes by light tracing",
        Effect.AMBIENT_OCCLUSION: "ambient occlusion by light tracing",
        Effect.BEVELS: "bevels by light tracing",
        Effect.PIXEL_WIDTHS: "wireframes in pixels by light tracing",
    }
    found = [what for effect, what in names.items() if kernel.plan.needs(effect)]
    unusual = any(light.falloff != USUAL_FALLOFF for light in kernel.scene.lights)
    return found + ["light tracing of lights that do not fall off as usual"] * unusual


def _of_material(material: Material) -> list[str]:
    """What light tracing does not simulate of a material."""
    found = []
    if material.unknown:
        found.append(material.unknown)
    closures = [lobe.closure for lobe in material.lobes]
    if any(isinstance(closure, Toon) for closure in closures):
        found.append("light tracing of the Toon BSDF, which sends light where its own samples do not go")
    if any(isinstance(closure, Subsurface) for closure in closures):
        found.append("subsurface scattering by light tracing")
    if any(isinstance(closure, Sheen) and not _has_lobe_everywhere(closure) for closure in closures):
        found.append(f"light tracing of sheen whose roughness may be below {_LEAST_SHEEN}")
    if any(varies(closure) for closure in closures):
        found.append("light tracing with a textured roughness, which may reach 0")
    elif any(may_be_dirac(x) and getattr(x, "normal", None) is not None for x in closures):
        found.append("light tracing of a smooth lobe under a normal map or bumps")
    return found


def _has_lobe_everywhere(closure: Sheen) -> bool:
    """Whether sheen reflects light from every direction."""
    return isinstance(closure.roughness, Constant) and closure.roughness.number >= _LEAST_SHEEN


def _is_entered(kernel: Kernel, light: SphereLight | SpotLight) -> bool:
    """Whether any face comes closer to the middle of a sphere than its radius."""
    mesh = kernel.scene.mesh
    if mesh.triangle_count == 0:
        return False
    corners = [np.take(mesh.vertices, k, axis=1) - np.array(light.position, float)[:, None] for k in mesh.triangles]
    return bool((_distance(*corners) < light.radius).any())


def _distance(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Return the distance (t,) of triangles from the origin; corners a, b, c, (3, t) each.

    It is the distance to the plane inside the triangle, else to an edge.
    """
    normal = np.cross(b - a, c - a, axis=0)
    square = (normal * normal).sum(axis=0)
    foot = normal * ((normal * a).sum(axis=0) / np.where(square > 0.0, square, 1.0))
    edges = ((a, b), (b, c), (c, a))
    inside = np.all([(np.cross(q - p, foot - p, axis=0) * normal).sum(axis=0) >= 0.0 for p, q in edges], axis=0)
    along = np.min([_distance_to_edge(p, q) for p, q in edges], axis=0)
    return np.where(inside & (square > 0.0), np.sqrt((foot * foot).sum(axis=0)), along)


def _distance_to_edge(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    edge = q - p
    square = (edge * edge).sum(axis=0)
    t = np.clip(-(p * edge).sum(axis=0) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    nearest = p + edge * t
    return np.sqrt((nearest * nearest).sum(axis=0))
