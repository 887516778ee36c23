# SPDX-License-Identifier: GPL-3.0-or-later
"""What an unsupported material may do to an image.

These are the pixels that show it, and the light that it may bring to the others. The reference takes the material for
black, so it shows the least light that there can be: whatever the material does, it adds. How much it adds at most is
estimated with stand-ins that waste no light: one that reflects all of it diffusely, one that lets all of it through
diffusely, and one that lets all of it pass straight. A mirror or a lens may focus light on a small place, where it is
brighter than with any of them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import stdtrit

from ..errors import EtalonError
from ..film.regions import RegionMoments
from ..progress import Progress
from ..relative import difference_scale
from ..sampling.streams import STAND_INS
from ..scene.expressions import WHITE
from ..scene.materials import Closure, Diffuse, Material, Translucent, Transparent, WeightedClosure
from ..scene.scene import Scene
from ..wavefront.reach import reached, seen
from ..wavefront.render import ReferenceRenderer
from .run import TimedRun

CLOSURES = (Diffuse(WHITE), Translucent(WHITE), Transparent(WHITE))
# Pairs of images for each stand-in, the samples of a pixel in each, at most, and what they may take of the time.
PAIRS, MOST_SAMPLES, SHARE = 8, 16, 0.1
# How often what a stand-in brings to a region is more than estimated.
UNDERESTIMATED = 0.005


@dataclass(frozen=True, eq=False)
class UnsupportedLight:
    """The light of unsupported materials in an image (height, width).

    `left_out` are the pixels that show an unsupported material, `reached` those that its light reaches. `differences`
    are images (height, width, 3) for each stand-in: what it adds to the image with a black one, W m^-2 sr^-1.
    """

    left_out: np.ndarray
    reached: np.ndarray
    differences: tuple[tuple[np.ndarray, ...], ...]

    def is_in(self, side: RegionMoments) -> np.ndarray:
        """The regions (K,) with pixels left that its light reaches."""
        return side.regions.weights @ (self.reached & ~side.excluded).ravel().astype(float) > 0.0

    def room(self, side: RegionMoments, floor: np.ndarray | float) -> np.ndarray:
        """The relative difference (K,) that this light may make in each region.

        It is that of the channel where it is largest. It is the upper end of Student's interval for the stand-in that
        adds most; infinite where a pixel has no finite value.
        """
        quantile = -float(stdtrit(PAIRS - 1, UNDERESTIMATED))
        most = np.zeros(side.moments.mean.shape)
        for images in self.differences:
            means = np.stack([side.means(image) for image in images])
            end = means.mean(axis=0) + quantile * means.std(axis=0, ddof=1) / np.sqrt(PAIRS)
            most = np.maximum(most, np.nan_to_num(end, nan=np.inf, posinf=np.inf))
        scale = difference_scale(side.moments.mean, floor)
        nothing = np.where(most > 0.0, np.inf, 0.0)
        return np.divide(most, scale, out=nothing, where=scale > 0.0).max(axis=1)


def room_beside(
    light: UnsupportedLight | None, side: RegionMoments, floor: np.ndarray
) -> tuple[np.ndarray | float, np.ndarray | bool]:
    """The relative difference (K,) that unsupported materials may make.

    Also the regions (K,) that their light reaches.
    """
    return (0.0, False) if light is None else (light.room(side, floor), light.is_in(side))


def find_unsupported_light(reference: ReferenceRenderer, run: TimedRun) -> UnsupportedLight | None:
    """Estimate what the unsupported materials of the reference's scene may do.

    None where one of them may emit, which has no bound. Raises Cancelled.
    """
    if not reference.kernel.is_passive:
        return None
    progress = Progress(is_cancelled=lambda: run.progress.is_cancelled)
    renderers = [reference, *(_stand_in(reference, closure) for closure in CLOSURES)]
    samples, number, begin = MOST_SAMPLES, 0, run.elapsed
    if run.budget is not None:
        for renderer in renderers:  # how long one sample of all takes
            renderer.render(STAND_INS.number(0), 1, progress)
        number, seconds = 1, max(run.elapsed - begin, 1e-9)
        samples = int(min(max(SHARE * run.budget / (PAIRS * seconds), 1), MOST_SAMPLES))
    differences: tuple[list[np.ndarray], ...] = tuple([] for _ in CLOSURES)
    for k in range(number, number + PAIRS):
        black, *others = (renderer.render(STAND_INS.number(k), samples, progress).radiance for renderer in renderers)
        for kept, image in zip(differences, others, strict=True):
            kept.append((image - black).astype(np.float32))
    return UnsupportedLight(seen(reference), reached(reference), tuple(map(tuple, differences)))


def require_pixels(scene: Scene, left_out: np.ndarray) -> np.ndarray:
    """`left_out` (height, width), if it leaves anything to compare; raises EtalonError otherwise."""
    if left_out.all():
        raise EtalonError(
            f"{scene.name}: light from materials that are not simulated reaches every pixel; simplify them, or lower the bounces"
        )
    return left_out


def _stand_in(reference: ReferenceRenderer, closure: Closure) -> ReferenceRenderer:
    """The reference of the scene in which unsupported materials are one closure."""
    lobes = (WeightedClosure(closure),)
    scene: Scene = reference.scene
    materials = tuple(Material(one.name, lobes) if one.unknown else one for one in scene.materials)
    return ReferenceRenderer(replace(scene, materials=materials), reference.options, like=reference.kernel)
