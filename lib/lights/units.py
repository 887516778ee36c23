# SPDX-License-Identifier: GPL-3.0-or-later
"""Units of lights, as Blender means its Power.

They are watts, watts per steradian, watts per square metre, candela and lumens.

Power is radiant flux, of each colour by itself, except that of a sun, which is irradiance. Of a spot it is the flux
of the same lamp without its cone. Power has no spectrum, so lumens and candela need a convention: EFFICACY lumens for
each watt of luminance, 0.2126 R + 0.7152 G + 0.0722 B. That is the maximum, at 555 nm, and what Blender's own glTF
exporter takes. Real white light has less: an equal-energy white in the visible range 179 lm/W (Ward Larson and
Shakespeare, Rendering with Radiance, 1998).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..scene.lights import AreaLight, Light, PointLight, SphereLight, SpotLight, SunLight
from .light import luminance
from .spot import Falloff

EFFICACY = 683.0
"""Lumens per watt of luminance, by the definition of the candela (BIPM, The International System of Units, 2019)."""


@dataclass(frozen=True)
class LightUnits:
    """One light: its `kind` and `power` (3,) as in Blender's field, W, or W m^-2 of a sun.

    flux (3,), W: all that it sends out, None of a sun and of a spot whose cone is stretched. intensity (3,), W sr^-1: along its
    axis, None of a sun. exitance (3,), W m^-2: of its surface, or of a sun the irradiance of a plane that faces it; None of a point.
    """

    name: str
    kind: str
    power: np.ndarray
    flux: np.ndarray | None
    intensity: np.ndarray | None
    exitance: np.ndarray | None

    @property
    def lumens(self) -> float | None:
        """Luminous flux, lm."""
        return _luminous(self.flux)

    @property
    def candela(self) -> float | None:
        """Luminous intensity along the axis, cd."""
        return _luminous(self.intensity)

    @property
    def lux(self) -> float | None:
        """Luminous exitance of the surface, or of a sun the illuminance, lm m^-2."""
        return _luminous(self.exitance)


def light_units(light: Light) -> LightUnits:
    """What a light sends out, by closed forms."""
    if isinstance(light, SunLight):
        irradiance = np.array(light.irradiance)
        return LightUnits(light.name, "sun", irradiance, None, None, irradiance)
    if isinstance(light, AreaLight):
        return _area(light)
    if isinstance(light, SpotLight):
        return _spot(light)
    if isinstance(light, PointLight):
        intensity = np.array(light.intensity)
        return LightUnits(light.name, "point", 4.0 * math.pi * intensity, 4.0 * math.pi * intensity, intensity, None)
    radiance = np.array(light.radiance)
    intensity = _of_sphere(light) * radiance
    flux = 4.0 * math.pi * intensity
    return LightUnits(light.name, "point", flux, flux, intensity, math.pi * radiance)


def _of_sphere(light: SphereLight | SpotLight) -> float:
    """The area, m^2, that a sphere shows from afar."""
    return math.pi * light.radius**2


def _spot(light: SpotLight) -> LightUnits:
    """Return the units of a spot light.

    The axis has the intensity of the lamp without its cone, which lets out the mean of its falloff over all directions.
    """
    emission, falloff = np.array(light.emission), Falloff(light.cone)
    intensity = emission if light.radius == 0.0 else _of_sphere(light) * emission
    power = 4.0 * math.pi * intensity
    flux = None if falloff.is_stretched else power * falloff.mean()
    return LightUnits(light.name, "spot", power, flux, intensity, None if light.radius == 0.0 else math.pi * emission)


def _area(light: AreaLight) -> LightUnits:
    """Return the units of a flat light.

    A spread keeps the flux, pi L A, and gathers it: along the axis it is tan h / (tan h - h) times as strong, h half
    the spread.
    """
    area = float(np.linalg.norm(np.cross(light.edge_u, light.edge_v)))
    area *= math.pi / 4.0 if light.shape == "ELLIPSE" else 1.0
    radiance, half = np.array(light.radiance), 0.5 * light.spread
    gathered = 1.0
    if half < 0.5 * math.pi * (1.0 - 1e-6):
        # tan h - h loses all digits for small h; its series does not.
        lost = math.tan(half) - half if half > 0.05 else half**3 / 3.0 * (1.0 + 0.4 * half**2 + 17.0 / 105.0 * half**4)
        gathered = math.tan(half) / lost
    flux = math.pi * area * radiance
    return LightUnits(light.name, "area", flux, flux, area * gathered * radiance, math.pi * radiance)


def _luminous(radiant: np.ndarray | None) -> float | None:
    return None if radiant is None else float(EFFICACY * luminance(radiant[:, None])[0])
