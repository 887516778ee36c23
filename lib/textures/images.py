# SPDX-License-Identifier: GPL-3.0-or-later
"""Sampling of images: nearest, bilinear or by cubic B-splines.

Texel centres are at halves, and v grows from the bottom row.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..scene.images import Image
from ..srgb import srgb_decode

# Texels that are decoded at once: their arrays stay in cache, which takes a third of the time.
_BLOCK = 8192


def equirectangular(direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (u, v) of `direction` (3, n), of any length.

    +x is at the centre, +y a quarter to the left, +z at the top (v = 1).
    """
    x, y, z = direction
    return 0.5 - np.arctan2(y, x) / (2 * np.pi), 0.5 + np.arctan2(z, np.hypot(x, y)) / np.pi


def _wrap_index(index: np.ndarray, size: int, extension: str) -> np.ndarray:
    if extension == "REPEAT":
        return index % size
    if extension == "MIRROR":
        index = index % (2 * size)
        return np.minimum(index, 2 * size - 1 - index)
    return np.clip(index, 0, size - 1)


def _cubic_weights(t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the uniform cubic B-spline's weights of four neighbours.

    `t` in 0..1 is the place between the middle two. Texels are not interpolated.
    """
    s = 1.0 - t
    return s**3 / 6.0, (4.0 - 3.0 * t**2 * (1.0 + s)) / 6.0, (4.0 - 3.0 * s**2 * (1.0 + t)) / 6.0, t**3 / 6.0


class _Axis:
    """The texels around coordinate `x` (in images), and their weights, along one axis.

    The axis has `size` texels. With extension 'CLIP' the weights outside the image are 0.
    """

    def __init__(self, x: np.ndarray, size: int, interpolation: str, extension: str) -> None:
        if extension == "REPEAT":
            x = x - np.floor(x)
        if interpolation == "CLOSEST":
            first = np.floor(x * size)
            neighbours = [(first, np.ones_like(x))]
        elif interpolation == "CUBIC":
            position = x * size - 0.5
            first = np.floor(position)
            neighbours = [(first + k - 1, weight) for k, weight in enumerate(_cubic_weights(position - first))]
        else:
            position = x * size - 0.5
            first = np.floor(position)
            t = position - first
            neighbours = [(first, 1 - t), (first + 1, t)]
        self.taps = []
        for index, weight in neighbours:
            if extension == "CLIP":
                weight = np.where((index >= 0) & (index < size), weight, 0.0)
            self.taps.append((_wrap_index(index.astype(np.int64), size, extension), weight))


def _gather(texels: np.ndarray, index: np.ndarray) -> np.ndarray:
    """Return rows `index` (n,) of `texels` (m, 4), turned to (4, n) float64.

    `mode` only spares NumPy a check.
    """
    return texels.take(index, axis=0, mode="clip").T.astype(np.float64, order="C")


class ImageSet:
    """The images of a scene, ready to be sampled.

    The model: sRGB code values become linear light, alpha is multiplied in, and texels are interpolated, in this order. Two departures change
    it, and Cycles has both. Without `decode_first`, code values are interpolated and decoded afterwards. With `alpha_in_codes`, alpha is
    multiplied into code values, 8-bit ones with the result cut off to 8 bits.
    """

    def __init__(self, images: Sequence[Image], decode_first: bool = True, alpha_in_codes: bool = False) -> None:
        self._images = tuple(images)
        self._decode_first, self._alpha_in_codes = decode_first, alpha_in_codes
        self._texels: dict[tuple[int, str], np.ndarray] = {}

    def sample(
        self,
        index: int,
        u: np.ndarray,
        v: np.ndarray,
        interpolation: str = "LINEAR",
        extension: str = "REPEAT",
        association: str = "SEPARATE",
    ) -> np.ndarray:
        """Return RGBA (4, n) of image `index` at (u, v), each (n,), with linear colours.

        The names are ImageTexture's.
        """
        texels = self._prepared(index, association)
        height, width = self._images[index].pixels.shape[:2]
        across = _Axis(u, width, interpolation, extension)
        up = _Axis(v, height, interpolation, extension)
        rgba = np.zeros((4, np.size(u)))
        for row, row_weight in up.taps:
            for column, column_weight in across.taps:
                part = _gather(texels, row * width + column)
                part *= row_weight * column_weight
                rgba += part
        decodes = self._images[index].encoding == "SRGB" and not self._decode_first
        divided = association == "WEIGHTED" or (association == "MULTIPLIED" and decodes and not self._alpha_in_codes)
        alpha = _divisor(rgba[3])
        if divided:
            rgba[:3] /= alpha
        if decodes:
            rgba[:3] = srgb_decode(rgba[:3])
        if divided and association == "MULTIPLIED":
            rgba[:3] *= alpha
        return rgba

    def _prepared(self, index: int, association: str) -> np.ndarray:
        """Texels (height * width, 4) as they are interpolated, made once."""
        key = (index, association)
        if key not in self._texels:
            self._texels[key] = self._associated(self._images[index], association)
        return self._texels[key]

    def _associated(self, image: Image, association: str) -> np.ndarray:
        """Return the texels (n, 4) of `image`, decoded.

        They are multiplied by alpha where that comes before interpolation.
        """
        texels = image.pixels.reshape(-1, 4)
        decode = image.encoding == "SRGB" and self._decode_first
        multiplied = association != "SEPARATE" and not image.multiplied
        if not (decode or multiplied):
            return texels
        texels = texels.astype(np.float32)
        color, alpha = texels[:, :3], texels[:, 3:]
        if image.multiplied:
            whole = self._alpha_in_codes and association == "MULTIPLIED"
            color[:] = _decode(color) if whole else _divisor(alpha) * _decode(color / _divisor(alpha))
            return texels
        if multiplied and self._alpha_in_codes:
            color[:] = _multiplied_codes(color, alpha)
            if decode and association == "MULTIPLIED":
                color[:] = _decode(color)
            elif decode:
                color[:] = alpha * _decode(color / _divisor(alpha))
            return texels
        if decode:
            color[:] = _decode(color)
        if multiplied:
            color *= alpha
        return texels


def _decode(codes: np.ndarray) -> np.ndarray:
    """Linear light (n, 3) of sRGB code values (n, 3), block by block."""
    linear = np.empty_like(codes)
    for start in range(0, len(codes), _BLOCK):
        linear[start : start + _BLOCK] = srgb_decode(codes[start : start + _BLOCK])
    return linear


def _divisor(alpha: np.ndarray) -> np.ndarray:
    """What divides alpha out of a colour: where alpha is 0 the colour stays as it is."""
    return np.where(alpha == 0.0, np.ones_like(alpha), alpha)


def _multiplied_codes(codes: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """Codes (n, 3) times alpha (n, 1), each in 0..1; bytes become bytes again, cut off below."""
    bytes_ = [np.rint(255.0 * values) for values in (codes, alpha)]
    if all(np.abs(255.0 * values - whole).max() < 1e-3 for values, whole in zip((codes, alpha), bytes_, strict=True)):
        return np.floor(bytes_[0] * bytes_[1] / 255.0) / 255.0
    return codes * alpha
