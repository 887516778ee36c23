# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure: the inversions, from (xi1, xi2) to m to i.

The Jacobian is shown as the stretch of a cell.
"""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from ..microfacets.beckmann import Beckmann
from ..vectors import cross, dot
from . import captions
from .figure import Figure, Words, show_words
from .svg import draw_disc, draw_loop

SIGMA, DEGREES, CELLS = 0.3, 30.0, 12
_CELL = (4, 7)
_EDGE = 16


def normals(u1: np.ndarray, u2: np.ndarray) -> np.ndarray:
    """Example 2 of the lecture: m from xi1 and xi2, (3, n)."""
    return Beckmann().sample_d_cos(np.float64(SIGMA), np.float64(SIGMA), u1, u2)


def observer() -> np.ndarray:
    """The direction wo of the figure, (3,)."""
    angle = np.radians(DEGREES)
    return np.array([np.sin(angle), 0.0, np.cos(angle)])


def reflect(m: np.ndarray) -> np.ndarray:
    """Directions i = 2 (o.m) m - o, (3, n)."""
    return 2.0 * (observer() @ m) * m - observer()[:, None]


def solid_angle(corners: np.ndarray) -> float:
    """The solid angle of a grid of directions (3, k, k).

    It is the sum over spherical triangles (Van Oosterom and Strackee 1983).
    """
    a, b, c, d = (
        w.reshape(3, -1) for w in (corners[:, :-1, :-1], corners[:, 1:, :-1], corners[:, 1:, 1:], corners[:, :-1, 1:])
    )
    total = 0.0
    for p, q, r in ((a, b, c), (a, c, d)):
        volume = np.abs(dot(p, cross(q, r)))
        total += float(2.0 * np.arctan2(volume, 1.0 + dot(p, q) + dot(q, r) + dot(r, p)).sum())
    return total


def cell_grid(row: float, column: float, parts: int) -> np.ndarray:
    """(xi1, xi2) at the corners of the parts of a cell, (2, parts + 1, parts + 1).

    The cell is divided into parts x parts.
    """
    along = np.linspace(0.0, 1.0, parts + 1)
    return np.stack(np.meshgrid((column + along) / CELLS, (row + along) / CELLS, indexing="ij"))


def cell_outline(row: int, column: int) -> np.ndarray:
    """(xi1, xi2) round the border of a cell, (2, n)."""
    t = np.arange(_EDGE) / _EDGE
    zero, one = np.zeros(_EDGE), np.ones(_EDGE)
    x, y = np.concatenate([t, one, 1.0 - t, zero]), np.concatenate([zero, t, one, 1.0 - t])
    # xi2 = 1 is the horizon, at no finite slope
    return np.stack([(column + x) / CELLS, np.minimum((row + y) / CELLS, 1.0 - 1e-9)])


def stretch(row: float, column: float) -> tuple[float, float]:
    """The factor by which reflection widens a cell of normals.

    Also returns the mean of 4 |o.m| over the same cell.
    """
    m = normals(*cell_grid(row, column, 64).reshape(2, -1))
    grid = m.reshape(3, 65, 65)
    widened = solid_angle(reflect(m).reshape(3, 65, 65)) / solid_angle(grid)
    return widened, float(4.0 * np.abs(observer() @ m).mean())


def illustrate_inversions(seed: int) -> Figure:
    """A grid of cells in the unit square, on the disc of normals, and on that of directions.

    The figure has no random part.
    """
    square: list[str] = []
    discs: tuple[list[str], list[str]] = ([], [])
    for row in range(CELLS):
        for column in range(CELLS):
            outline = cell_outline(row, column)
            kind = "cell chosen" if (row, column) == _CELL else "cell"
            square.append(draw_loop(outline * 1.4 - 0.7, kind))
            m = normals(*outline)
            discs[0].append(draw_loop(m, kind))
            wi = reflect(m)
            if wi[2].min() > 0.0:
                discs[1].append(draw_loop(wi, kind))
    measured, expected = stretch(*_CELL)
    names = ("(ξ1, ξ2)", "m", f"i: × {measured:.3f}; 4 |o.m| = {expected:.3f}")
    drawn = Markup("").join(draw_disc(n, c) for n, c in zip(names, (square, *discs), strict=True))
    numbers = {
        "sigma": SIGMA,
        "degrees": DEGREES,
        "cells": CELLS,
        "cell": _CELL,
        "stretch": measured,
        "four_cos": expected,
    }
    return Figure(Markup('<div class="discs">') + drawn + Markup("</div>") + _controls(), numbers)


def _controls() -> Markup:
    """The controls that `inversions.js` shows; hidden without JavaScript.

    They are a slider for each number, and what follows from them.
    """
    sliders = (
        ("xi1", Words("ξ1", "ξ1"), 0.0, 1.0, 0.005),
        ("xi2", Words("ξ2", "ξ2"), 0.0, 0.995, 0.005),
        ("sigma", Words("sigma", "sigma"), 0.05, 1.0, 0.01),
        ("degrees", captions.OBSERVER, 0.0, 85.0, 1.0),
    )
    rows = [
        Markup(
            '<label>{} <input type="range" name="{}" min="{}" max="{}" step="{}"> <output data-shows="{}"></output></label>'
        ).format(show_words(label), name, low, high, step, name)
        for name, label, low, high, step in sliders
    ]
    said = Markup(
        '<p aria-live="polite">m: <output data-shows="m"></output><br>i: <output data-shows="i"></output> '
        '<b class="below" hidden>{}</b><br>{} × <output data-shows="widened"></output>; 4 |o.m| = '
        '<output data-shows="four"></output></p>'
    ).format(show_words(captions.BELOW), show_words(captions.CELL))
    hint = Markup("<p>{}</p>").format(show_words(captions.DRAG))
    return (
        Markup('<div class="play" id="inversions-play" hidden>')
        + hint
        + Markup("").join(rows)
        + said
        + Markup("</div>")
    )
