# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Math node.

Every operation has the meaning that Cycles gives it outside the usual domain.

Where an argument has no real result (division by 0, root or logarithm of a negative) Cycles returns a number, mostly
0, rather than an infinity; these functions return the same.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

_FLOAT32_EPSILON = float(np.finfo(np.float32).eps)


def _divide(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.where(b != 0, a / np.where(b == 0, 1.0, b), 0.0)


def _power(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a^b, with x^0 = 1, 0^b = 0, and 0 for a negative base with a broken exponent."""
    undefined = (a == 0) | ((a < 0) & (b != np.trunc(b)))
    return np.where(b == 0, 1.0, np.where(undefined, 0.0, np.power(np.where(undefined, 1.0, a), b)))


def _logarithm(a: np.ndarray, base: np.ndarray) -> np.ndarray:
    defined = (a > 0) & (base > 0)
    return np.where(defined, _divide(np.log(np.where(defined, a, 1.0)), np.log(np.where(defined, base, 1.0))), 0.0)


def _inverse_sqrt(a: np.ndarray) -> np.ndarray:
    return np.where(a > 0, 1 / np.sqrt(np.where(a > 0, a, 1.0)), 0.0)


def _modulo(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.where(b != 0, np.fmod(a, np.where(b == 0, 1.0, b)), 0.0)


def _floored_modulo(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.where(b != 0, a - np.floor(_divide(a, b)) * b, 0.0)


def _wrap(a: np.ndarray, high: np.ndarray, low: np.ndarray) -> np.ndarray:
    span = high - low
    return np.where(span != 0, a - span * np.floor(_divide(a - low, span)), low)


def _pingpong(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    turn = _divide(a - b, 2 * b)
    return np.where(b != 0, np.abs((turn - np.floor(turn)) * b * 2 - b), 0.0)


def _smooth_minimum(a: np.ndarray, b: np.ndarray, distance: np.ndarray) -> np.ndarray:
    h = _divide(np.maximum(distance - np.abs(a - b), 0), distance)
    return np.minimum(a, b) - h * h * h * distance / 6


def _compare(a: np.ndarray, b: np.ndarray, epsilon: np.ndarray) -> np.ndarray:
    return (np.abs(a - b) <= np.maximum(epsilon, _FLOAT32_EPSILON)) | (a == b)


OPERATIONS: dict[str, Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]] = {
    "ADD": lambda a, b, c: a + b,
    "SUBTRACT": lambda a, b, c: a - b,
    "MULTIPLY": lambda a, b, c: a * b,
    "DIVIDE": lambda a, b, c: _divide(a, b),
    "MULTIPLY_ADD": lambda a, b, c: a * b + c,
    "POWER": lambda a, b, c: _power(a, b),
    "LOGARITHM": lambda a, b, c: _logarithm(a, b),
    "SQRT": lambda a, b, c: np.sqrt(np.maximum(a, 0)),
    "INVERSE_SQRT": lambda a, b, c: _inverse_sqrt(a),
    "ABSOLUTE": lambda a, b, c: np.abs(a),
    "EXPONENT": lambda a, b, c: np.exp(a),
    "MINIMUM": lambda a, b, c: np.minimum(a, b),
    "MAXIMUM": lambda a, b, c: np.maximum(a, b),
    "LESS_THAN": lambda a, b, c: a < b,
    "GREATER_THAN": lambda a, b, c: a > b,
    "SIGN": lambda a, b, c: np.sign(a),
    "COMPARE": _compare,
    "SMOOTH_MIN": _smooth_minimum,
    "SMOOTH_MAX": lambda a, b, c: -_smooth_minimum(-a, -b, c),
    "ROUND": lambda a, b, c: np.floor(a + 0.5),
    "FLOOR": lambda a, b, c: np.floor(a),
    "CEIL": lambda a, b, c: np.ceil(a),
    "TRUNC": lambda a, b, c: np.trunc(a),
    "FRACT": lambda a, b, c: a - np.floor(a),
    "MODULO": lambda a, b, c: _modulo(a, b),
    "FLOORED_MODULO": lambda a, b, c: _floored_modulo(a, b),
    "WRAP": _wrap,
    "SNAP": lambda a, b, c: np.floor(_divide(a, b)) * b,
    "PINGPONG": lambda a, b, c: _pingpong(a, b),
    "SINE": lambda a, b, c: np.sin(a),
    "COSINE": lambda a, b, c: np.cos(a),
    "TANGENT": lambda a, b, c: np.tan(a),
    "ARCSINE": lambda a, b, c: np.arcsin(np.clip(a, -1, 1)),
    "ARCCOSINE": lambda a, b, c: np.arccos(np.clip(a, -1, 1)),
    "ARCTANGENT": lambda a, b, c: np.arctan(a),
    "ARCTAN2": lambda a, b, c: np.arctan2(a, b) * ((a != 0) | (b != 0)),
    "SINH": lambda a, b, c: np.sinh(a),
    "COSH": lambda a, b, c: np.cosh(a),
    "TANH": lambda a, b, c: np.tanh(a),
    "RADIANS": lambda a, b, c: np.radians(a),
    "DEGREES": lambda a, b, c: np.degrees(a),
}
"""Operation by Blender's identifier: values a, b, c of shape () or (n,) to a value."""


def math(operation: str, a: np.ndarray, b: np.ndarray, c: np.ndarray, clamp: bool) -> np.ndarray:
    """The Math node: `operation` on values of shape () or (n,), clamped to 0..1 if `clamp`."""
    result = np.asarray(OPERATIONS[operation](a, b, c), dtype=np.float64)
    return np.clip(result, 0.0, 1.0) if clamp else result
