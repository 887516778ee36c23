# SPDX-License-Identifier: GPL-3.0-or-later
"""One side's image: moments per pixel over independent replicates, and what they cost."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..errors import EtalonError
from .moments import Moments
from .rendering import Rendering


@dataclass
class Film:
    """Moments (height, width, 3) of the radiance over replicates, in W m^-2 sr^-1.

    A pixel that a non-finite sample ever reached has mean NaN from then on; `nonfinite` (height, width) counts those
    samples. `samples` is the number of samples per pixel in a replicate of weight 1, `seconds` the time of all of them, `stages`
    the same by stage, `camera_samples` and `rays` their totals. `remarks` are sentences that whoever looks at the image must know.
    """

    moments: Moments
    nonfinite: np.ndarray
    samples: int
    seconds: float = 0.0
    stages: dict[str, float] = field(default_factory=dict)
    camera_samples: int = 0
    rays: int = 0
    remarks: tuple[str, ...] = ()

    @classmethod
    def empty(cls, height: int, width: int, samples: int) -> Film:
        """A film before its first replicate."""
        return cls(Moments.empty((height, width, 3)), np.zeros((height, width), np.int32), samples)

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width in pixels."""
        return self.nonfinite.shape

    def add(self, rendering: Rendering, weight: int = 1) -> None:
        """Add one replicate, of `weight` times `samples`.

        Raises EtalonError where the sizes differ.
        """
        bad = nonfinite_pixels(rendering, self.shape)
        where = None if rendering.windows is None else rendering.windows.mask
        self.moments.add(_without(rendering.radiance, bad), where, weight)
        if bad.any():
            self.nonfinite += np.where(bad, np.maximum(rendering.nonfinite, 1), 0).astype(np.int32)
        for stage, seconds in rendering.stages.items():
            self.stages[stage] = self.stages.get(stage, 0.0) + seconds
        self.seconds += rendering.seconds
        self.camera_samples += rendering.camera_samples
        self.rays += rendering.rays


def nonfinite_pixels(rendering: Rendering, shape: tuple[int, int]) -> np.ndarray:
    """Which of the pixels (height, width) that were rendered a non-finite sample reached.

    Negative radiance passes: it is odd, but a number, and the comparison shows it. Raises EtalonError where the
    size is not `shape`.
    """
    if rendering.radiance.shape != (*shape, 3):
        got = " x ".join(str(s) for s in rendering.radiance.shape[1::-1])
        raise EtalonError(f"an image is {got} pixels, the other {shape[1]} x {shape[0]}; render both at the same size")
    bad = (rendering.nonfinite > 0) | ~finite_pixels(rendering.radiance)
    return bad if rendering.windows is None else bad & rendering.windows.mask


def finite_pixels(radiance: np.ndarray) -> np.ndarray:
    """Return where all channels of an image (height, width, 3) are finite, (height, width)."""
    red, green, blue = np.moveaxis(np.isfinite(radiance), 2, 0)
    return red & green & blue  # `all` along an axis of three takes five times as long


def finite_or_nan(rendering: Rendering, shape: tuple[int, int]) -> np.ndarray:
    """Return the radiance (height, width, 3), NaN where a sample was not finite.

    All three channels of such a pixel are NaN. Raises as `nonfinite_pixels`.
    """
    return _without(rendering.radiance, nonfinite_pixels(rendering, shape))


def _without(radiance: np.ndarray, bad: np.ndarray) -> np.ndarray:
    return np.where(bad[..., None], np.nan, radiance) if bad.any() else radiance
