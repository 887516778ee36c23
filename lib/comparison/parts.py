# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of the image that are compared beside it.

They follow from what the user asks for and what the scene has.
"""

from __future__ import annotations

from ..effects.light_passes import light_passes
from ..errors import EtalonError
from ..film.light_passes import is_asked
from ..film.parts import WORLD, BounceLimit, Part
from ..settings.comparison import Settings
from ..wavefront.render import ReferenceRenderer


def asked_parts(reference: ReferenceRenderer, settings: Settings) -> tuple[Part, ...]:
    """The parts that `settings` ask for, of the scene that `reference` renders.

    They are light passes, limits of bounces and emitters. Raises EtalonError for a limit of bounces beyond the
    scene's own, and where there are too many emitters.
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
