# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Converter and Color nodes.

Outside the usual domain they have the meaning that Cycles gives them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..scene import converters as cv
from ..scene.expressions import Expression
from ..vectors import cross, dot, normalize
from .color_spaces import hsl_to_rgb, hsv_to_rgb, rgb_to_hsl, rgb_to_hsv
from .context import InputEvaluator
from .curves import curves
from .math_node import OPERATIONS

_MODELS = {
    "RGB_TO_HSV": rgb_to_hsv,
    "HSV_TO_RGB": hsv_to_rgb,
    "RGB_TO_HSL": rgb_to_hsl,
    "HSL_TO_RGB": hsl_to_rgb,
}
_BY_COMPONENT = {name: name for name in OPERATIONS} | {"FRACTION": "FRACT"}


def as_value(row: np.ndarray) -> np.ndarray:
    """A value of shape (n,), or () where there is one for all points."""
    return row[0] if row.size == 1 else row


def map_range(
    x: np.ndarray,
    source: tuple[np.ndarray, np.ndarray],
    target: tuple[np.ndarray, np.ndarray],
    steps: np.ndarray,
    interpolation: str,
    clamp: bool,
) -> np.ndarray:
    """Map `x` from the interval `source` to `target`.

    An empty source gives the lower end; in Cycles it gives 0 for values.
    """
    low, high = source
    span = high - low
    t = np.where(span != 0.0, (x - low) / np.where(span == 0.0, 1.0, span), 0.0)
    if interpolation == "STEPPED":
        t = np.where(steps > 0.0, np.floor(t * (steps + 1.0)) / np.where(steps > 0.0, steps, 1.0), 0.0)
    elif interpolation == "SMOOTHSTEP":
        t = np.clip(t, 0.0, 1.0)
        t = t * t * (3.0 - 2.0 * t)
    elif interpolation == "SMOOTHERSTEP":
        t = np.clip(t, 0.0, 1.0)
        t = t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
    start, end = target
    result = start + t * (end - start)
    if clamp and interpolation in ("LINEAR", "STEPPED"):
        result = np.clip(result, np.minimum(start, end), np.maximum(start, end))
    return result


def _map_range(node: cv.MapRange, read: InputEvaluator) -> np.ndarray:
    low, high = read(node.from_min), read(node.from_max)
    x, start, end, steps = (read(e) for e in (node.value, node.to_min, node.to_max, node.steps))
    result = map_range(x, (low, high), (start, end), steps, node.interpolation, node.clamp)
    if result.ndim == 2:
        return result
    result = np.where(low != high, result, 0.0)
    return np.clip(result, np.minimum(start, end), np.maximum(start, end)) if node.clamp else result


def vector_math(operation: str, a: np.ndarray, b: np.ndarray, c: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Evaluate the Vector Math node on (3, 1) or (3, n).

    The result is a vector, or (n,) for the three operations that give a value.
    """
    if operation in _BY_COMPONENT:
        return np.asarray(OPERATIONS[_BY_COMPONENT[operation]](a, b, c), np.float64)
    a, b, c = np.broadcast_arrays(a, b, c)
    return _VECTOR_OPERATIONS[operation](a, b, c, scale)


def _project(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    length2 = dot(b, b)
    return np.where(length2 != 0.0, dot(a, b) / np.where(length2 == 0.0, 1.0, length2), 0.0) * b


def _reflect(a: np.ndarray, n: np.ndarray) -> np.ndarray:
    return a - 2.0 * dot(a, n) * n


def _refract(a: np.ndarray, n: np.ndarray, eta: np.ndarray) -> np.ndarray:
    cos = dot(n, a)
    k = 1.0 - eta * eta * (1.0 - cos * cos)
    return np.where(k >= 0.0, eta * a - (eta * cos + np.sqrt(np.maximum(k, 0.0))) * n, 0.0)


_VECTOR_OPERATIONS: dict[str, Callable[..., np.ndarray]] = {
    "CROSS_PRODUCT": lambda a, b, c, s: cross(a, b),
    "PROJECT": lambda a, b, c, s: _project(a, b),
    "REFLECT": lambda a, b, c, s: _reflect(a, normalize(b)),
    "REFRACT": lambda a, b, c, s: _refract(a, normalize(b), s),
    "FACEFORWARD": lambda a, b, c, s: np.where(dot(c, b) < 0.0, a, -a),
    "DOT_PRODUCT": lambda a, b, c, s: as_value(dot(a, b)),
    "DISTANCE": lambda a, b, c, s: as_value(np.sqrt(dot(a - b, a - b))),
    "LENGTH": lambda a, b, c, s: as_value(np.sqrt(dot(a, a))),
    "SCALE": lambda a, b, c, s: a * s,
    "NORMALIZE": lambda a, b, c, s: normalize(a),
}


def cosine_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The cosine of the angle between vectors (3, n) or (3, 1); NaN where one has no length."""
    return as_value(dot(a, b) / (np.sqrt(dot(a, a)) * np.sqrt(dot(b, b))))


def _vector_rotate(node: cv.VectorRotate, read: InputEvaluator) -> np.ndarray:
    vector, center, axis, angle = (read(e) for e in (node.vector, node.center, node.axis, node.angle))
    there = dot(axis, axis) > 0.0
    axis, v = normalize(axis), vector - center
    c, s = np.cos(angle), np.sin(angle)
    axis, v = np.broadcast_arrays(axis, v)
    turned = v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1.0 - c))
    return np.where(there, turned + center, vector)


def _hue_saturation(node: cv.HueSaturation, read: InputEvaluator) -> np.ndarray:
    hue, saturation, value, factor, color = (
        read(e) for e in (node.hue, node.saturation, node.value, node.factor, node.color)
    )
    h, s, v = rgb_to_hsv(color)
    h = h + hue + 0.5
    rows = np.broadcast_arrays(h - np.floor(h), np.clip(s * saturation, 0.0, 1.0), v * value)
    changed = hsv_to_rgb(np.stack([np.atleast_1d(row) for row in rows]))
    return np.maximum(factor * changed + (1.0 - factor) * color, 0.0)


def _bright_contrast(node: cv.BrightContrast, read: InputEvaluator) -> np.ndarray:
    brightness, contrast = read(node.brightness), read(node.contrast)
    return np.maximum((1.0 + contrast) * read(node.color) + (brightness - 0.5 * contrast), 0.0)


# Cycles' fit, kernel/tables.h: from each temperature on, red and green are a / t + b t + c, blue a cubic.
_BLACKBODY = np.array([
    (800.0, 1.61919106e03, -2.05010916e-03, 5.02995757e00, -4.88999748e02, 6.04330754e-04, -7.55807526e-02,
     5.96945309e-11, -4.85742887e-08, -9.70622247e-05, -4.07936148e-03),
    (965.0, 2.48845471e03, -1.11330907e-03, 3.22621544e00, -7.55994277e02, 3.16730098e-04, 4.78306139e-01,
     2.40430366e-11, 5.55021075e-08, -1.98503712e-04, 2.89312858e-02),
    (1167.0, 3.34143193e03, -4.86551192e-04, 1.76486769e00, -1.02363977e03, 1.20223470e-04, 9.36662319e-01,
     -1.40949732e-11, 1.89878968e-07, -3.56632824e-04, 9.10767778e-02),
    (1449.0, 4.09461742e03, -1.27446582e-04, 7.25731635e-01, -1.26571316e03, 4.87340896e-06, 1.27054498e00,
     -3.61460868e-11, 2.84822009e-07, -4.93211319e-04, 1.56723440e-01),
    (1902.0, 4.67028036e03, 2.91258199e-05, 1.26703442e-01, -1.42529332e03, -4.01150431e-05, 1.43972784e00,
     -1.97075738e-11, 1.75359352e-07, -2.50542825e-04, -2.22783266e-02),
    (3315.0, 4.59509185e03, 2.87495649e-05, 1.50345020e-01, -1.17554822e03, -2.16378048e-05, 1.30408023e00,
     -1.61997957e-13, -1.64216008e-08, 3.86216271e-04, -7.38077418e-01),
    (6365.0, 3.78717450e03, 9.35907826e-06, 3.99075871e-01, -5.00799571e02, -4.59832026e-06, 1.09098763e00,
     6.72650283e-13, -2.73078809e-08, 4.24098264e-04, -7.52335691e-01),
])  # fmt: skip
_COLDEST = (5.413294490189271, -0.20319390035873933, -0.0822535242887164)
_HOTTEST = (0.8262954810464208, 0.9945080501520986, 1.566307710274283)


def blackbody(t: np.ndarray) -> np.ndarray:
    """Colour (3, 1) or (3, n) of a black body of `t` kelvin, luminance 1, at least 0."""
    t = np.atleast_1d(t)
    row = np.clip(np.searchsorted(_BLACKBODY[:, 0], t, side="right") - 1, 0, len(_BLACKBODY) - 1)
    k = _BLACKBODY[row].T
    safe = np.clip(t, 800.0, 12000.0)
    color = np.stack(
        [
            k[1] / safe + k[2] * safe + k[3],
            k[4] / safe + k[5] * safe + k[6],
            ((k[7] * safe + k[8]) * safe + k[9]) * safe + k[10],
        ]
    )
    color = np.where(t >= 12000.0, np.array(_HOTTEST)[:, None], color)
    return np.maximum(np.where(t < 800.0, np.array(_COLDEST)[:, None], color), 0.0)


def _combine(node: cv.Combine, read: InputEvaluator) -> np.ndarray:
    return np.stack(np.broadcast_arrays(*(np.atleast_1d(read(e)) for e in (node.x, node.y, node.z))))


CONVERTERS: dict[type[Expression], Callable[..., np.ndarray]] = {
    cv.Component: lambda node, read: as_value(read(node.vector)[node.index]),
    cv.Combine: _combine,
    cv.ColorModel: lambda node, read: _MODELS[node.kind](read(node.color)),
    cv.MapRange: _map_range,
    cv.VectorMath: lambda node, read: vector_math(
        node.operation, read(node.a), read(node.b), read(node.c), read(node.scale)
    ),
    cv.CosineBetween: lambda node, read: cosine_between(read(node.a), read(node.b)),
    cv.VectorRotate: _vector_rotate,
    cv.HueSaturation: _hue_saturation,
    cv.BrightContrast: _bright_contrast,
    cv.Curves: curves,
    cv.Blackbody: lambda node, read: blackbody(read(node.temperature)),
}
"""Node type -> function of the node and the evaluator."""
