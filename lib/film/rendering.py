# SPDX-License-Identifier: GPL-3.0-or-later
"""What a renderer hands over: one independent replicate of an image."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .parts import Part
from .windows import Windows


@dataclass(frozen=True)
class Rendering:
    """One replicate, row 0 on top.

    radiance (height, width, 3) float64, W m^-2 sr^-1; nonfinite (height, width) int, the non-finite samples of each pixel;
    seconds it took, and `stages` the same by stage; camera_samples and rays it traced. With `windows`, only their pixels were
    rendered, and the others hold nothing. `unknown` (height, width) counts, where the scene has materials that are not known, how
    often a pixel's paths met one. `passes` are the parts (height, width, 3) of the radiance by light pass, those that were asked for.
    `moments` is how many times of the shutter all samples share, where they have none of their own.
    """

    radiance: np.ndarray
    nonfinite: np.ndarray
    seconds: float
    stages: dict[str, float] = field(default_factory=dict)
    camera_samples: int = 0
    rays: int = 0
    windows: Windows | None = None
    unknown: np.ndarray | None = None
    passes: dict[Part, np.ndarray] = field(default_factory=dict)
    moments: int | None = None
