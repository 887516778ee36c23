# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: shading of the hits of one material.

Direct light by light sampling, and the next direction by BSDF sampling.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..bsdfs.classed import ClassedMixture
from ..bsdfs.mixture import Mixture
from ..bsdfs.split import Split
from ..surfaces.surface import SurfacePoints
from ..vectors import dot, orthonormal_basis, to_local, to_world
from .kernel import Kernel
from .light_choice import LightChoice, LightSampling, weigh_light

Frame = tuple[np.ndarray, np.ndarray, np.ndarray]
"""The axes t, s and n, (3, n) each."""


@dataclass(frozen=True)
class Shaded:
    """Results for the points of one material.

    direct (3, n): f |cos| L / pdf by light sampling with its weight, before visibility and throughput, or None. wi (3, n) the next direction in
    world space, weight (3, n) f |cos| / pdf, pdf (n,); None where no path goes on. ray_class (n,) is the class of the next ray, None
    where all that is scattered is of one class (sight.py). direct_shares, shares (families - 1, 3, n): what each family of lobes has of
    `direct` and of `weight`, as `Split` says it, where that is asked for.
    """

    direct: np.ndarray | None
    wi: np.ndarray | None = None
    weight: np.ndarray | None = None
    pdf: np.ndarray | None = None
    ray_class: np.ndarray | None = None
    direct_shares: np.ndarray | None = None
    shares: np.ndarray | None = None

    @property
    def onward(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """wi, weight and pdf; raises ValueError where no path goes on."""
        if self.wi is None or self.weight is None or self.pdf is None:
            raise ValueError("no path goes on from here")
        return self.wi, self.weight, self.pdf


def shade_all(
    kernel: Kernel,
    sampling: LightSampling,
    points: SurfacePoints,
    groups: list[tuple[int, int, int]],
    light: LightChoice | None,
    uniforms: tuple[np.ndarray, np.ndarray, np.ndarray] | None,
    parts: bool = False,
) -> Shaded:
    """Shade points that stand in groups (material, start, stop).

    `uniforms` pick the lobe and the direction within it; None where no path goes on. `parts` asks for the shares of the families.
    """
    size = points.size
    frame = (*orthonormal_basis(points.n), points.n)
    if len(groups) == 1 and kernel.materials[groups[0][0]].scatters:
        return _shade(kernel, sampling, groups[0][0], points, frame, light, uniforms, parts)
    made = np.empty if all(kernel.materials[material].scatters for material, _, _ in groups) else np.zeros
    direct = None if light is None else made((3, size))
    onward = None if uniforms is None else (made((3, size)), made((3, size)), made(size))
    ray_class = np.zeros(size, np.intp) if uniforms is not None and kernel.sight.splits else None
    kept = (len(kernel.families) - 1, 3, size)
    direct_shares = np.zeros(kept) if parts and light is not None else None
    shares = np.zeros(kept) if parts and uniforms is not None else None
    for material, a, b in groups:
        if kernel.materials[material].scatters:
            here = frame[0][:, a:b], frame[1][:, a:b], frame[2][:, a:b]
            part = None if light is None else light.part(a, b)
            picks = None if uniforms is None else (uniforms[0][a:b], uniforms[1][a:b], uniforms[2][a:b])
            shaded = _shade(kernel, sampling, material, points.part(a, b), here, part, picks, parts)
            if direct is not None:
                direct[:, a:b] = shaded.direct
            for whole, one in ((direct_shares, shaded.direct_shares), (shares, shaded.shares)):
                if whole is not None and one is not None:
                    whole[:, :, a:b] = one
            if onward is not None:
                for whole, one in zip(onward, shaded.onward, strict=True):
                    whole[..., a:b] = one
            if ray_class is not None and shaded.ray_class is not None:
                ray_class[a:b] = shaded.ray_class
    wi, weight, pdf = onward or (None, None, None)
    return Shaded(direct, wi, weight, pdf, ray_class, direct_shares, shares)


def _shade(
    kernel: Kernel,
    sampling: LightSampling,
    material: int,
    points: SurfacePoints,
    frame: Frame,
    light: LightChoice | None,
    uniforms: tuple[np.ndarray, np.ndarray, np.ndarray] | None,
    parts: bool,
) -> Shaded:
    """Shade points of one material in the frame (t, s, n)."""
    departing = kernel.materials[material].departing_normal(points)
    if departing is not None:
        frame = *orthonormal_basis(departing), departing
    wo = to_local(points.wo, *frame)
    mixture = kernel.materials[material].mixture(points, wo, *frame)
    if kernel.sight.class_of is not None and kernel.sight.splits:
        mixture = ClassedMixture(mixture, kernel.sight.class_of)
    direct = direct_shares = ray_class = None
    if light is not None:
        direct, direct_shares = np.zeros_like(wo), None
        if not mixture.all_delta:
            split = kernel.split(material, points.size) if parts else None
            direct, direct_shares = _direct(kernel, sampling, points, frame, mixture, light, split)
    if uniforms is None:
        return Shaded(direct, direct_shares=direct_shares)
    split = kernel.split(material, points.size) if parts else None
    if isinstance(mixture, ClassedMixture):
        local, weight, pdf, ray_class = mixture.sample_classes(*uniforms, split)
    else:
        local, weight, pdf = mixture.sample(*uniforms, split)
    shares = None if split is None else split.shares(weight)
    wi = to_world(local, *frame)
    if not kernel.tables.all_flat and not sampling.below_faces:  # both normals must see wi on the same side
        weight = weight * (local[2] * dot(points.ng, wi) > 0.0)
    return Shaded(direct, wi, weight, pdf, ray_class, direct_shares, shares)


def _direct(
    kernel: Kernel,
    sampling: LightSampling,
    points: SurfacePoints,
    frame: Frame,
    mixture: Mixture,
    light: LightChoice,
    split: Split | None,
) -> tuple[np.ndarray, np.ndarray | None]:
    """The contribution (3, n) of one light by light sampling, weighed against BSDF sampling.

    Also the shares that the families of lobes have in it.
    """
    sample, sight = light.sample, kernel.sight
    toward = to_local(sample.wi, *frame)
    below = toward[2] * dot(points.ng, sample.wi) < 0.0 if sampling.below_faces else None
    if isinstance(mixture, ClassedMixture):
        value = np.zeros_like(toward)
        for ray_class, pdf, of_lobes in mixture.evaluate_classes(toward):
            weight = weigh_light(sampling, light, pdf, below) * sight.sees[ray_class, light.number]
            for k, part in of_lobes:
                value += part * weight
                if split is not None:
                    split.add(k, mixture.lobes[k], toward, part * weight)
        shares = None if split is None else split.shares(value)
    else:
        value, pdf = mixture.evaluate(toward, split)
        shares = None if split is None else split.shares(value)
        value = value * weigh_light(sampling, light, pdf, below)
        if sight.class_of is not None and not sight.sees[1].all():
            value *= sight.sees[1, light.number]
    if not kernel.tables.all_flat and not sampling.below_faces:
        value *= toward[2] * dot(points.ng, sample.wi) > 0.0
    value *= sample.radiance
    return value, shares
