# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a computed number is from the truth: in units of the last place, divided by one plus the condition number.

The condition number of f at x is sum |x_k df/dx_k| / |f|: what a change of the arguments in their last places does to the value,
however it is computed. Dividing by it leaves what the formula itself has lost.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable
from dataclasses import dataclass

import mpmath as mp
import numpy as np

from .case import Case

DIGITS = 110
"""Digits of the arithmetic: at least 50 are left of what cancels in the definitions (sqrt(1 + s) - 1 at s = 1e-40)."""
_STEP = mp.mpf(10) ** -20
_MOST = 1e300

Truth = Callable[..., "tuple[mp.mpf, ...]"]
Kernel = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Single:
    """A float32 form and the truth it aims at (its own, where it means another quantity than the reference's)."""

    kernel: Kernel
    truth: Truth | None = None


@dataclass(frozen=True)
class Function:
    """One equation: where it is asked, the reference's kernel, the truth, and the float32 forms.

    `draw(rng, count)` gives arguments (k, n) in float64; a kernel takes them and gives values (n,) or (c, n); `truth` takes k mpmath
    numbers and gives the c values. `names` are those of the k arguments.
    """

    family: str
    name: str
    names: tuple[str, ...]
    draw: Callable[[np.random.Generator, int], np.ndarray]
    kernel: Kernel
    truth: Truth
    bound: float
    printed: Single | None = None
    cycles: Single | None = None
    excuse: str = ""


def measure(function: Function, count: int) -> Case:
    """The largest error of the function and of its float32 forms over about `count` points, seeded by its name."""
    arguments = function.draw(np.random.default_rng(zlib.crc32(function.name.encode())), count)
    worst, index = _worst(function.kernel(arguments), arguments, function.truth, 53)
    where = ", ".join(f"{name} {value:.6g}" for name, value in zip(function.names, arguments[:, index], strict=True))
    forms = [_single(form, arguments, function.truth) for form in (function.printed, function.cycles)]
    return Case(
        function.family,
        function.name,
        worst,
        function.bound,
        "ulp / (1 + condition)",
        where,
        *forms,
        excuse=function.excuse,
        points=arguments.shape[1],
    )


def errors(got: np.ndarray, arguments: np.ndarray, truth: Truth, bits: int) -> np.ndarray:
    """The error of each point, the largest of its components, in ulps of `bits` bits over (1 + condition), (n,)."""
    got = np.atleast_2d(got)
    found = np.empty(arguments.shape[1])
    with mp.workdps(DIGITS):
        for k in range(arguments.shape[1]):
            found[k] = _error(got[:, k], [mp.mpf(float(a)) for a in arguments[:, k]], truth, bits)
    return found


def _worst(got: np.ndarray, arguments: np.ndarray, truth: Truth, bits: int) -> tuple[float, int]:
    found = errors(got, arguments, truth, bits)
    index = int(np.argmax(found))
    return float(found[index]), index


def _single(form: Single | None, arguments: np.ndarray, truth: Truth) -> float | None:
    if form is None:
        return None
    with np.errstate(over="ignore"):
        rounded = arguments.astype(np.float32)
    # Towards zero, so that a uniform or a cosine below 1 stays below it.
    rounded = np.where(np.abs(rounded) > np.abs(arguments), np.nextafter(rounded, np.float32(0.0)), rounded)
    with np.errstate(all="ignore"):
        got = form.kernel(rounded)
    return _worst(got, rounded.astype(np.float64), form.truth or truth, 24)[0]


def _error(got: np.ndarray, at: list[mp.mpf], truth: Truth, bits: int) -> float:
    """Over the components of one point."""
    exact = truth(*at)
    shifted = [truth(*at[:k], a - a * _STEP, *at[k + 1 :]) if a else None for k, a in enumerate(at)]
    worst = 0.0
    for c, (value, target) in enumerate(zip(got, exact, strict=True)):
        if not math.isfinite(value):
            return math.inf
        slope = sum((abs(other[c] - target) for other in shifted if other is not None), mp.mpf(0)) / _STEP
        unit = _last_place(target, bits)
        scale = unit / abs(target) if target else mp.mpf(2) ** (1 - bits)
        worst = max(worst, min(float(abs(mp.mpf(float(value)) - target) / (unit + scale * slope)), _MOST))
    return worst


def _last_place(value: mp.mpf, bits: int) -> mp.mpf:
    """The distance between neighbouring numbers of `bits` bits at `value`, no less than that of the smallest ones."""
    least = -1074 if bits == 53 else -149
    if not value:
        return mp.ldexp(1, least)
    _, exponent = mp.frexp(abs(value))
    return mp.ldexp(1, max(exponent - bits, least))
