# SPDX-License-Identifier: GPL-3.0-or-later
"""A scouting pass, which estimates how much light arrives by caustics.

Paths from the camera can hardly find them.

A caustic path leaves an emitter, is scattered by one or more narrow lobes, then by a wide one, and from there by any
lobes on to the camera: L S+ D (D|S)* E in Heckbert's notation (1990), where S has alpha below `narrow`. Camera paths
find it only if a direction that the wide lobe samples happens to lead through the narrow ones to the emitter. Counted
by their lobes, these paths are a part of all paths, so that the pass estimates a part of the image, without bias.
What it does not see, and leaves out:

- constant worlds, which a camera path finds wherever it leaves the scene;
- caustics that the camera sees only in mirrors or through smooth glass: a Dirac lobe last;
- dispersion, light within the sphere of a sphere light, and unsupported materials.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from time import perf_counter

import numpy as np

from ..errors import EtalonError
from ..lights.light import Ball, bounding_ball
from ..progress import NO_PROGRESS, Progress
from ..sampling.streams import SCOUTING
from ..scene.camera import PANORAMAS
from ..scene.expressions import Constant
from ..scene.materials import WIDE, GlossyToon, Material
from ..surfaces.materials import PreparedMaterial
from ..surfaces.surface import SurfacePoints
from ..vectors import dot
from ..wavefront.kernel import Kernel
from .emitters import gather_emitters
from .render import group_depth, trace_light
from .splats import Splats

# Lobes narrower than this count as narrow: alpha, a roughness of 0.32 in Blender.
NARROW = 0.1
# How many objects are aimed at one by one; more are aimed at together.
MOST_TARGETS = 16
# Emitted rays in a tile; most of them miss the targets and cost little.
TILE_RAYS = 131072
STRAIGHT, FOCUSED, CAUSTIC = 0, 1, 2


@dataclass(frozen=True)
class Scouted:
    """What a scouting pass found.

    shape: (height, width). pixel (n,): flat index of each contribution, row by row from the top; batch (n,): which of the uncorrelated
    `batches` it belongs to; value (3, n): what it adds to the mean radiance of the batch in its pixel, W m^-2 sr^-1. brightness (n,):
    luminance of the radiance of its emitter, W m^-2 sr^-1, inf for lights without size: what one sample of a camera path that finds it is
    worth, but for the lobes' weights, which are at most about 1. paths: emitted rays in each batch. seconds: of the pass. bare (height,
    width): pixels that are known to show the world alone; None where that was not asked.
    """

    shape: tuple[int, int]
    batches: int
    pixel: np.ndarray
    batch: np.ndarray
    value: np.ndarray
    brightness: np.ndarray
    paths: int
    seconds: float
    bare: np.ndarray | None = None

    @cached_property
    def image(self) -> np.ndarray:
        """Mean radiance by caustics, (height, width, 3)."""
        labels = np.arange(self.shape[0] * self.shape[1]).reshape(self.shape)
        return self.replicates(labels).mean(axis=0).reshape(*self.shape, 3)

    def replicates(self, labels: np.ndarray) -> np.ndarray:
        """Mean radiance of regions in each batch, (batches, regions, 3).

        `labels` (height, width) int: the region of each pixel, from 0; pixels below 0 belong to none.
        """
        count = int(labels.max(initial=-1)) + 1
        flat = labels.ravel()
        label = flat[self.pixel]
        inside = label >= 0
        key = self.batch[inside] * count + label[inside]
        size = np.bincount(flat[flat >= 0], minlength=count)
        sums = [np.bincount(key, row[inside], self.batches * count) for row in self.value]
        return np.stack(sums, axis=-1).reshape(self.batches, count, 3) / np.maximum(size, 1)[:, None]

    def regions(self, labels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the mean radiance by caustics in each region, and its standard error.

        They are (regions, 3) each; `labels` as in `replicates`.
        """
        values = self.replicates(labels)
        return values.mean(axis=0), values.std(axis=0, ddof=1) / np.sqrt(self.batches)

    def brightest(self, labels: np.ndarray) -> np.ndarray:
        """Return the largest `brightness` of what arrived in each region, (regions,).

        It is 0 where nothing arrived; `labels` as in `replicates`.
        """
        label = labels.ravel()[self.pixel]
        inside = label >= 0
        found = np.zeros(int(labels.max(initial=-1)) + 1)
        np.maximum.at(found, label[inside], self.brightness[inside])
        return found


def scout_caustics(
    kernel: Kernel,
    paths: int = 1 << 18,
    batches: int = 16,
    narrow: float = NARROW,
    progress: Progress = NO_PROGRESS,
) -> Scouted:
    """Estimate the light by caustics.

    Traces at least `paths` rays from the lights in `batches` batches, which are uncorrelated.

    `kernel` is that of the reference renderer of the scene; lobes with alpha below `narrow` are narrow. Nothing is
    traced where no material is narrow, none is wide, or no light shines. Raises EtalonError for panoramic cameras,
    and Cancelled.
    """
    begin = perf_counter()
    camera = kernel.scene.camera
    if camera.kind in PANORAMAS:
        raise EtalonError("a panoramic camera cannot be scouted for caustics; use a perspective or orthographic one")
    targets, depth = _targets(kernel, narrow), group_depth(paths)
    groups = -(-paths // (batches * depth))
    each = groups * depth
    found = Splats.none()
    if targets and kernel.scene.transport.max_bounces > 0:
        emitters = gather_emitters(kernel, _around(targets, kernel), False, targets)
        selection, number = _Caustics(targets, narrow), SCOUTING.number(0)
        traced = trace_light(kernel, emitters, selection, number, batches * each, progress, TILE_RAYS, depth)
        found = Splats.joined([splats for splats, _ in traced])
    return Scouted(
        (camera.height, camera.width),
        batches,
        found.pixel,
        found.group // groups,
        found.value / each,
        found.brightness,
        each,
        perf_counter() - begin,
    )


class _Caustics:
    """The selection of paths that scatter by narrow lobes first, then by a wide one."""

    def __init__(self, targets: list[Ball], narrow: float) -> None:
        self._targets, self._narrow = targets, narrow

    def starts(self, origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """Rays that pass a target."""
        return np.any([_passes(ball, origin, direction) for ball in self._targets], axis=0)

    def allowed(self, material: PreparedMaterial, points: SurfacePoints, history: np.ndarray) -> np.ndarray:
        """Narrow lobes at first, then all."""
        return (material.alphas(points) < self._narrow) | (history != STRAIGHT)

    def connected(self, material: PreparedMaterial, points: SurfacePoints, history: np.ndarray) -> np.ndarray:
        """Wide lobes after narrow ones, all lobes after that."""
        wide = material.alphas(points) >= self._narrow
        return (wide & (history == FOCUSED)) | (history == CAUSTIC)

    def remember(
        self, material: PreparedMaterial, points: SurfacePoints, history: np.ndarray, lobe: np.ndarray
    ) -> np.ndarray:
        """Whether the path is still among narrow lobes."""
        narrow = np.take_along_axis(material.alphas(points), lobe[None], axis=0)[0] < self._narrow
        return np.where(narrow & (history != CAUSTIC), FOCUSED, CAUSTIC)


def _passes(ball: Ball, origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Whether rays meet a ball, (n,)."""
    offset = ball.center - origin
    along, square = dot(offset, direction), dot(offset, offset)
    apart = offset - along * direction
    return (dot(apart, apart) <= ball.radius**2) & ((along >= 0.0) | (square <= ball.radius**2))


def _targets(kernel: Kernel, narrow: float) -> list[Ball]:
    """Balls that hold all faces with a narrow lobe; none where no material has a wide one."""
    scene = kernel.scene
    if not any(_may_have(material, narrow, wide=True) for material in scene.materials):
        return []
    is_narrow = np.array([_may_have(material, narrow, wide=False) for material in scene.materials])
    triangles = np.flatnonzero(is_narrow[scene.mesh.material_index])
    owner = scene.mesh.object_index[triangles]
    owners = np.unique(owner)
    groups = [triangles] if owners.size > MOST_TARGETS else [triangles[owner == k] for k in owners]
    return [bounding_ball(scene.mesh.vertices[:, scene.mesh.triangles[:, group].ravel()]) for group in groups]


def _around(targets: list[Ball], kernel: Kernel) -> Ball:
    """One ball about all targets; rays from afar begin outside the scene."""
    low = np.min([ball.center - ball.radius for ball in targets], axis=0)
    high = np.max([ball.center + ball.radius for ball in targets], axis=0)
    center = 0.5 * (low + high)
    radius = max(float(np.linalg.norm(ball.center - center)) + ball.radius for ball in targets)
    scene = bounding_ball(kernel.scene.mesh.vertices)
    return Ball(center, radius, float(np.linalg.norm(scene.center - center)) + scene.radius)


def _may_have(material: Material, narrow: float, wide: bool) -> bool:
    """Whether a material may have a wide lobe, or a narrow one."""
    for lobe in material.lobes:
        if isinstance(lobe.closure, WIDE):
            if wide or isinstance(lobe.closure, GlossyToon):
                return True
        elif (roughness := getattr(lobe.closure, "roughness", None)) is not None:
            known = isinstance(roughness, Constant)
            if not known or (roughness.number**2 >= narrow) == wide:
                return True
    return False
