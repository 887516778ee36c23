# SPDX-License-Identifier: GPL-3.0-or-later
"""The plan: which effects a scene needs, each with the fact that decided it.

The integrator asks the plan and runs nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from ..errors import EtalonError
from ..scene.scene import Scene
from .catalogue import EFFECTS
from .facts import Facts
from .names import Effect


@dataclass(frozen=True)
class Decision:
    """Whether one effect is needed, and the fact that says so."""

    effect: Effect
    needed: bool
    fact: str


@dataclass(frozen=True)
class Plan:
    """Decisions on every effect of the catalogue, in its order.

    A plan that `prunes` leaves out lobes that add nothing, too.
    """

    decisions: tuple[Decision, ...]
    prunes: ClassVar[bool] = True

    @cached_property
    def _answers(self) -> dict[str, bool]:
        return {decision.effect: decision.needed for decision in self.decisions}

    def needs(self, effect: Effect) -> bool:
        """Return whether the effect is needed.

        Raises EtalonError where the plan holds no decision about it.
        """
        if effect not in self._answers:
            raise EtalonError(f"no effect is called '{effect}'; see lib/effects/names.py")
        return self._answers[effect]

    def forcing(self, *effects: Effect) -> Forced:
        """Return the same plan with the named effects run although the scene does not need them.

        All effects run where none is named.
        """
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
    """A plan that runs more effects than its scene needs.

    It shows what the plan saves, and that nothing is lost.
    """

    prunes: ClassVar[bool] = False


def make_plan(scene: Scene) -> Plan:
    """Ask every effect of the catalogue whether this scene needs it.

    Constants are folded once for all effects.
    """
    facts = Facts(scene)
    return Plan(tuple(Decision(entry.effect, *entry.is_needed(facts)) for entry in EFFECTS))
