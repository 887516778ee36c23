# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon plan`: the effects that a scene needs, and why.

Of a folder, it says which of its files can be compared.
"""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from ...lib.comparison.memory import describe_memory, needed_memory
from ...lib.effects.plan import Plan, make_plan
from ...lib.errors import EtalonError, Refused
from ...lib.exit_codes import ExitCode
from ...lib.files.atomic import replace_file
from ...lib.plain_text import one_line
from ...lib.plural import plural
from ...lib.progress import Progress
from ...lib.report.scene_check import scene_check_lines
from ...lib.scene import archive
from ...lib.scene.scene import Scene
from ...lib.scene_check.check import check_scene
from ...lib.settings.commands import PlanOutput
from ...lib.settings.common import Target, Terminal
from ...lib.settings.words import write_changes
from .console import bar, interruptible, print_json
from .exported import read_scene
from .survey import as_csv, as_json, as_text, find_files, survey


def run(target: Target, settings: PlanOutput, terminal: Terminal) -> int:
    """Print which effects the scene needs, each with the fact that decided it."""
    if target.scene is not None and Path(target.scene).is_dir():
        return _run_folder(Path(target.scene), target, settings, terminal)
    if settings.csv is not None:
        raise EtalonError(f"{settings.csv}: --csv makes a table of many files; give a folder in place of a scene")
    try:
        scene = read_scene(target)
    except Refused as refused:
        if not terminal.json:
            raise
        print_json({"refusals": [asdict(refusal) for refusal in refused.refusals], **_facts(target)})
        return ExitCode.BAD_INPUT
    plan = make_plan(scene)
    if settings.save is not None:
        archive.save(scene, settings.save)
    if terminal.json:
        counts = {"triangles": scene.mesh.triangle_count, "lights": len(scene.lights)}
        findings = [asdict(finding) for finding in check_scene(scene)]
        memory = {"bytes_at_full_size": needed_memory(scene.camera.width, scene.camera.height)}
        facts = counts | memory | _facts(target)
        print_json({"scene": scene.name, **facts, **asdict(plan), "scene_check": findings})
    else:
        print(plan_text(scene, plan))
    return 0


def _facts(target: Target) -> dict[str, Any]:
    """Facts that only the open file has.

    They are its frames, cameras, view layers, and the files that it refers to.
    """
    if target.is_archive:
        return {}
    from .facts import read_facts

    return read_facts()


def _run_folder(folder: Path, target: Target, settings: PlanOutput, terminal: Terminal) -> int:
    """Print which of the folder's files can be compared, and what stops the others.

    Ctrl-C, or an order to end, leaves the table of those that were read.
    """
    if settings.save is not None:
        raise EtalonError(f"{settings.save}: --save keeps one scene; give a file in place of the folder {folder}")
    found = find_files(folder)
    with interruptible() as interrupted, bar(folder.name, terminal) as shown:
        progress = Progress(shown.report, interrupted)
        files = list(survey(found, folder, write_changes(replace(target, scene=None)), progress))
    if settings.csv is not None:
        with replace_file(settings.csv) as beside:
            beside.write_text(as_csv(files), encoding="utf-8")
    print(as_json(folder, files, len(found)) if terminal.json else as_text(files, len(found)))
    return ExitCode.DONE if len(files) == len(found) else ExitCode.INTERRUPTED


def plan_text(scene: Scene, plan: Plan) -> str:
    """The plan as two lists for a terminal."""
    width = max(len(decision.effect) for decision in plan.decisions)
    lines = [f"{scene.name}: {plural(scene.mesh.triangle_count, 'triangle')}, {plural(len(scene.lights), 'light')}"]
    lines.append(describe_memory(scene.camera.width, scene.camera.height))
    for heading, needed in (("needed", True), ("not needed", False)):
        lines += ["", heading]
        lines += [f"  {d.effect:{width}}  {d.fact}" for d in plan.decisions if d.needed is needed]
    found = scene_check_lines(check_scene(scene))
    return "\n".join(map(one_line, [*lines, "", *found] if found else lines))
