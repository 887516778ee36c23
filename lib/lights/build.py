# SPDX-License-Identifier: GPL-3.0-or-later
"""From the lights of a scene to samplers."""

from __future__ import annotations

from ..scene.lights import AreaLight, Light, PointLight, SphereLight, SpotLight
from .area import AreaSampler
from .beam import BeamSampler
from .ellipse import EllipseSampler
from .light import LightSampler
from .point import PointSampler
from .rectangle import ParallelogramSampler, RectangleSampler
from .sphere import SphereSampler
from .spot import SpotSampler
from .sun import SunSampler


def light_samplers(lights: tuple[Light, ...], scene_radius: float) -> list[LightSampler]:
    """Samplers of the lights that send out anything; those without power (no area, a closed cone, black) are left out.

    `scene_radius` (metres) weighs suns against the rest.
    """
    samplers = [light_sampler(light, scene_radius) for light in lights]
    return [sampler for sampler in samplers if sampler.power > 0.0]


def light_sampler(light: Light, scene_radius: float) -> LightSampler:
    """The sampler of one light."""
    if isinstance(light, PointLight):
        return PointSampler(light)
    if isinstance(light, SphereLight):
        return SphereSampler(light)
    if isinstance(light, SpotLight):
        return SpotSampler(light)
    if isinstance(light, AreaLight):
        shape = area_sampler(light)
        return BeamSampler(light, shape) if light.spread <= 0.0 else shape
    return SunSampler(light, scene_radius)


def area_sampler(light: AreaLight) -> AreaSampler:
    """By shape ('RECTANGLE' or 'ELLIPSE'), and by whether a rectangle's edges are at right angles."""
    if light.shape == "ELLIPSE":
        return EllipseSampler(light)
    sheared = ParallelogramSampler(light)
    return sheared if sheared.sheared else RectangleSampler(light)
