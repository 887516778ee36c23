# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure: facets drawn by D cos, and by the normals that the observer sees."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from ..microfacets.beckmann import Beckmann
from ..vectors import dot
from .figure import Figure
from .svg import draw_disc, draw_dots

SIGMA, DEGREES, COUNT, SHOWN = 0.5, 75.0, 4096, 500


def illustrate_facets(seed: int) -> Figure:
    """Normals on their disc.

    Red ones do not face the observer, or send light below the surface.
    """
    angle = np.radians(DEGREES)
    wo = np.repeat(np.array([[np.sin(angle)], [0.0], [np.cos(angle)]]), COUNT, axis=1)
    u1, u2 = np.random.default_rng(seed).random((2, COUNT))
    sigma, beckmann = np.float64(SIGMA), Beckmann()
    drawn = {
        "D cos": beckmann.sample_d_cos(sigma, sigma, u1, u2),
        "visible": beckmann.sample_visible(wo, sigma, sigma, u1, u2, beckmann.smith_lambda(wo, sigma, sigma)),
    }
    discs, rows = [], []
    for name, m in drawn.items():
        facing = dot(wo, m) > 0.0
        useful = facing & (2.0 * dot(wo, m) * m[2] - wo[2] > 0.0)
        dots = [*draw_dots(m[:, :SHOWN][:, useful[:SHOWN]], 0), *draw_dots(m[:, :SHOWN][:, ~useful[:SHOWN]], 1)]
        discs.append(draw_disc(f"{name}: {useful.mean():.1%}", dots))
        rows.append(
            {
                "by": name,
                "facing": float(facing.mean()),
                "useful": float(useful.mean()),
                "m": m[:, :SHOWN].round(4).tolist(),
            }
        )
    numbers = {"sigma": SIGMA, "degrees": DEGREES, "samples": COUNT, "seed": seed, "drawn": rows}
    return Figure(Markup('<div class="discs">') + Markup("").join(discs) + Markup("</div>"), numbers)
