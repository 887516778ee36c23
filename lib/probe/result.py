# SPDX-License-Identifier: GPL-3.0-or-later
"""The result of a probe of a scene.

It has readings of some pixels and the lamps in all units, both in words and as plain data.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..lights.units import LightUnits
from .measure import Probe
from .words import light_lines, probe_figures, probe_lines


@dataclass(frozen=True)
class ProbeResult:
    """Some pixels of a scene, by parts of their light on both sides, and its lamps.

    `scene` is the scene's name. The lamps have all units. `probe.readings` are the image, its light passes, its
    bounces and its lights: radiances (3,) of the reference and of Cycles in W m^-2 sr^-1, each with its standard
    error.
    """

    scene: str
    probe: Probe
    lights: tuple[LightUnits, ...]

    @property
    def figures(self) -> dict[str, Any]:
        """All figures as plain data, as `etalon probe --json` prints them."""
        return {"scene": self.scene} | probe_figures(self.probe, self.lights)

    @property
    def lines(self) -> list[str]:
        """The table and the lamps as lines of text, as `etalon probe` prints them."""
        return [*probe_lines(self.scene, self.probe), "", *light_lines(self.lights)]
