# SPDX-License-Identifier: GPL-3.0-or-later
"""How far light goes from materials that are not known: the pixels that it reaches, and those that show it."""

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
    """The pixels (height, width) that a material which is not known sends any light to, were it a lamp and the only one.

    Light that it reflects, or lets pass from elsewhere, goes the same ways. Lamps are sampled, so few samples find almost all.
    """
    return _lit(reference, samples, lambda closure: not isinstance(closure, Emission))


def seen(reference: ReferenceRenderer, samples: int = SAMPLES) -> np.ndarray:
    """The pixels (height, width) that show a material which is not known: through transparent faces, mirrors and smooth glass."""
    return _lit(
        reference, samples, lambda closure: isinstance(closure, Transparent) or is_smooth(closure), volumes=False
    )


def _lit(
    reference: ReferenceRenderer, samples: int, keeps: Callable[[Closure], bool], volumes: bool = True
) -> np.ndarray:
    """The pixels (height, width) that unknown materials light, were they lamps, where others have the lobes that `keeps` says."""
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
    """A lamp where the material is not known; else the lobes of it that `keeps` says, and its volume where `volumes` are kept."""
    if material.unknown:
        return Material(material.name, (WeightedClosure(Emission()),))
    kept = tuple(x for x in material.lobes if keeps(x.closure))
    return replace(material, lobes=kept, volume=material.volume if volumes else None)
