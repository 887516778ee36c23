# SPDX-License-Identifier: GPL-3.0-or-later
"""The pixels of an image that show shadow catchers, which are not compared."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import Refusal, Refused
from ..wavefront.coverage import caught_pixels
from ..wavefront.kernel import Kernel


@dataclass(frozen=True, eq=False)
class CatcherPixels:
    """The names of the shadow catchers, and the pixels (height, width) bool that show them."""

    names: tuple[str, ...]
    pixels: np.ndarray

    @property
    def count(self) -> int:
        """The number of the pixels."""
        return int(self.pixels.sum())


def find_catcher_pixels(kernel: Kernel) -> CatcherPixels | None:
    """The pixels that show shadow catchers; None where no object is one.

    Raises Refused where no other pixel is left.
    """
    if kernel.catchers is None:
        return None
    objects = kernel.scene.mesh.objects
    names = tuple(dict.fromkeys(thing.name for thing in objects if thing.catches_shadows))
    pixels = caught_pixels(kernel)
    if pixels.all():
        what, remedy = "an image that shows little but shadow catchers", "switch Shadow Catcher off"
        raise Refused([Refusal(f"object '{name}'", what, remedy) for name in names])
    return CatcherPixels(names, pixels)


def leave_out(left_out: np.ndarray | None, caught: CatcherPixels | None) -> np.ndarray | None:
    """The pixels (height, width) that are left out, with those of shadow catchers; None where there are none."""
    if caught is None:
        return left_out
    return caught.pixels if left_out is None else left_out | caught.pixels
