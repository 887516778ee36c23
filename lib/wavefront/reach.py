# SPDX-License-Identifier: GPL-3.0-or-later
"""Which pixels unsupported materials can affect, and which pixels show them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..effects.facts import is_smooth
from ..sampling.streams import REACH
from ..scene.expressions import BLACK
from ..scene.materials import Closure, Emission, Material, Transparent, WeightedClosure
from ..scene.world import World
from ..textures.fold import fold_scene
from .render import ReferenceRenderer

SAMPLES = 64


def reached(reference: ReferenceRenderer, samples: int = SAMPLES) -> np.ndarray:
    """Pixels (height, width) lit if the unsupported materials were the only light sources.

    Light that such a material reflects, or lets pass from elsewhere, takes the same paths. Few samples find almost all
    such pixels, since lamps are sampled.
    """
    return _lit(reference, samples, lambda closure: not isinstance(closure, Emission))


def seen(reference: ReferenceRenderer, samples: int = SAMPLES) -> np.ndarray:
    """The pixels (height, width) that show an unsupported material.

    It may be seen through transparent faces, in mirrors or through smooth glass.
    """
    return _lit(
        reference, samples, lambda closure: isinstance(closure, Transparent) or is_smooth(closure), volumes=False
    )


def _lit(
    reference: ReferenceRenderer, samples: int, keeps: Callable[[Closure], bool], volumes: bool = True
) -> np.ndarray:
    """The pixels (height, width) that unsupported materials would light if they were lamps.

    Other materials have only the lobes that `keeps` accepts.
    """
    materials = fold_scene(reference.scene).materials
    lamps = replace(
        reference.scene,
        materials=tuple(_only_light(material, keeps, volumes) for material in materials),
        lights=(),
        world=World(BLACK, (1, 1)),
    )
    options = replace(reference.options, russian_roulette=False)
    rendering = ReferenceRenderer(lamps, options, like=reference.kernel).render(REACH.number(0), samples)
    return rendering.radiance.any(axis=2)  # what is not finite counts, too


def _only_light(material: Material, keeps: Callable[[Closure], bool], volumes: bool) -> Material:
    """A lamp in place of an unsupported material, else the material with fewer lobes.

    It has the lobes that `keeps` accepts, and its volume if `volumes` is set.
    """
    if material.unknown:
        return Material(material.name, (WeightedClosure(Emission()),))
    kept = tuple(x for x in material.lobes if keeps(x.closure))
    return replace(material, lobes=kept, volume=material.volume if volumes else None)
