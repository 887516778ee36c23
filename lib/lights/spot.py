# SPDX-License-Identifier: GPL-3.0-or-later
"""A point or a sphere seen through a cone with a soft edge."""

from __future__ import annotations

import numpy as np

from ..sampling.warps import uniform_sphere
from ..scene.lights import Cone, PointLight, SphereLight, SpotLight
from ..vectors import dot
from .cone import uniform_cone
from .light import Ball, Emitted, LightSample, Pair, column, power_of
from .point import PointSampler
from .sphere import SphereSampler


class SpotSampler:
    """A spot light: its `emitter` seen through its cone."""

    delta = True

    def __init__(self, light: SpotLight, emitter: PointSampler | SphereSampler) -> None:
        self._falloff, self._emitter = Falloff(light.cone), emitter
        self.flux = emitter.flux * self._falloff.mean()
        self.power = power_of(self.flux)

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """The emitter's own sample, dimmed along the ray that it gives."""
        sample = self._emitter.sample(point, u1, u2)
        return sample._replace(radiance=sample.radiance * self._dimming(point, sample.wi))

    @property
    def extent(self) -> Ball:
        """That of the emitter."""
        return self._emitter.extent

    def emit(self, ball: Ball, place: Pair, heading: Pair) -> Emitted:
        """Uniform in the cone, each ray dimmed; in all directions where the cone is stretched."""
        direction, solid_angle = self._falloff.sample(*heading)
        return self.emit_along(direction, 1.0 / np.maximum(solid_angle, 1e-300), place)

    def emit_along(self, direction: np.ndarray, density: np.ndarray | float, place: Pair) -> Emitted:
        """Rays of given directions (3, n), sampled with `density` per steradian, dimmed."""
        emitted = self._emitter.emit_along(direction, density, place)
        factor = self._falloff(-direction)
        brightness = emitted.brightness if self.delta else emitted.brightness * factor
        return emitted._replace(weight=emitted.weight * factor, brightness=brightness)

    def _dimming(self, point: np.ndarray, wi: np.ndarray) -> np.ndarray:
        return self._falloff(wi)


class SphereSpotSampler(SpotSampler):
    """A spot light whose emitter is a `sphere`.

    The cone does not dim what is inside the sphere, as in Cycles.
    """

    delta = False

    def __init__(self, light: SpotLight, sphere: SphereSampler) -> None:
        super().__init__(light, sphere)
        self._sphere = sphere

    def candidates(self, origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """Those of the sphere."""
        return self._sphere.candidates(origin, direction)

    def intersect(self, origin: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The sphere's hit, dimmed along the ray; a sphere that shows nothing there is still met."""
        distance, radiance = self._sphere.intersect(origin, direction)
        met = np.flatnonzero(np.isfinite(distance))
        if met.size:
            radiance[:, met] *= self._dimming(np.take(origin, met, axis=1), np.take(direction, met, axis=1))
        return distance, radiance

    def pdf(self, origin: np.ndarray, direction: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """That of the sphere."""
        return self._sphere.pdf(origin, direction, distance)

    def _dimming(self, point: np.ndarray, wi: np.ndarray) -> np.ndarray:
        factor = super()._dimming(point, wi)
        factor[self._sphere.inside(point)] = 1.0
        return factor


def spot_sampler(light: SpotLight) -> SpotSampler:
    """The sampler of a spot light: of a point where its radius is 0, else of a sphere."""
    if light.radius == 0.0:
        return SpotSampler(light, PointSampler(PointLight(light.name, light.position, light.emission)))
    sphere = SphereSampler(SphereLight(light.name, light.position, light.radius, light.emission))
    return SphereSpotSampler(light, sphere)


class Falloff:
    """The falloff of a spot light's cone: smoothstep((c - cos b) / ((1 - cos b) blend)).

    c is the cosine between the ray from the light and the axis, and b is the half angle.

    With blend 0 the edge is a step; with half angle 0 nothing is left.
    """

    def __init__(self, cone: Cone) -> None:
        self._axis, self._x, self._y = column(cone.axis), column(cone.x_axis), column(cone.y_axis)
        # An orthonormal frame measures every unit vector as 1 long, so that one product is enough.
        self.is_stretched = not np.allclose(
            [dot(self._x, self._x), dot(self._y, self._y), dot(self._x, self._y)],
            [[1.0], [1.0], [0.0]],
            rtol=0.0,
            atol=1e-12,
        )
        self._cos_edge = cone.cos_half_angle
        self._width = (1.0 - cone.cos_half_angle) * cone.blend

    def __call__(self, wi: np.ndarray) -> np.ndarray:
        """Factor in [0, 1], (n,), for unit directions `wi` (3, n) towards the light."""
        c = -dot(self._axis, wi)
        if self.is_stretched:
            x, y = dot(self._x, wi), dot(self._y, wi)
            length2 = c * c + x * x + y * y
            c /= np.sqrt(np.where(length2 > 0.0, length2, np.inf))
        c -= self._cos_edge
        if self._width <= 1e-300:  # also where a division would overflow
            return (c > 0.0).astype(float)
        c /= self._width
        np.clip(c, 0.0, 1.0, out=c)
        return c * c * (3.0 - 2.0 * c)

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, float]:
        """Sample directions (3, n) away from the light that hold all that it sends out.

        Also returns the solid angle in which they are uniform.
        """
        if self.is_stretched:
            return uniform_sphere(u1, u2), 4.0 * np.pi
        direction, _ = uniform_cone(self._axis, 1.0 - self._cos_edge, u1, u2)
        return direction, 2.0 * np.pi * (1.0 - self._cos_edge)

    def mean(self) -> float:
        """The mean of the factor over all directions, for a cone that is not stretched.

        The average of smoothstep over the cone's edge is 1/2.
        """
        return 0.5 * (1.0 - self._cos_edge - 0.5 * self._width)
