# SPDX-License-Identifier: GPL-3.0-or-later
"""The memory that a comparison needs for its pixels, before anything is allocated."""

from __future__ import annotations

from ..errors import EtalonError
from ..memory import usable_memory

# Of a comparison at full size with its report, beyond what an image of 64 x 64 pixels needs: measured from 512 x 512 to 1024 x 1024.
BYTES_PER_PIXEL = 370
# Of each light pass that is compared: means and squared deviations of both sides, and the image at hand with its part from the file.
BYTES_PER_PASS = 144
FEWER = "lower the resolution, or give a time and let a smaller image be compared"


def needed_memory(width: int, height: int, passes: int = 0) -> int:
    """Bytes that comparing images of this size takes, with this number of light passes."""
    return (BYTES_PER_PIXEL + BYTES_PER_PASS * passes) * width * height


def describe_memory(width: int, height: int, passes: int = 0) -> str:
    """The need in words, and whether the machine has it.

    >>> describe_memory(1920, 1080)
    '1920 x 1080 pixels: about 0.8 GB to compare at full size'
    """
    told = (
        f"{width} x {height} pixels: about {needed_memory(width, height, passes) / 1e9:.1f} GB to compare at full size"
    )
    lacks = lacking_memory(width, height, passes)
    return f"{told}; {lacks}" if lacks else told


def require_memory(width: int, height: int, passes: int = 0) -> None:
    """Raise EtalonError where the machine lacks the memory for an image.

    Its pixels and light passes count.
    """
    if lacking_memory(width, height, passes):
        raise EtalonError(describe_memory(width, height, passes))


def lacking_memory(width: int, height: int, passes: int = 0) -> str:
    """What this machine has where that is not enough, and the remedy; empty where it is."""
    usable = usable_memory()
    if usable is None or needed_memory(width, height, passes) <= usable:
        return ""
    return f"this machine has {usable / 1e9:.1f} GB; {FEWER}"
