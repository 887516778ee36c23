# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure: the five slips of the slides.

Each has a number that decides, computed here by quadrature.
"""

from __future__ import annotations

import numpy as np
from markupsafe import Markup, escape

from ..bsdfs.microfacet import MicrofacetReflection
from ..microfacets.beckmann import Beckmann
from ..microfacets.densities import pdf_d_cos
from ..microfacets.masking import torrance_sparrow
from .figure import Figure
from .quadrature import integrate_normals

SIGMA = np.float64(0.3)
WO = np.array([0.28, 0.0, 0.96])


def _exponent(m: np.ndarray, divisor: float) -> np.ndarray:
    """exp(-tan^2 / (divisor sigma^2)) / (pi sigma^2 cos^4) times cos."""
    tan2 = (m[0] ** 2 + m[1] ** 2) / m[2] ** 2
    return np.exp(-tan2 / (divisor * SIGMA**2)) / (np.pi * SIGMA**2 * m[2] ** 3)


def _masked(m: np.ndarray) -> np.ndarray:
    """D G1(o) (o.m), the light that white facets reflect in each solid angle of m.

    It is written after the change of variable 4 (o.m).
    """
    beckmann = Beckmann()
    shared = 1.0 / (1.0 + beckmann.smith_lambda(WO[:, None], SIGMA, SIGMA))
    return beckmann.density(m, SIGMA, SIGMA) * shared * np.maximum(WO @ m, 0.0)


def _of_normals(m: np.ndarray) -> np.ndarray:
    return pdf_d_cos(m, Beckmann().density(m, SIGMA, SIGMA))


def printed_at_ends() -> np.ndarray:
    """The printed forms at the ends of their domains, (4,).

    They are G and D at grazing directions, g / p at xi2 = 1, and f cos at a grazing light.
    """
    flat = np.zeros(1)
    with np.errstate(all="ignore"):
        masking = 2.0 * flat / flat
        density = np.exp(-(1.0 - flat**2) / flat**2 / SIGMA**2) / (np.pi * SIGMA**2 * flat**4)
        theta = np.arctan(np.sqrt(-(SIGMA**2) * np.log(flat)))
        pdf = np.exp(-(np.tan(theta) ** 2) / SIGMA**2) / (np.pi * SIGMA**2 * np.cos(theta) ** 3)
        lobe = 1.0 / (4.0 * flat) * flat
        return np.concatenate([masking, density, pdf / pdf, lobe])


def reference_at_ends() -> np.ndarray:
    """What the reference gives at the same places, (4,): 0, 0, 1, 0."""
    up, flat, back = (np.array(w)[:, None] for w in ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]))
    beckmann = Beckmann()
    m = beckmann.sample_d_cos(SIGMA, SIGMA, np.full(1, 0.25), np.ones(1))
    pdf = pdf_d_cos(m, beckmann.density(m, SIGMA, SIGMA))
    alpha = np.array(SIGMA)
    lobe = MicrofacetReflection(up, alpha, alpha, beckmann, "correlated", "visible").evaluate(flat)[0][0]
    return np.concatenate([torrance_sparrow(back, flat, up), beckmann.density(flat, SIGMA, SIGMA), pdf / pdf, lobe])


def count_no_numbers(values: np.ndarray) -> float:
    """How many of the values are not a number."""
    return float(np.isnan(values).sum())


def decide() -> list[dict[str, float]]:
    """For each slip the value of the printed form, and the right value.

    Both are integrals, except for the fifth: there they count places without a number.
    """
    width = float(SIGMA)
    cosine = integrate_normals(lambda m: m[2], 1.0)
    return [
        {
            "printed": integrate_normals(lambda m: _exponent(m, 2.0), width),
            "right": integrate_normals(lambda m: _exponent(m, 1.0), width),
        },
        {
            "printed": integrate_normals(lambda m: _masked(m) / np.pi, width),
            "right": integrate_normals(lambda m: _masked(m) / WO[2], width),
        },
        {
            "printed": integrate_normals(lambda m: _of_normals(m) * 4.0 * np.abs(WO @ m), width),
            "right": integrate_normals(_of_normals, width),
        },
        {"printed": cosine, "right": integrate_normals(lambda m: m[2] / np.pi, 1.0)},
        {"printed": count_no_numbers(printed_at_ends()), "right": count_no_numbers(reference_at_ends())},
    ]


FORMS = (
    ("exp(-tan²θ / 2σ²) / (π σ² cos⁴θ)", "exp(-tan²θ / σ²) / (π σ² cos⁴θ)", "∫ D cos", "slip_1"),
    ("F D G / (4 π cos θ)", "F D G / (4 |i.n| |o.n|)", "∫ f cos", "slip_2"),
    ("pdf = D cos θm", "pdf(i) = D cos θm / (4 |o.m|)", "∫ pdf(i) di", "slip_3"),
    ("pdf(i) = cos θi", "pdf(i) = cos θi / π", "∫ pdf(i) di", "slip_4"),
    ("0 / 0 (G, D, g / p, f cos)", "0, 0, 1, 0", "NaN", "slip_5"),
)
"""Printed form, right form, what is computed of both, and how the names of its tests begin."""


def illustrate_slips(seed: int) -> Figure:
    """The slips as a table; nothing in it is random."""
    rows = decide()
    body = "".join(
        f'<tr><td class="number">{k}</td><td class="form">{escape(was)}</td><td class="form">{escape(now)}</td>'
        f'<td>{escape(what)}</td><td class="number">{row["printed"]:.4g}</td><td class="number">{row["right"]:.4g}</td>'
        f"<td><code>test_{test}_*</code></td></tr>"
        for k, ((was, now, what, test), row) in enumerate(zip(FORMS, rows, strict=True), 1)
    )
    head = "".join(
        f"<th>{name}</th>"
        for name in ("", "printed / imprimé", "right / juste", "", "printed / imprimé", "right / juste", "test")
    )
    return Figure(Markup(f'<div class="scroll"><table>{f"<tr>{head}</tr>"}{body}</table></div>'), {"slips": rows})
