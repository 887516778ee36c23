# SPDX-License-Identifier: GPL-3.0-or-later
"""One side's image: moments per pixel over independent replicates, and what they cost."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..errors import EtalonError
from .moments import Moments
from .rendering import Rendering


@dataclass(frozen=True)
class Film:
    """Moments (height, width, 3) of the radiance over replicates, in W m^-2 sr^-1.

    A pixel that a non-finite sample ever reached has mean NaN from then on; `nonfinite` (height, width) counts those
    samples. `samples` is the number of samples per pixel in each replicate, `seconds` the time of all of them, `stages`
    the same by stage, `camera_samples` and `rays` their totals.
    """

    moments: Moments
    nonfinite: np.ndarray
    samples: int
    seconds: float = 0.0
    stages: dict[str, float] = field(default_factory=dict)
    camera_samples: int = 0
    rays: int = 0

    @classmethod
    def empty(cls, height: int, width: int, samples: int) -> Film:
        """A film before its first replicate."""
        return cls(Moments.empty((height, width, 3)), np.zeros((height, width), np.int32), samples)

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width in pixels."""
        return self.nonfinite.shape

    def add(self, rendering: Rendering) -> Film:
        """Take one replicate more into a new film; raises EtalonError where the sizes differ."""
        radiance = finite_or_nan(rendering, self.shape)
        bad = np.isnan(radiance[..., 0])
        counted = np.where(bad, np.maximum(rendering.nonfinite, 1), 0).astype(np.int32)
        stages = {k: self.stages.get(k, 0.0) + rendering.stages.get(k, 0.0) for k in self.stages | rendering.stages}
        return Film(
            self.moments.add(radiance),
            self.nonfinite + counted,
            self.samples,
            self.seconds + rendering.seconds,
            stages,
            self.camera_samples + rendering.camera_samples,
            self.rays + rendering.rays,
        )


def finite_or_nan(rendering: Rendering, shape: tuple[int, int]) -> np.ndarray:
    """The radiance (height, width, 3), all three channels NaN where a sample was not finite.

    Negative radiance passes: it is odd, but a number, and the comparison shows it. Raises EtalonError where the
    size is not `shape`.
    """
    radiance = np.asarray(rendering.radiance, float)
    if radiance.shape != (*shape, 3):
        got = " x ".join(str(s) for s in radiance.shape[1::-1])
        raise EtalonError(f"an image is {got} pixels, the other {shape[1]} x {shape[0]}; render both at the same size")
    bad = (np.asarray(rendering.nonfinite) > 0) | ~np.isfinite(radiance).all(axis=2)
    return np.where(bad[..., None], np.nan, radiance) if bad.any() else radiance
