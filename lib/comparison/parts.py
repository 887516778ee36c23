# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of the image that are compared beside it.

They follow from what the user asks for and what the scene has.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from ..effects.light_passes import light_passes
from ..errors import EtalonError
from ..film.light_passes import is_asked
from ..film.parts import WORLD, BounceLimit, Part
from ..film.windows import Windows
from ..sampling.streams import FIRST_CALLS
from ..settings.comparison import AUTO, ComparisonSettings
from ..wavefront.render import ReferenceRenderer
from .memory import lacking_memory

# Light passes are compared by default where they are expected to cost less than this part of Cycles' time.
MOST_COST = 0.1
# What each light pass costs Cycles, in the time that a path's mean ray takes it. Measured where paths have few rays: 0.08 in replicates of
# 8 samples, 0.06 of 16, 0.04 of 32; less where they have more (tests/benchmarks/cost_of_passes.py).
RAYS_OF_A_PASS = 0.065
# Rays are counted on a grid of so many squares of pixels, with so many samples in each pixel.
SQUARES, EDGE, SAMPLES = 8, 4, 4


class WhyNot(Enum):
    """Why `--passes auto` compares no light passes; the values stand in verdict.json."""

    COST = "cost"
    UNSUPPORTED = "unsupported materials"
    MEMORY = "memory"


@dataclass(frozen=True)
class PassChoice:
    """Which light passes are compared.

    `asked` is the value of the option, and `passes` the one that it stands for: never 'auto'. `cost` is the part of
    Cycles' time that the scene's passes are expected to add, where the choice asked for it. `why_not` is there where
    'auto' compares none.
    """

    asked: str = "none"
    passes: str = "none"
    cost: float | None = None
    why_not: WhyNot | None = None


# What is told of comparisons whose caller chose no light passes.
NO_CHOICE = PassChoice()


def choose_passes(reference: ReferenceRenderer, settings: ComparisonSettings) -> PassChoice:
    """Choose the passes that `--passes auto` stands for; other values stay.

    The scene is that which `reference` renders. 'auto' stands for all passes where they are cheap and no unsupported
    material forbids them, and for none elsewhere.
    """
    if settings.passes != AUTO:
        return PassChoice(settings.passes, settings.passes)
    if reference.kernel.is_passive:
        return PassChoice(AUTO, why_not=WhyNot.UNSUPPORTED)
    cost = RAYS_OF_A_PASS * len(light_passes(reference.scene, reference.plan)) / count_rays(reference)
    if cost >= MOST_COST:
        return PassChoice(AUTO, cost=cost, why_not=WhyNot.COST)
    return PassChoice(AUTO, "all", cost)


def count_rays(reference: ReferenceRenderer) -> float:
    """How many rays a path has in the mean, at least 1.

    It is estimated from a few paths that are spread over the image.
    """
    height, width = reference.scene.camera.height, reference.scene.camera.width
    corners = [np.unique(np.linspace(0, max(size - EDGE, 0), SQUARES).astype(int)).tolist() for size in (width, height)]
    boxes = tuple(
        (left, top, min(left + EDGE, width) - 1, min(top + EDGE, height) - 1)
        for top in corners[1]
        for left in corners[0]
    )
    found = reference.render(FIRST_CALLS.number(0), SAMPLES, windows=Windows((height, width), boxes))
    return max(found.rays / found.camera_samples, 1.0)


def fit_memory(choice: PassChoice, parts: Sequence[Part], width: int, height: int) -> PassChoice:
    """The choice, or none where 'auto' chose more passes than this machine has memory for.

    `parts` are those of an image of so many pixels that are compared by the choice.
    """
    if choice.asked != AUTO or choice.passes == "none" or not lacking_memory(width, height, len(parts)):
        return choice
    return replace(choice, passes="none", why_not=WhyNot.MEMORY)


def asked_parts(reference: ReferenceRenderer, settings: ComparisonSettings) -> tuple[Part, ...]:
    """The parts that `settings` ask for, of the scene that `reference` renders.

    They are light passes, limits of bounces and emitters. 'auto' stands for no light passes here; `choose_passes`
    says what it stands for in a comparison. Raises EtalonError for a limit of bounces beyond the scene's own, and
    where there are too many emitters.
    """
    scene = reference.scene
    parts: list[Part] = [name for name in light_passes(scene, reference.plan) if is_asked(name, settings.passes)]
    if settings.bounces is not None:
        first, last = settings.bounces
        most = scene.transport.max_bounces
        if last > most:
            raise EtalonError(
                f"--bounces {first}..{last}: the scene ends paths after {most}; give {min(first, most)}..{most}, "
                "or raise Max Bounces in Blender"
            )
        parts += map(BounceLimit, range(first, last + 1))
    if settings.lights:
        parts += reference.with_passes((WORLD,)).kernel.emitters.names
    return tuple(parts)
