# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of images for viewers, and PNG files of them.

They show radiance as sRGB and signed differences in two colours.
"""

from __future__ import annotations

import zlib
from pathlib import Path

import numpy as np
import OpenImageIO

from ..errors import EtalonError
from ..srgb import srgb_encode

NONFINITE = (255, 0, 255)
_SIGNATURE = b"\x89PNG\r\n\x1a\n"
STRIPE = (128, 0, 128)
# Endpoints, and white between them, that stay apart for every kind of colour vision (ColorBrewer's RdBu).
BELOW, EQUAL, ABOVE = (33, 102, 172), (247, 247, 247), (178, 24, 43)


def srgb8(radiance: np.ndarray, exposure: float = 0.0) -> np.ndarray:
    """Return radiance (height, width, 3) times 2^exposure as sRGB code values, uint8.

    They are clipped at 1. Non-finite pixels are magenta.
    """
    out = np.empty(radiance.shape, np.uint8)
    for row, values in enumerate(
        radiance
    ):  # whole images of intermediate values would be as large as all films together
        finite = np.isfinite(values).all(axis=1)
        linear = np.clip(np.where(finite[:, None], values, 0.0) * 2.0**exposure, 0.0, 1.0)
        out[row] = np.rint(255 * srgb_encode(linear))
        out[row, ~finite] = NONFINITE
    return out


def signed8(difference: np.ndarray, limit: float) -> np.ndarray:
    """Return a signed difference (height, width) as uint8 colours.

    Blue at -limit, white at 0, red at +limit, magenta where NaN.
    """
    out = np.empty((*difference.shape, 3), np.uint8)
    for row, values in enumerate(difference):
        known = ~np.isnan(values)
        place = np.clip(np.where(known, values, 0.0) / limit, -1.0, 1.0)
        for c in range(3):
            out[row, :, c] = np.rint(np.interp(place, (-1, 0, 1), (BELOW[c], EQUAL[c], ABOVE[c])))
        out[row, ~known] = NONFINITE
    return out


def hatched(pixels: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Return the view (height, width, 3) with diagonal stripes over some pixels.

    They are those at `where` (height, width).
    """
    row, column = np.nonzero(where)
    out = pixels.copy()
    out[row, column] = np.where(((row + column) % 8 < 4)[:, None], NONFINITE, STRIPE)
    return out


def middle_exposure(radiance: np.ndarray) -> float:
    """Return the exposure, in stops, that brings the brightest 1 % of the image to white.

    It is 0 for a black image.
    """
    bright = radiance.max(axis=-1, initial=0.0)
    bright = bright[np.isfinite(bright)]
    level = np.quantile(bright, 0.99) if bright.size else 0.0
    return float(-np.log2(level)) if level > 0 else 0.0


def write_png(path: Path, pixels: np.ndarray) -> None:
    """Write uint8 pixels (height, width, 3) as PNG; raises EtalonError where that fails."""
    height, width, channels = pixels.shape
    file = OpenImageIO.ImageOutput.create(str(path))
    good = file is not None and file.open(str(path), OpenImageIO.ImageSpec(width, height, channels, "uint8"))
    good = good and file is not None and file.write_image(np.ascontiguousarray(pixels)) and file.close()
    if not good:
        reason = file.geterror() if file is not None else OpenImageIO.geterror()
        if file is not None:
            file.close()
        raise EtalonError(f"{path}: cannot be written ({reason.strip()}); make room or name another folder")
    if not is_whole_png(path.read_bytes()):
        raise EtalonError(
            f"{path}: cannot be written (it does not read back as written); make room or name another folder"
        )


def is_whole_png(content: bytes) -> bool:
    """Return whether a PNG file is complete.

    It is if all chunks are there, each with its own checksum, up to the one that ends the file.
    """
    start, kind = len(_SIGNATURE), b""
    while kind != b"IEND" and len(content) >= start + 12:
        length = int.from_bytes(content[start : start + 4], "big")
        kind = content[start + 4 : start + 8]
        end = start + 8 + length
        if zlib.crc32(content[start + 4 : end]) != int.from_bytes(content[end : end + 4], "big"):
            return False
        start = end + 4
    return content.startswith(_SIGNATURE) and kind == b"IEND" and start == len(content)
