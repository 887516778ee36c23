# SPDX-License-Identifier: GPL-3.0-or-later
"""From the lights of a scene to samplers."""

from __future__ import annotations

from ..scene.lights import USUAL_FALLOFF, AreaLight, Light, PointLight, SphereLight, SpotLight
from .area import AreaSampler
from .beam import BeamSampler
from .ellipse import EllipseSampler
from .falling_off import FallingOff
from .light import LightSampler
from .point import PointSampler
from .rectangle import ParallelogramSampler, RectangleSampler
from .sphere import SphereSampler
from .spot import spot_sampler
from .sun import SunSampler


def light_sampler(light: Light, scene_radius: float) -> LightSampler:
    """The sampler of one light."""
    sampler = _usual_sampler(light, scene_radius)
    return sampler if light.falloff == USUAL_FALLOFF else FallingOff(sampler, light.falloff, scene_radius)


def _usual_sampler(light: Light, scene_radius: float) -> LightSampler:
    """The sampler of a light as if it fell off as usual."""
    if isinstance(light, PointLight):
        return PointSampler(light)
    if isinstance(light, SphereLight):
        return SphereSampler(light)
    if isinstance(light, SpotLight):
        return spot_sampler(light)
    if isinstance(light, AreaLight):
        shape = area_sampler(light)
        return BeamSampler(light, shape) if light.spread <= 0.0 else shape
    return SunSampler(light, scene_radius)


def area_sampler(light: AreaLight) -> AreaSampler:
    """Return the sampler for the shape of `light` ('RECTANGLE' or 'ELLIPSE').

    For a rectangle it depends on whether its edges are at right angles.
    """
    if light.shape == "ELLIPSE":
        return EllipseSampler(light)
    sheared = ParallelogramSampler(light)
    return sheared if sheared.sheared else RectangleSampler(light)
