# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure: "Uniforme ?", the radiance of one glossy point by four strategies.

It has errors, slopes and seconds.
"""

from __future__ import annotations

import time

import numpy as np
from markupsafe import Markup

from ..bsdfs.microfacet import MicrofacetReflection
from ..microfacets.ggx import GGX
from ..sampling.sobol import RandomSampler, SobolSampler
from .figure import Figure
from .svg import Axis, Line, plot_lines

SIGMA, DEGREES = 0.1, 45.0
STRATEGIES = ("uniform", "cosine", "d_cos", "visible")
SIZES = (16, 64, 256, 1024, 4096)
REPLICATES = 64
_SUN = np.array([-0.8, 0.36, 0.48])


def radiance(wi: np.ndarray) -> np.ndarray:
    """The sky of the figure, (n,) W m^-2 sr^-1.

    It has a uniform part and a broad light near the mirror direction.
    """
    return 0.5 + 2.0 * np.exp(12.0 * (_SUN @ wi - 1.0))


def make_lobe(strategy: str, count: int) -> MicrofacetReflection:
    """The lobe of the figure.

    It is GGX with height-correlated masking, and one observer for all samples.
    """
    angle = np.radians(DEGREES)
    wo = np.repeat(np.array([[np.sin(angle)], [0.0], [np.cos(angle)]]), count, axis=1)
    return MicrofacetReflection(wo, np.array(SIGMA), np.array(SIGMA), GGX(), "correlated", strategy)


def estimate(strategy: str, u1: np.ndarray, u2: np.ndarray) -> np.ndarray:
    """G / p for each pair of uniforms, (n,): radiance times the lobe's weight."""
    wi, weight, _ = make_lobe(strategy, u1.size).sample(u1, u2)
    return radiance(wi) * weight[0]


def integrate_reflected(nodes: int = 240) -> float:
    """The radiance that the estimators estimate.

    Gauss-Legendre in cos(theta), the trapezoidal rule in phi.
    """
    node, weight = np.polynomial.legendre.leggauss(nodes)
    cosine, phi = 0.5 * (1.0 + node), 2.0 * np.pi * np.arange(2 * nodes) / (2 * nodes)
    total = 0.0
    for z, w in zip(cosine, 0.5 * weight, strict=True):
        sine = np.sqrt(1.0 - z * z)
        wi = np.stack([sine * np.cos(phi), sine * np.sin(phi), np.full_like(phi, z)])
        total += w * 2.0 * np.pi * float((make_lobe("uniform", phi.size).evaluate(wi)[0][0] * radiance(wi)).mean())
    return total


def measure_errors(
    strategy: str, sampler: type[RandomSampler] | type[SobolSampler], seed: int, truth: float
) -> np.ndarray:
    """The relative error, root mean square over replicates, at each of SIZES."""
    errors = []
    for size in SIZES:
        means = []
        for replicate in range(REPLICATES):
            tile = sampler(seed, replicate, size).tile(np.zeros(1))
            means.append(estimate(strategy, *tile.pair(0, np.zeros(size, np.intp), np.arange(size))).mean())
        errors.append(np.sqrt(((np.array(means) - truth) ** 2).mean()) / truth)
    return np.array(errors)


def find_slope(errors: np.ndarray) -> float:
    """The slope of error against samples, both logarithmic."""
    return float(np.polyfit(np.log(SIZES), np.log(errors), 1)[0])


def seconds_per_sample(strategy: str, seed: int) -> float:
    """The least of five times to take 2^16 samples, divided by their number."""
    u1, u2 = np.random.default_rng(seed).random((2, 1 << 16))
    times = []
    for _ in range(5):
        start = time.perf_counter()
        estimate(strategy, u1, u2)
        times.append(time.perf_counter() - start)
    return min(times) / u1.size


def illustrate_uniform(seed: int) -> Figure:
    """Independent samples as full lines, Owen-scrambled Sobol' points as dashed ones."""
    truth = integrate_reflected()
    lines, rows = [], []
    for colour, strategy in enumerate(STRATEGIES):
        seconds = seconds_per_sample(strategy, seed)
        for sampler, kind in ((RandomSampler, "random"), (SobolSampler, "Sobol'")):
            errors = measure_errors(strategy, sampler, seed, truth)
            slope = find_slope(errors)
            lines.append(Line(np.array(SIZES), errors, f"{strategy} {kind} {slope:+.2f}", colour, kind != "random"))
            row = {"strategy": strategy, "sampler": kind, "errors": errors.tolist(), "slope": slope}
            # Independent samples of one millisecond, by the error of one sample.
            at_once = errors[-1] * np.sqrt(SIZES[-1] * seconds / 1e-3) if kind == "random" else None
            rows.append({**row, "nanoseconds": 1e9 * seconds, "error_after_1_ms": at_once})
    low = min(line.y.min() for line in lines)
    powers = [10.0**k for k in range(int(np.floor(np.log10(low))), 2)]
    drawing = plot_lines(
        lines,
        Axis("N", SIZES[0], SIZES[-1], SIZES, logarithmic=True),
        Axis("erreur relative / relative error", powers[0], powers[-1], powers, logarithmic=True),
        "error against samples",
    )
    numbers = {
        "sigma": SIGMA,
        "degrees": DEGREES,
        "truth": truth,
        "samples": SIZES,
        "replicates": REPLICATES,
        "seed": seed,
    }
    return Figure(drawing + _times(rows), {**numbers, "lines": rows})


def _times(rows: list[dict]) -> Markup:
    """A table of seconds: the same point, the same millisecond."""
    cells = "".join(
        f'<tr><td>{row["strategy"]}</td><td class="number">{row["nanoseconds"]:.0f} ns</td>'
        f'<td class="number">{row["error_after_1_ms"]:.2%}</td></tr>'
        for row in rows
        if row["error_after_1_ms"] is not None
    )
    head = '<tr><th></th><th class="number">1 sample / tirage</th><th class="number">error / erreur, 1 ms</th></tr>'
    return Markup(f'<div class="plot"><table class="narrow">{head}{cells}</table></div>')
