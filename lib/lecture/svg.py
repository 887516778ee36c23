# SPDX-License-Identifier: GPL-3.0-or-later
"""Line plots and discs of directions as SVG, in the colours of the page."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup, escape

_WIDTH, _HEIGHT, _LEFT, _RIGHT, _TOP, _BOTTOM = 700, 320, 62, 210, 16, 40


@dataclass(frozen=True)
class Line:
    """A line of a plot.

    It has points, a name at the end, and one of the four colours; dashed lines are a second kind.
    """

    x: np.ndarray
    y: np.ndarray
    name: str
    colour: int
    dashed: bool = False


@dataclass(frozen=True)
class Axis:
    """An axis: its title, its range, its marks, and whether it is logarithmic."""

    title: str
    low: float
    high: float
    marks: Sequence[float]
    logarithmic: bool = False

    def place(self, start: float, end: float) -> Callable[[float], float]:
        """A function from a value to its place between two ends."""
        scale: Callable[[float], float] = math.log if self.logarithmic else float
        low, high = scale(self.low), scale(self.high)
        return lambda value: start + (end - start) * (scale(value) - low) / (high - low)


def plot_lines(lines: Sequence[Line], across: Axis, up: Axis, label: str) -> Markup:
    """Draw a plot as SVG.

    What lies outside the vertical axis is cut off, and names stand in a column at the right.
    """
    x, y = across.place(_LEFT, _WIDTH - _RIGHT), up.place(_HEIGHT - _BOTTOM, _TOP)
    parts = [
        f'<div class="plot"><svg class="curve" viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" aria-label="{escape(label)}">'
    ]
    for mark in up.marks:
        parts.append(
            f'<line class="grid" x1="{_LEFT}" x2="{_WIDTH - _RIGHT}" y1="{y(mark):.1f}" y2="{y(mark):.1f}"/>'
            f'<text x="{_LEFT - 6}" y="{y(mark) + 4:.1f}" text-anchor="end">{mark:g}</text>'
        )
    for mark in across.marks:
        parts.append(f'<text x="{x(mark):.1f}" y="{_HEIGHT - 22}" text-anchor="middle">{mark:g}</text>')
    middle = 0.5 * (_LEFT + _WIDTH - _RIGHT)
    parts.append(f'<text x="{middle}" y="{_HEIGHT - 6}" text-anchor="middle">{escape(across.title)}</text>')
    parts.append(f'<text x="{_LEFT + 6}" y="{_TOP + 4}">{escape(up.title)}</text>')
    for row, line in enumerate(lines):
        inside = (line.y >= up.low) & (line.y <= up.high)
        points = " ".join(f"{x(a):.1f},{y(b):.1f}" for a, b in zip(line.x[inside], line.y[inside], strict=True))
        kind = f"c{line.colour}" + (" dashed" if line.dashed else "")
        at = _TOP + 14 + 17 * row
        parts.append(f'<polyline class="{kind}" points="{points}"/>')
        parts.append(
            f'<line class="{kind}" x1="{_WIDTH - _RIGHT + 6}" x2="{_WIDTH - _RIGHT + 24}" y1="{at - 4}" y2="{at - 4}"/>'
        )
        parts.append(f'<text x="{_WIDTH - _RIGHT + 29}" y="{at}">{escape(line.name)}</text>')
    return Markup("".join([*parts, "</svg></div>"]))


def draw_disc(title: str, content: Sequence[str]) -> Markup:
    """Draw the hemisphere seen from above, as the unit disc.

    `content` is SVG in units of its radius, y upwards.
    """
    return Markup(
        f'<figure><svg class="disc" viewBox="-1.05 -1.05 2.1 2.1" role="img" aria-label="{escape(title)}"><g transform="scale(1,-1)">'
        f'<circle class="rim" r="1"/>{"".join(content)}</g></svg><figcaption>{escape(title)}</figcaption></figure>'
    )


def draw_dots(w: np.ndarray, colour: int) -> list[str]:
    """Directions (3, n) as dots in their disc."""
    return [f'<circle class="f{colour}" cx="{x:.3f}" cy="{y:.3f}" r=".012"/>' for x, y in zip(w[0], w[1], strict=True)]


def draw_loop(w: np.ndarray, kind: str) -> str:
    """Points (2 or 3, n) as a closed outline of the CSS class `kind`."""
    return f'<polygon class="{kind}" points="{" ".join(f"{x:.3f},{y:.3f}" for x, y in zip(w[0], w[1], strict=True))}"/>'
