# SPDX-License-Identifier: GPL-3.0-or-later
"""The error and the saving of approximations of the model, and of half the digits.

Savings are in nanoseconds, and all is measured on arrays of a tile. Directions follow the cosine, as light on a white
surface; errors are relative to the exact form at the same arguments, where that is above a millionth of its largest
value. For masking the albedo of the whole lobe is compared, for Lambda it is G1 = 1 / (1 + Lambda).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from time import perf_counter

import numpy as np

from ..microfacets import fresnel, masking
from ..microfacets.beckmann import Beckmann, smith_lambda_rational
from ..microfacets.ggx import GGX
from ..sampling.warps import cosine_hemisphere
from ..vectors import dot

TILE = 16384
REPEATS = 40
ALPHA = 0.36
# About those of gold in red, green and blue, and of glass.
GOLD_ETA, GOLD_K = np.array([[0.16], [0.42], [1.38]]), np.array([[3.48], [2.35], [1.90]])
GLASS_ETA = 1.5
STRATA = 16
TAIL = 1e-6

Kernel = Callable[[], np.ndarray]


@dataclass(frozen=True)
class Form:
    """One form of an equation beside the exact one.

    It has its mean and largest relative error, and nanoseconds an element of both.
    """

    equation: str
    form: str
    exact: str
    mean_error: float
    largest_error: float
    nanoseconds: float
    exact_nanoseconds: float


def measure_forms(seed: int = 0) -> list[Form]:
    """All forms, in the order in which they are shown."""
    rng = np.random.default_rng(seed)
    return [*_fresnel(rng), *_rational(rng), *_masking(rng), *_single(rng)]


def _form(names: tuple[str, str, str], kernel: Kernel, exact: Kernel, size: int, *, albedo: bool = False) -> Form:
    with np.errstate(over="ignore", under="ignore"):
        value, truth = kernel(), exact()
        if albedo:
            value, truth = (v.reshape(STRATA, -1).mean(axis=1) for v in (value, truth))
        usable = truth > TAIL * truth.max()
        error = np.abs(value[usable] - truth[usable]) / np.abs(truth[usable])
        times = _nanoseconds(kernel, exact, size)
    return Form(*names, float(error.mean()), float(error.max()), *times)


def _nanoseconds(kernel: Kernel, exact: Kernel, size: int) -> tuple[float, float]:
    """Medians of calls in turns, so that both meet the same machine."""
    times: tuple[list[float], list[float]] = ([], [])
    for _ in range(REPEATS):
        for k, function in enumerate((kernel, exact)):
            start = perf_counter()
            function()
            times[k].append(perf_counter() - start)
    kernel_time, exact_time = (float(np.median(t)) / size * 1e9 for t in times)
    return kernel_time, exact_time


def _fresnel(rng: np.random.Generator) -> list[Form]:
    cos = np.sqrt(rng.random(TILE))
    gold = partial(fresnel.conductor, cos, GOLD_ETA, GOLD_K)
    glass = partial(fresnel.dielectric, cos, GLASS_ETA)
    gold_f0 = fresnel.conductor(np.ones(1), GOLD_ETA, GOLD_K)
    glass_f0 = float(fresnel.dielectric(np.ones(1), GLASS_ETA)[0])
    forms = []
    for name, exact, f0 in (("Fresnel, gold", gold, gold_f0), ("Fresnel, glass", glass, glass_f0)):
        for label, function in (("Schlick", fresnel.schlick), ("Cook-Torrance", fresnel.cook_torrance)):
            size = TILE * np.size(f0)
            forms.append(_form((name, label, "exact"), partial(function, cos, f0), exact, size))
    return forms


def _rational(rng: np.random.Generator) -> list[Form]:
    wo = cosine_hemisphere(*rng.random((2, TILE)))
    names = ("G1 of Beckmann", "rational Lambda", "exact Lambda")
    rational = partial(_g1, smith_lambda_rational, wo, ALPHA, ALPHA)
    return [_form(names, rational, partial(_g1, Beckmann().smith_lambda, wo, ALPHA, ALPHA), TILE)]


def _g1(smith_lambda: Callable[..., np.ndarray], *arguments: np.ndarray | float) -> np.ndarray:
    return 1.0 / (1.0 + smith_lambda(*arguments))


def _masking(rng: np.random.Generator) -> list[Form]:
    """Albedos of GGX seen under STRATA angles, by visible normals, the same for all forms."""
    cos = np.repeat(np.sqrt((np.arange(STRATA) + 0.5) / STRATA), TILE // STRATA)
    wo = np.stack([np.sqrt(1.0 - cos * cos), np.zeros(TILE), cos])
    m = GGX().sample_visible(wo, ALPHA, ALPHA, *rng.random((2, TILE)))
    wi = 2.0 * dot(wo, m) * m - wo
    lit = wi[2] > 0.0
    weight = np.where(lit, 1.0 + GGX().smith_lambda(wo, ALPHA, ALPHA), 0.0)

    def smith(form: Callable[..., np.ndarray]) -> np.ndarray:
        return weight * form(GGX().smith_lambda(wi, ALPHA, ALPHA), GGX().smith_lambda(wo, ALPHA, ALPHA))

    def cavities() -> np.ndarray:
        return weight * masking.torrance_sparrow(wi, wo, m)

    exact = partial(smith, masking.height_correlated)
    return [
        _form(("albedo of GGX, by masking", label, "height-correlated"), kernel, exact, TILE, albedo=True)
        for label, kernel in (("separable", partial(smith, masking.separable)), ("Torrance-Sparrow", cavities))
    ]


def _single(rng: np.random.Generator) -> list[Form]:
    """The kernels themselves, given float32."""
    wo = cosine_hemisphere(*rng.random((2, TILE)))
    m = GGX().sample_d_cos(ALPHA, ALPHA, *rng.random((2, TILE)))
    forms = []
    for name, distribution in (("GGX", GGX()), ("Beckmann", Beckmann())):
        for what, kernel, w in (("D", distribution.density, m), ("G1", partial(_g1, distribution.smith_lambda), wo)):
            half = partial(kernel, w.astype(np.float32), np.float32(ALPHA), np.float32(ALPHA))
            forms.append(
                _form((f"{what} of {name}", "float32", "float64"), half, partial(kernel, w, ALPHA, ALPHA), TILE)
            )
    return forms
