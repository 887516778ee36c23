# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the time goes: the stages of the integrator by their own clocks.

The effects of the scene that run in each are named too.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..effects.catalogue import EFFECTS
from ..effects.plan import Plan
from .measure import Measured


@dataclass(frozen=True)
class StageTime:
    """One stage and its time.

    It has its `share` of the threads' time, `nanoseconds` of a thread per camera sample, and the effects that run in
    it.
    """

    name: str
    share: float
    nanoseconds: float
    effects: tuple[str, ...]


def stages(measured: Measured, plan: Plan | None = None) -> list[StageTime]:
    """The stages of a way's last point, longest first; none where its renderer has no clocks."""
    total = sum(measured.stages.values())
    if total <= 0.0 or not measured.camera_samples:
        return []
    stage_of = {entry.effect: entry.stage for entry in EFFECTS}
    needed = [d.effect for d in plan.decisions if d.needed] if plan is not None else []
    found = []
    for name, seconds in sorted(measured.stages.items(), key=lambda item: -item[1]):
        effects = tuple(effect for effect in needed if stage_of.get(effect) == name)
        found.append(StageTime(name, seconds / total, 1e9 * seconds / measured.camera_samples, effects))
    return found
