# SPDX-License-Identifier: GPL-3.0-or-later
"""How far light goes from materials that are not known: the pixels that nothing can be said of."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..sampling.streams import REACH
from ..scene.expressions import BLACK
from ..scene.materials import Emission, Material, WeightedClosure
from ..scene.world import World
from .render import ReferenceRenderer

SAMPLES = 64


def reached(reference: ReferenceRenderer, samples: int = SAMPLES) -> np.ndarray:
    """The pixels (height, width) that a material which is not known sends any light to, were it a lamp and the only one.

    Light that it reflects, or lets pass from elsewhere, goes the same ways. Lamps are sampled, so few samples find almost all.
    """
    lamps = replace(
        reference.scene,
        materials=tuple(map(_only_light, reference.scene.materials)),
        lights=(),
        world=World(BLACK, (1, 1)),
    )
    options = replace(reference.options, russian_roulette=False)
    rendering = ReferenceRenderer(lamps, options, like=reference.kernel).render(REACH.number(0), samples)
    return rendering.radiance.any(axis=2)  # what is not finite counts, too


def _only_light(material: Material) -> Material:
    """A lamp where the material is not known; else what it is, but dark."""
    if material.unknown:
        return Material(material.name, (WeightedClosure(Emission()),))
    return replace(material, lobes=tuple(x for x in material.lobes if not isinstance(x.closure, Emission)))
