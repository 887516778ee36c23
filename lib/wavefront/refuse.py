# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene can hold and the path integrator does not simulate, by name."""

from __future__ import annotations

from ..effects.facts import Facts
from ..errors import Refusal, Refused
from ..scene.links import EVERY_SET
from ..scene.scene import Scene


def refuse_linked_faces(scene: Scene) -> None:
    """Raise Refused where a mirror or smooth glass may show emitting faces behind objects that do not hide them."""
    facts = Facts(scene)
    if not facts.smooth:
        return
    linked = [thing.name for thing in facts.shining if thing.links.blockers != EVERY_SET]
    what = f"shadow linking of its faces beside the smooth material '{facts.smooth[0]}'"
    if linked:
        raise Refused([Refusal(f"object '{name}'", what, "use a light, or remove its blockers") for name in linked])
