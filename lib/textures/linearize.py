# SPDX-License-Identifier: GPL-3.0-or-later
"""Code values of any colour space as linear Rec. 709, by OpenColorIO inside OpenImageIO."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO

from ..errors import EtalonError

_ROLE = "scene_linear"


def linearize(pixels: np.ndarray, space: str, config: Path) -> np.ndarray:
    """Convert the colours of RGBA (height, width, 4), float32, to scene_linear.

    The input colours are codes of `space`; the result has colours of the role scene_linear.

    `config` is the OpenColorIO configuration that defines both. Alpha is straight and stays. Raises EtalonError where
    the space cannot be converted.
    """
    height, width, _ = pixels.shape
    codes = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(width, height, 3, "float"))
    codes.set_pixels(OpenImageIO.ROI(), np.ascontiguousarray(pixels[..., :3], np.float32))
    linear = OpenImageIO.ImageBufAlgo.colorconvert(codes, space, _ROLE, False, "", "", str(config))
    converted = linear.get_pixels(OpenImageIO.FLOAT)
    if linear.has_error or converted is None:
        raise EtalonError(f"colour space '{space}' cannot be converted ({linear.geterror().strip()})")
    return np.dstack((converted.reshape(height, width, 3), pixels[..., 3]))
