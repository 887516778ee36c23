# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights in radiometric units, in world space.

The exporter has already applied Blender's wattage rules.
Colours are tuples of three (linear Rec. 709), positions and directions tuples of three (metres, unit vectors).
A light that is hit is transparent: it adds its radiance and the ray goes on, as in Cycles.
"""

from __future__ import annotations

from dataclasses import dataclass

from .links import UNLINKED, Links
from .rays import SCATTERED

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Falloff:
    """How light changes with the length d of a ray, beside the square of the distance: by d^power d^2 / (smooth + d^2).

    `power` is 0, 1 or 2, and `smooth`, in square metres, is not negative.
    """

    power: int = 0
    smooth: float = 0.0


USUAL_FALLOFF = Falloff()


@dataclass(frozen=True, kw_only=True)
class Switches:
    """What every light can be told.

    `rays` is the mask of the rays that see it (rays.py); point lights are seen by none, and light those that would. Faces hide it only
    where it `casts_shadow`. It lights points at which a path has scattered at most `max_bounces` times before. `links` are the objects
    that it lights, and those that hide it (links.py). A sun has the usual `falloff`.
    """

    rays: int = SCATTERED
    casts_shadow: bool = True
    max_bounces: int = 1024
    links: Links = UNLINKED
    falloff: Falloff = USUAL_FALLOFF


@dataclass(frozen=True)
class PointLight(Switches):
    """A point of the given radiant `intensity` (W sr^-1)."""

    name: str
    position: Vector
    intensity: Vector


@dataclass(frozen=True)
class SphereLight(Switches):
    """A sphere that shows the same `radiance` (W m^-2 sr^-1) everywhere.

    As in Cycles, it does so also to what is inside it.
    """

    name: str
    position: Vector
    radius: float
    radiance: Vector


@dataclass(frozen=True)
class Cone:
    """A spot's cone: light falls off from `axis` to zero at `cos_half_angle`.

    `x_axis` and `y_axis` span the plane across the axis and carry the object's inverse scale: the cosine that the falloff
    uses is that of the direction measured in (x_axis, y_axis, axis).
    """

    axis: Vector
    x_axis: Vector
    y_axis: Vector
    cos_half_angle: float
    blend: float


@dataclass(frozen=True)
class SpotLight(Switches):
    """A point or sphere seen through a cone.

    A point (`radius` 0) has its `emission` as intensity, W sr^-1, a sphere as radiance.
    """

    name: str
    position: Vector
    radius: float
    emission: Vector
    cone: Cone


@dataclass(frozen=True)
class SunLight(Switches):
    """Light from the cone of `half_angle` (radians) about `direction` (towards the sun).

    `irradiance` on a plane facing the sun, W m^-2; the radiance is irradiance / (pi sin^2 half_angle).
    """

    name: str
    direction: Vector
    half_angle: float
    irradiance: Vector


@dataclass(frozen=True)
class AreaLight(Switches):
    """A one-sided light: a `shape` ('RECTANGLE' or 'ELLIPSE') about `center`.

    `edge_u` and `edge_v` are its full edges (or axes).
    It emits `radiance` to the side of `normal`; with `spread` < pi (radians) the radiance at angle theta is multiplied
    by max(tan(spread/2) - tan theta, 0) / (tan(spread/2) - spread/2).
    """

    name: str
    center: Vector
    edge_u: Vector
    edge_v: Vector
    normal: Vector
    shape: str
    radiance: Vector
    spread: float


Light = PointLight | SphereLight | SpotLight | SunLight | AreaLight
