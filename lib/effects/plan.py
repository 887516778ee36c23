# SPDX-License-Identifier: GPL-3.0-or-later
"""The plan: which effects a scene calls for, each with the fact that decided it. The integrator asks it and runs nothing else."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import EtalonError
from ..scene.scene import Scene
from .catalogue import EFFECTS


@dataclass(frozen=True)
class Decision:
    """Whether one effect is needed, and the fact that says so."""

    effect: str
    needed: bool
    fact: str


@dataclass(frozen=True)
class Plan:
    """Decisions on every effect of the catalogue, in its order."""

    decisions: tuple[Decision, ...]

    def needs(self, effect: str) -> bool:
        """Whether the effect of that name is needed."""
        for decision in self.decisions:
            if decision.effect == effect:
                return decision.needed
        raise EtalonError(f"no effect is called '{effect}'; see lib/effects/catalogue.py")


def make_plan(scene: Scene) -> Plan:
    """Ask every effect of the catalogue whether this scene calls for it."""
    return Plan(tuple(Decision(effect.name, *effect.called_for(scene)) for effect in EFFECTS))
