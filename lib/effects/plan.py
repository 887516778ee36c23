# SPDX-License-Identifier: GPL-3.0-or-later
"""The plan: which effects a scene calls for, each with the fact that decided it. The integrator asks it and runs nothing else."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from ..errors import EtalonError
from ..scene.scene import Scene
from .catalogue import EFFECTS
from .facts import Facts


@dataclass(frozen=True)
class Decision:
    """Whether one effect is needed, and the fact that says so."""

    effect: str
    needed: bool
    fact: str


@dataclass(frozen=True)
class Plan:
    """Decisions on every effect of the catalogue, in its order. A plan that `prunes` leaves out lobes that add nothing, too."""

    decisions: tuple[Decision, ...]
    prunes: ClassVar[bool] = True

    def needs(self, effect: str) -> bool:
        """Whether the effect of that name is needed."""
        for decision in self.decisions:
            if decision.effect == effect:
                return decision.needed
        raise EtalonError(f"no effect is called '{effect}'; see lib/effects/catalogue.py")

    def forcing(self, *effects: str) -> Forced:
        """The same plan with the named effects run although the scene does not call for them; all where none is named."""
        for effect in effects:
            self.needs(effect)
        return Forced(
            tuple(
                d if d.needed or (effects and d.effect not in effects) else Decision(d.effect, True, "forced")
                for d in self.decisions
            )
        )


@dataclass(frozen=True)
class Forced(Plan):
    """A plan that runs more than its scene calls for, which shows what is saved and that nothing is lost."""

    prunes: ClassVar[bool] = False


def make_plan(scene: Scene) -> Plan:
    """Ask every effect of the catalogue whether this scene calls for it."""
    facts = Facts(scene)
    return Plan(tuple(Decision(effect.name, *effect.called_for(facts)) for effect in EFFECTS))
