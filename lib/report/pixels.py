# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixels as the report's page holds them.

They are means of several pixels, significances, and arrays as text.
"""

from __future__ import annotations

import base64
import tempfile
import zlib
from pathlib import Path

import numpy as np
from markupsafe import Markup

from ..film.moments import Moments
from ..film.pictures import write_png
from ..verdict.rare import ROUNDING

# Significances travel as signed bytes, in eighths of a standard error.
SIGNIFICANCE_ONE, SIGNIFICANCE_MOST, SIGNIFICANCE_NONE = 8, 127, -128
# Standard errors travel as bytes: code k stands for 2 ** ((k - ERROR_ONE) / ERROR_STEPS), to 6 % from 1e-9 to 4e3. Two codes stand for no
# error and for an error of zero.
ERROR_STEPS, ERROR_ONE, ERROR_NONE, ERROR_ZERO = 6, 182, 0, 1
# Radiance travels with this many bits of the 24 that a float has: to 8 millionths, twice as fine as four digits need.
MANTISSA = 16


def averaged(image: np.ndarray, step: int) -> np.ndarray:
    """The means of `step` x `step` pixels of an image (height, width, 3).

    At the right and lower edge they are of fewer pixels.
    """
    rows, columns = (np.arange(0, size, step) for size in image.shape[:2])
    total = np.add.reduceat(np.add.reduceat(image, rows, axis=0), columns, axis=1)
    return total / _pixels(image, step)


def _pixels(image: np.ndarray, step: int) -> np.ndarray:
    """How many pixels of an image each mean of `averaged` has, as (rows, columns, 1)."""
    rows, columns = (_steps(size, step) for size in image.shape[:2])
    return (rows[:, None] * columns)[..., None]


def _steps(size: int, step: int) -> np.ndarray:
    """How many of `size` pixels each step has."""
    return np.diff(np.append(np.arange(0, size, step), size))


def pixel_significances(
    means: tuple[np.ndarray, np.ndarray], sides: tuple[Moments, Moments], step: int = 1
) -> np.ndarray:
    """(candidate - reference) / standard error of the means of `step` x `step` pixels.

    The result is (rows, columns, 3). `means` (height, width, 3) are the reference's and the candidate's as they are
    shown, `sides` the moments of their pixels. The variance over replicates of each pixel is used, and pixels are
    taken as independent. Single precision, in which Cycles adds up, counts as an error of its own; otherwise light
    without noise would differ by its last digit. 0 where both sides are equal; NaN where a side has fewer than two
    replicates or a value that is not finite.
    """
    reference, candidate = (averaged(mean, step) for mean in means)
    square = sum(_squared_error(moments, step) for moments in sides)
    square += np.square(ROUNDING * reference)
    with np.errstate(divide="ignore", invalid="ignore"):
        found = (candidate - reference) / np.sqrt(square)
    return np.where((candidate == reference) & np.isfinite(square), 0.0, found)


def _squared_error(moments: Moments, step: int) -> np.ndarray:
    with np.errstate(divide="ignore", invalid="ignore"):
        return averaged(moments.variance / moments.count, step) / _pixels(moments.mean, step)


def code_significances(significance: np.ndarray) -> np.ndarray:
    """Significances as signed bytes; those beyond the largest code have that code."""
    most = SIGNIFICANCE_MOST / SIGNIFICANCE_ONE
    codes = np.rint(SIGNIFICANCE_ONE * np.clip(np.nan_to_num(significance), -most, most))
    return np.where(np.isnan(significance), SIGNIFICANCE_NONE, codes).astype(np.int8)


def code_errors(moments: Moments, step: int) -> np.ndarray:
    """Standard errors of the means of `step` x `step` pixels, as bytes.

    The bytes are (rows, columns, 3); `decodeError` in passes.js reads them.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        error = np.sqrt(_squared_error(moments, step))
        codes = np.clip(np.rint(ERROR_STEPS * np.log2(error) + ERROR_ONE), ERROR_ZERO + 1, 255)
    codes = np.where(error == 0.0, ERROR_ZERO, codes)
    return np.where(np.isfinite(error), codes, ERROR_NONE).astype(np.uint8)


def pack_floats(values: np.ndarray) -> Markup:
    """Pack floats, rounded to MANTISSA bits, as text.

    All first bytes come first, then all second ones, which compresses better.
    """
    floats = np.ascontiguousarray(values, "<f4")
    dropped = 24 - MANTISSA
    bits = floats.view("<u4").astype(np.uint64) + (1 << dropped - 1) >> dropped << dropped
    rounded = np.where(np.isfinite(floats), bits, floats.view("<u4")).astype("<u4")
    return pack(rounded.reshape(-1, 1).view(np.uint8).T)


def pack(values: np.ndarray) -> Markup:
    """An array's bytes, compressed, as text for a script element, which they cannot end."""
    # Level 9 takes 3.4 times as long as the usual one, 6, and saves 0.5 % of the bytes.
    return Markup(base64.b64encode(zlib.compress(np.ascontiguousarray(values).tobytes())).decode())


def write_shot(pixels: np.ndarray) -> str:
    """Pixels (height, width, 3), uint8, as the address of an image that the page itself holds."""
    with tempfile.TemporaryDirectory(prefix="etalon-") as folder:
        path = Path(folder) / "shot.png"
        write_png(path, pixels)
        return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode()
