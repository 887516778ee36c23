# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: shading of the hits of one material, direct light by light sampling and the next direction by BSDF sampling."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..bsdfs.mixture import Mixture
from ..sampling.mis import power_heuristic
from ..vectors import dot, orthonormal_basis, to_local, to_world
from .kernel import Kernel
from .light_choice import LightChoice
from .surface import SurfacePoints


@dataclass(frozen=True)
class Shaded:
    """Results for the points of one material.

    direct (3, n): f |cos| L / pdf by light sampling with its weight, before visibility and throughput, or None. wi (3, n) the next direction in
    world space, weight (3, n) f |cos| / pdf, pdf (n,).
    """

    direct: np.ndarray | None
    wi: np.ndarray
    weight: np.ndarray
    pdf: np.ndarray


def shade_all(
    kernel: Kernel,
    points: SurfacePoints,
    groups: list[tuple[int, int, int]],
    light: LightChoice | None,
    uniforms: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> Shaded:
    """Shade points that stand in groups (material, start, stop); `uniforms` pick the lobe and the direction within it."""
    size = points.size
    frame = orthonormal_basis(points.n)
    if len(groups) == 1 and kernel.materials[groups[0][0]].scatters:
        return _shade(kernel, groups[0][0], points, frame, light, uniforms)
    direct = None if light is None else np.zeros((3, size))
    wi, weight, pdf = np.zeros((3, size)), np.zeros((3, size)), np.zeros(size)
    for material, a, b in groups:
        if kernel.materials[material].scatters:
            here = frame[0][:, a:b], frame[1][:, a:b]
            part = None if light is None else light.part(a, b)
            shaded = _shade(kernel, material, points.part(a, b), here, part, tuple(u[a:b] for u in uniforms))
            wi[:, a:b], weight[:, a:b], pdf[a:b] = shaded.wi, shaded.weight, shaded.pdf
            if direct is not None:
                direct[:, a:b] = shaded.direct
    return Shaded(direct, wi, weight, pdf)


def _shade(
    kernel: Kernel,
    material: int,
    points: SurfacePoints,
    frame: tuple[np.ndarray, np.ndarray],
    light: LightChoice | None,
    uniforms: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> Shaded:
    """Shade points of one material in the frame (t, s, n)."""
    wo = to_local(points.wo, *frame, points.n)
    mixture = kernel.materials[material].mixture(points, wo, *frame)
    direct = None
    if light is not None:
        direct = np.zeros_like(wo) if mixture.all_delta else _direct(kernel, points, frame, mixture, light)
    local, weight, pdf = mixture.sample(*uniforms)
    wi = to_world(local, *frame, points.n)
    if not kernel.tables.all_flat:  # both normals must see wi on the same side
        weight = weight * (local[2] * dot(points.ng, wi) > 0.0)
    return Shaded(direct, wi, weight, pdf)


def _direct(
    kernel: Kernel, points: SurfacePoints, frame: tuple[np.ndarray, np.ndarray], mixture: Mixture, light: LightChoice
) -> np.ndarray:
    """One light's contribution by light sampling, weighed against BSDF sampling; (3, n)."""
    sample = light.sample
    toward = to_local(sample.wi, *frame, points.n)
    value, pdf = mixture.evaluate(toward)
    density = sample.pdf * light.probability
    if kernel.options.direct == "mis":
        factor = power_heuristic(density, np.where(light.delta, 0.0, pdf))
    elif kernel.options.direct == "lights":
        factor = np.ones_like(density)
    else:
        factor = np.where(light.delta, 1.0, np.zeros_like(density))
    factor /= density
    if not kernel.tables.all_flat and not kernel.lit_from_below:
        factor *= toward[2] * dot(points.ng, sample.wi) > 0.0
    value = value * factor
    value *= sample.radiance
    return value
