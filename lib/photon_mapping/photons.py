# SPDX-License-Identifier: GPL-3.0-or-later
"""Photons: where light paths meet faces, and a tree to find those near a point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from ..light_tracing.emitters import Emitters
from ..light_tracing.select import Everything
from ..light_tracing.splats import Splats
from ..light_tracing.trace import Groups, LightPaths, LightTracer
from ..sampling.sobol import RandomSampler, RandomTile, SobolSampler, SobolTile
from ..surfaces.surface import SurfacePoints
from ..wavefront.kernel import Kernel

# Points in one net of a pass: a point set costs more, the larger it is.
DEPTH = 4096


@dataclass(frozen=True)
class Photons:
    """Light that meets faces, of one pass.

    position (3, n), metres. light (3, n): unit vectors to where it comes from. flux (3, n), W: what each adds to the power on an area. front
    (3, n): the face's normal as the mesh has it. scatterings (n,): how often the path had scattered before. rays: how many were traced.
    """

    position: np.ndarray
    light: np.ndarray
    flux: np.ndarray
    front: np.ndarray
    scatterings: np.ndarray
    rays: int
    tree: scipy.spatial.KDTree


class _PhotonTracer(LightTracer):
    """Keeps the points that light paths meet, and connects nothing to the camera."""

    def __init__(self, kernel: Kernel, emitters: Emitters, uniforms: SobolTile | RandomTile) -> None:
        super().__init__(kernel, emitters, uniforms, Everything())
        self.met: list[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]] = []

    def _connect(
        self, paths: LightPaths, points: SurfacePoints, offset: np.ndarray, groups: Groups, step: int
    ) -> Splats:
        front = points.ng * points.side
        self.met.append((points.position, points.wo, paths.weight.copy(), front, paths.scatterings))
        return Splats.none()


def trace_photons(
    kernel: Kernel, emitters: Emitters, sampler: SobolSampler | RandomSampler, number: int, count: int
) -> Photons:
    """Trace the photons of pass `number`, from `count` light paths.

    The sampler has DEPTH points in each net.
    """
    pixels = kernel.scene.camera.width * kernel.scene.camera.height
    groups = -(-count // DEPTH)
    # Numbers after the pixels', as in light tracing.
    uniforms = sampler.tile(pixels + number * groups + np.arange(groups))
    tracer = _PhotonTracer(kernel, emitters, uniforms)
    group, sample = np.divmod(np.arange(count), DEPTH)
    tracer.trace(group, sample)
    position, light, weight, front, scatterings = (
        np.concatenate(arrays, axis=-1) for arrays in zip(*tracer.met, strict=True)
    )
    tree = scipy.spatial.KDTree(position.T, balanced_tree=False, compact_nodes=False)
    return Photons(position, light, weight / count, front, scatterings, tracer.rays, tree)
