# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a computed number is from the truth.

The unit is the last place, divided by one plus the condition number. The condition number of f at x is
sum |x_k df/dx_k| / |f|: what a change of the arguments in their last places does to the value, however it is computed.
Dividing by it leaves what the formula itself has lost.
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
    """A float32 form and its truth.

    The truth is the form's own where it means another quantity than the reference's.
    """

    kernel: Kernel
    truth: Truth | None = None


@dataclass(frozen=True)
class Function:
    """One equation: its domain, the reference's kernel, the truth, and the float32 forms.

    `draw(rng, count)` gives arguments (k, n) in float64; a kernel takes them and gives values (n,) or (c, n); `truth`
    takes k mpmath numbers and gives the c values. `names` are those of the k arguments. Where the reference gives
    digits away on purpose, `sizes` says of which magnitude an argument counts to its last place (instead of its own),
    (k, n), or `slack` what is added to the condition number, (n,), and `excuse` why.
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
    sizes: Callable[[np.ndarray], np.ndarray] | None = None
    slack: Callable[[np.ndarray], np.ndarray] | None = None
    excuse: str = ""


def measure(function: Function, count: int) -> Case:
    """The largest error of the function and of its float32 forms.

    There are about `count` points, seeded by the function's name.
    """
    arguments = function.draw(np.random.default_rng(zlib.crc32(function.name.encode())), count)
    sizes = function.sizes(arguments) if function.sizes else None
    slack = function.slack(arguments) if function.slack else 0.0
    found, judged = errors(function.kernel(arguments), arguments, function.truth, 53, sizes, slack)
    index = int(np.argmax(found))
    where = ", ".join(f"{name} {value:.6g}" for name, value in zip(function.names, arguments[:, index], strict=True))
    forms = [_single(form, arguments, function.truth) for form in (function.printed, function.cycles)]
    return Case(
        function.family,
        function.name,
        float(found[index]),
        function.bound,
        "ulp / (1 + condition)",
        where,
        *forms,
        judged=float(judged.max()),
        excuse=function.excuse,
        points=arguments.shape[1],
    )


def errors(
    got: np.ndarray,
    arguments: np.ndarray,
    truth: Truth,
    bits: int,
    sizes: np.ndarray | None = None,
    slack: np.ndarray | float = 0.0,
) -> np.ndarray:
    """The error of each point, in ulps of `bits` bits over (1 + condition), (2, n).

    It is that of the largest component. The second row takes `sizes` and `slack` (see `Function`) into the condition
    number.
    """
    got = np.atleast_2d(got)
    count = arguments.shape[1]
    factors = np.ones(arguments.shape)
    if sizes is not None:
        np.divide(sizes, np.abs(arguments), out=factors, where=arguments != 0.0)
    slack = np.broadcast_to(slack, (count,))
    found = np.empty((2, count))
    with mp.workdps(DIGITS):
        for k in range(count):
            at = [mp.mpf(float(a)) for a in arguments[:, k]]
            found[:, k] = _error(got[:, k], at, truth, bits, factors[:, k].tolist(), float(slack[k]))
    return found


def _single(form: Single | None, arguments: np.ndarray, truth: Truth) -> float | None:
    if form is None:
        return None
    with np.errstate(over="ignore"):
        rounded = arguments.astype(np.float32)
    # Towards zero, so that a uniform or a cosine below 1 stays below it.
    rounded = np.where(np.abs(rounded) > np.abs(arguments), np.nextafter(rounded, np.float32(0.0)), rounded)
    with np.errstate(all="ignore"):
        got = form.kernel(rounded)
    return float(errors(got, rounded.astype(np.float64), form.truth or truth, 24)[0].max())


def _error(
    got: np.ndarray, at: list[mp.mpf], truth: Truth, bits: int, factors: list[float], slack: float
) -> tuple[float, float]:
    """Over the components of one point, without and with what is excused."""
    if not np.isfinite(got).all():
        return math.inf, math.inf
    exact = truth(*at)
    shifted = [(truth(*at[:k], a - a * _STEP, *at[k + 1 :]), factors[k]) for k, a in enumerate(at) if a]
    worst = judged = 0.0
    for c, (value, target) in enumerate(zip(got, exact, strict=True)):
        slopes = [(abs(other[c] - target) / _STEP, factor) for other, factor in shifted]
        unit = _last_place(target, bits)
        scale = unit / abs(target) if target else mp.mpf(2) ** (1 - bits)
        error = abs(mp.mpf(float(value)) - target)
        worst = max(worst, _ratio(error, unit + scale * mp.fsum(slope for slope, _ in slopes)))
        judged = max(judged, _ratio(error, unit * (1 + slack) + scale * mp.fsum(a * b for a, b in slopes)))
    return worst, judged


def _ratio(error: mp.mpf, room: mp.mpf) -> float:
    return min(float(error / room), _MOST)


def _last_place(value: mp.mpf, bits: int) -> mp.mpf:
    """The distance between neighbouring numbers of `bits` bits at `value`.

    Below the smallest normal number all values count as 0.
    """
    least = -1022 if bits == 53 else -126
    if not value:
        return mp.ldexp(1, least)
    _, exponent = mp.frexp(abs(value))
    return mp.ldexp(1, max(exponent - bits, least))
