# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure: which geometry underlies G.

It shows facets of traced height fields beside three formulas.
"""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from ..microsurface.measure import figures_of, measure_microsurface
from ..microsurface.models import FORMULAS
from .figure import Figure
from .svg import Axis, Line, plot_lines

ALPHA, ANGLES, FIELDS, CORRELATION = 0.6, (30.0, 60.0, 75.0, 82.0), 4, 8


def illustrate_masking(seed: int) -> Figure:
    """The share of level facets that a direction and its mirror image both see.

    It is traced, and given by each formula.
    """
    found = measure_microsurface(ALPHA, ANGLES, FIELDS, CORRELATION, seed)
    at = np.array(ANGLES)
    lines = [Line(at, np.array([one.shared.mean for one in found]), "traced / tracé", 0)]
    for colour, name in enumerate(FORMULAS, 1):
        lines.append(Line(at, np.array([one.shared_by[name] for one in found]), name, colour, dashed=True))
    marks = np.linspace(0.0, 1.0, 6).tolist()
    drawing = plot_lines(lines, Axis("θ (°)", 25.0, 85.0, ANGLES), Axis("G", 0.0, 1.001, marks), "G against angle")
    said = ", ".join(f"{one.angle:g}°: {one.shared.mean:.3f} ± {one.shared.error:.3f}" for one in found)
    return Figure(
        drawing + Markup(f'<p class="reading">{said}</p>'), figures_of(found, ALPHA, FIELDS, CORRELATION, seed)
    )
