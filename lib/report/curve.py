# SPDX-License-Identifier: GPL-3.0-or-later
"""The bound against time, as a drawing for the report."""

from __future__ import annotations

import math
from collections.abc import Callable

from markupsafe import Markup, escape

from ..comparison.interim import BoundAt
from ..pages.formats import format_bound, format_duration
from ..plural import plural

_WIDTH, _HEIGHT, _LEFT, _BOTTOM, _MARGIN = 640, 220, 64, 34, 28
_STEPS = (1.0, 2.0, 5.0)


def draw_bound(history: tuple[BoundAt, ...], tolerance: float) -> Markup | None:
    """Draw the bound over time as an SVG, with the tolerance as a line.

    Both axes are logarithmic. None where fewer than two looks gave a bound.
    """
    seen = [one for one in history if math.isfinite(one.bound) and one.bound > 0.0 and one.seconds > 0.0]
    if len(seen) < 2:
        return None
    seconds, bounds = [one.seconds for one in seen], [*(one.bound for one in seen), tolerance]
    x = _axis(min(seconds), max(seconds), _LEFT, _WIDTH - _MARGIN)
    y = _axis(min(bounds), max(bounds), _HEIGHT - _BOTTOM, _MARGIN)
    parts = [f'<svg class="curve" viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" aria-label="Bound against time">']
    for value in _ticks(min(bounds), max(bounds)):
        label = escape(format_bound(value))
        parts.append(
            f'<line class="grid" x1="{_LEFT}" x2="{_WIDTH - _MARGIN}" y1="{y(value):.1f}" y2="{y(value):.1f}"/>'
        )
        parts.append(f'<text x="{_LEFT - 8}" y="{y(value) + 4:.1f}" text-anchor="end">{label}</text>')
    for value in _ticks(min(seconds), max(seconds)):
        label = escape(format_duration(value))
        parts.append(f'<text x="{x(value):.1f}" y="{_HEIGHT - 10}" text-anchor="middle">{label}</text>')
    level = f"{y(tolerance):.1f}"
    parts.append(f'<line class="tolerance" x1="{_LEFT}" x2="{_WIDTH - _MARGIN}" y1="{level}" y2="{level}"/>')
    main = [one for one in seen if not one.first]
    points = " ".join(f"{x(one.seconds):.1f},{y(one.bound):.1f}" for one in main)
    parts.append(f'<polyline points="{points}"/>')
    for one in seen:
        title = escape(
            f"{format_bound(one.bound)} after {format_duration(one.seconds)}, {plural(one.replicates, 'replicate')}"
        )
        kind = "first" if one.first else "look"
        parts.append(
            f'<circle class="{kind}" cx="{x(one.seconds):.1f}" cy="{y(one.bound):.1f}" r="3.5"><title>{title}</title></circle>'
        )
    return Markup("".join([*parts, "</svg>"]))


def _axis(low: float, high: float, start: float, end: float) -> Callable[[float], float]:
    """A function from a value to its place on a logarithmic axis.

    If there is only one value, it lies in the middle.
    """
    span = math.log(high / low)
    return lambda value: start + (end - start) * (math.log(value / low) / span if span > 0.0 else 0.5)


def _ticks(low: float, high: float) -> list[float]:
    """The numbers 1, 2 and 5 times a power of ten between two values."""
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    return [step * 10.0**power for power in powers for step in _STEPS if low <= step * 10.0**power <= high]
