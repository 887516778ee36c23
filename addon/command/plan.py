# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon plan`: the effects that a scene needs, and why."""

from __future__ import annotations

import json
from dataclasses import asdict

from ...lib.effects.plan import Plan, make_plan
from ...lib.plain_text import one_line
from ...lib.scene import archive
from ...lib.scene.scene import Scene
from ...lib.settings.commands import PlanOutput
from ...lib.settings.common import Target
from .exported import read_scene


def run(target: Target, settings: PlanOutput) -> int:
    """Print which effects the scene needs, each with the fact that decided it."""
    scene = read_scene(target)
    plan = make_plan(scene)
    if settings.save is not None:
        archive.save(scene, settings.save)
    if settings.json:
        print(json.dumps({"scene": scene.name, **asdict(plan)}, indent=2))
    else:
        print(plan_text(scene, plan))
    return 0


def plan_text(scene: Scene, plan: Plan) -> str:
    """The plan as two lists for a terminal."""
    width = max(len(decision.effect) for decision in plan.decisions)
    lines = [f"{scene.name}: {scene.mesh.triangle_count} triangles, {len(scene.lights)} lights"]
    for heading, needed in (("needed", True), ("not needed", False)):
        lines += ["", heading]
        lines += [f"  {d.effect:{width}}  {d.fact}" for d in plan.decisions if d.needed is needed]
    return "\n".join(map(one_line, lines))
