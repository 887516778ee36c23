# SPDX-License-Identifier: GPL-3.0-or-later
"""The ways to render a scene that are measured side by side.

Each has what is known of its error beforehand.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from time import perf_counter
from typing import Any

from ..comparison.compare import Renderer
from ..scene.scene import Scene
from ..settings.reference import Options
from ..wavefront.render import ReferenceRenderer


class Bias(Enum):
    """What more samples do to an error.

    They bring it to nothing, to a floor, or only measuring tells.
    """

    NONE = "none"
    FLOOR = "floor"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class Way:
    """One way to render the scene.

    `key` is its short name, `label` what people read, `group` 'sampling', 'model', 'estimators' or 'Cycles'; `make` builds its
    renderer. `rate` is the
    power of 1/N by which its variance falls if theory gives it (1 for independent samples), else None. `opening` are the seconds
    that were spent before `make` could be called: reading the file, exporting the scene.
    """

    key: str
    label: str
    group: str
    make: Callable[[], Renderer]
    bias: Bias
    rate: float | None = None
    opening: float = 0.0


# Key, label, group, what differs from visible normals with multiple importance sampling and Sobol' points.
_REFERENCE: tuple[tuple[str, str, str, dict[str, Any]], ...] = (
    ("mis", "visible normals, MIS", "sampling", {}),
    ("bounded-mis", "bounded visible normals, MIS", "sampling", {"strategy": "bounded"}),
    ("d-cos-mis", "D cos, MIS", "sampling", {"strategy": "d_cos"}),
    ("random-mis", "visible normals, MIS, plain random", "sampling", {"sampler": "random"}),
    ("lights", "light sampling alone", "sampling", {"direct": "lights"}),
    ("bsdf", "BSDF sampling alone, visible normals", "sampling", {"direct": "bsdf"}),
    ("bounded", "BSDF sampling alone, bounded visible normals", "sampling", {"direct": "bsdf", "strategy": "bounded"}),
    ("d-cos", "BSDF sampling alone, D cos", "sampling", {"direct": "bsdf", "strategy": "d_cos"}),
    ("cosine", "BSDF sampling alone, cosine", "sampling", {"direct": "bsdf", "strategy": "cosine"}),
    ("uniform", "BSDF sampling alone, uniform hemisphere", "sampling", {"direct": "bsdf", "strategy": "uniform"}),
    ("separable", "separable masking", "model", {"masking": "separable"}),
    ("torrance-sparrow", "Torrance-Sparrow masking", "model", {"masking": "torrance_sparrow"}),
)
BEST = "mis"
"""The way whose long render is the truth that the others are measured against: unbiased, and the least noisy."""


def reference_ways(scene: Scene, seed: int, threads: int, opening: float) -> list[Way]:
    """The ways of the reference integrator.

    They are each strategy of sampling, plain random numbers, and the other masking forms. The masking of the model is
    Cycles' (height-correlated), so the other forms end in a floor: the difference of the models. All share one
    acceleration structure, whose building counts as part of each one's opening.
    """
    start = perf_counter()
    base = ReferenceRenderer(scene, Options(seed=seed, threads=threads))
    opening += perf_counter() - start
    ways = []
    for key, label, group, changes in _REFERENCE:
        options = Options(seed=seed, threads=threads, **changes)

        def make(options: Options = options) -> ReferenceRenderer:
            return base.under(options)

        bias = Bias.FLOOR if group == "model" else Bias.NONE
        ways.append(Way(key, label, group, make, bias, 1.0 if options.sampler == "random" else None, opening))
    return ways
