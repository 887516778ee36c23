# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the time goes: the stages of the integrator by their own clocks, and the effects of the scene that run in each."""

from __future__ import annotations

from dataclasses import dataclass

from ..effects.plan import Plan
from .measure import Measured

# The stage in which an effect's work is done; those that no stage owns alone are counted where most of it is.
_STAGES = {
    "depth of field": "camera",
    "hidden objects": "intersect",
    "smooth normals": "surface",
    "several materials": "surface",
    "several lobes": "shade",
    "Lambert": "shade",
    "Oren-Nayar": "shade",
    "mirrors": "shade",
    "Beckmann": "shade",
    "GGX": "shade",
    "multiple scattering": "shade",
    "Ashikhmin-Shirley": "shade",
    "anisotropy": "shade",
    "Fresnel": "shade",
    "metals": "shade",
    "glossy layers": "shade",
    "glass": "shade",
    "refraction": "shade",
    "rough interfaces": "shade",
    "translucency": "shade",
    "image textures": "shade",
    "procedural textures": "shade",
    "normal maps": "shade",
    "bumps": "shade",
    "mesh attributes": "shade",
    "transparent surfaces": "pass through",
    "emission": "emission",
    "constant world": "emission",
    "mesh lights": "lights",
    "point lights": "lights",
    "sphere lights": "lights",
    "sun lights": "lights",
    "area lights": "lights",
    "environment world": "emission",
    "environment table": "lights",
    "light sampling": "lights",
    "light selection": "lights",
    "shadow rays": "shadow rays",
    "multiple importance sampling": "shade",
    "scattered rays": "advance",
    "last rays": "intersect",
    "last hits": "intersect",
    "second hits": "intersect",
    "indirect light": "intersect",
    "Russian roulette": "advance",
}


@dataclass(frozen=True)
class Stage:
    """One stage: its `share` of the threads' time, `nanoseconds` of a thread per camera sample, and the effects that run in it."""

    name: str
    share: float
    nanoseconds: float
    effects: tuple[str, ...]


def stages(measured: Measured, plan: Plan | None = None) -> list[Stage]:
    """The stages of a way's last point, longest first; none where its renderer has no clocks."""
    total = sum(measured.stages.values())
    if total <= 0.0 or not measured.camera_samples:
        return []
    needed = [d.effect for d in plan.decisions if d.needed] if plan is not None else []
    found = []
    for name, seconds in sorted(measured.stages.items(), key=lambda item: -item[1]):
        effects = tuple(effect for effect in needed if _STAGES.get(effect) == name)
        found.append(Stage(name, seconds / total, 1e9 * seconds / measured.camera_samples, effects))
    return found
