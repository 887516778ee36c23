# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure: D for the four sigmas of the lecture.

The integral of D cos stands beside each curve.
"""

from __future__ import annotations

import numpy as np

from ..microfacets.beckmann import Beckmann
from ..microfacets.densities import pdf_d_cos
from ..microfacets.ggx import GGX
from .figure import Figure
from .quadrature import integrate_normals
from .svg import Axis, Line, plot_lines

SIGMAS = (0.01, 0.1, 0.3, 0.5)


def illustrate_densities(seed: int) -> Figure:
    """D(m) of Beckmann and GGX against theta; nothing in it is random."""
    degrees = np.concatenate([np.linspace(0.0, 5.0, 101)[:-1], np.linspace(5.0, 89.0, 169)])
    theta = np.radians(degrees)
    m = np.stack([np.sin(theta), np.zeros_like(theta), np.cos(theta)])
    lines, rows = [], []
    for distribution, name in ((Beckmann(), "Beckmann"), (GGX(), "GGX")):
        for colour, sigma in enumerate(SIGMAS):
            integral = integrate_normals(
                lambda at, d=distribution, s=sigma: pdf_d_cos(at, d.density(at, np.float64(s), np.float64(s))), sigma
            )
            density = distribution.density(m, np.float64(sigma), np.float64(sigma))
            lines.append(Line(degrees, density, f"{name} {sigma:g}: {integral:.6f}", colour, name == "GGX"))
            rows.append({"distribution": name, "sigma": sigma, "integral": integral, "density": density.tolist()})
    up = Axis("D (1/sr)", 1e-4, 1e4, [10.0**k for k in range(-4, 5)], logarithmic=True)
    drawing = plot_lines(lines, Axis("θ (°)", 0.0, 90.0, range(0, 91, 15)), up, "D(θ)")
    return Figure(drawing, {"degrees": degrees.tolist(), "curves": rows})
