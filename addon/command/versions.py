# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon versions`: the same scenes under several Blenders.

No Blender is loaded into this process.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from tqdm import tqdm

from ...lib.errors import Cancelled, EtalonError
from ...lib.files.atomic import replace_files
from ...lib.plain_text import folder_name, one_line
from ...lib.progress import Progress
from ...lib.settings.common import REFERENCE_SCENES, PageTerminal, Target
from ...lib.settings.comparison import CompareOptions
from ...lib.settings.versions import VersionsSettings, VersionsTarget
from ...lib.settings.words import repeating_command
from ...lib.versions.document import document, scene_figures
from ...lib.versions.page import write_versions
from ...lib.versions.programs import find_blenders
from ...lib.versions.words import WORDS
from ..cycles.second_blender import WORKER
from ..versions import SceneResult, compare_versions
from .console import Bar, Lines, Silent, bar, interruptible, open_page, paint, print_json
from .doctor import PACKAGES
from .scene_choice import describe_missing, describe_unknown


def run(target: VersionsTarget, settings: VersionsSettings, terminal: PageTerminal) -> int:
    """Compare every scene under every Blender, and write the page.

    The exit code is that of the worst change.
    """
    targets = {scene: _target(target, scene) for scene in target.scenes}
    _refuse_same_folder(target.scenes)
    begin, found = time.monotonic(), {}
    with (
        replace_files(settings.out) as beside,
        interruptible() as interrupted,
        bar("versions", terminal) as shown,
    ):
        blenders = find_blenders(target.blender, WORKER, PACKAGES, shown.begin)
        for k, (name, one) in enumerate(targets.items()):
            progress = Progress(shown.report, interrupted, shown.tell, partial(_begin, shown, name))
            part = progress.within(k / len(targets), (k + 1) / len(targets))
            try:
                found[name] = compare_versions(name, one, blenders, settings, settings.out, part)
            except Cancelled:
                found[name] = SceneResult(scene_figures(name, [], None, "it was cancelled before"), {})
            if not terminal.json:
                _tell(found[name])
        repeat = repeating_command("versions", target, settings)
        options, seconds = settings.part(CompareOptions), time.monotonic() - begin
        figures = document([one.figures for one in found.values()], blenders, options, seconds, repeat)
        write_versions(figures, {name: one.pictures for name, one in found.items()}, beside)
    page = settings.out / "versions.html"
    if terminal.json:
        print_json(figures)
    else:
        print(_painted(figures["verdict"], figures["summary"]))
        print(one_line(f"report: {page}"))
    if terminal.open:
        open_page(page)
    return figures["exit_code"]


def _target(target: VersionsTarget, scene: str) -> Target:
    """One scene with all that is set in it.

    Raises EtalonError where there is none of that name.
    """
    if scene.endswith(".blend"):
        if not Path(scene).is_file():
            raise EtalonError(describe_missing(Path(scene)))
        scene = str(Path(scene).absolute())
    elif scene not in REFERENCE_SCENES:
        raise EtalonError(describe_unknown(scene))
    return Target(scene, target.frame, target.camera, target.view_layer, target.assignments)


def _begin(shown: Bar | Lines | Silent, scene: str, stage: str) -> None:
    """Show the stage of a scene."""
    shown.begin(f"{scene}, {stage}")


def _refuse_same_folder(scenes: Sequence[str]) -> None:
    """Raise EtalonError for two scenes whose reports would lie in one folder."""
    names = [folder_name(Path(scene).stem) for scene in scenes]
    for name in names:
        if names.count(name) > 1:
            raise EtalonError(f"{name}: two scenes have this name; rename one, or compare them one after the other")


def _tell(result: SceneResult) -> None:
    """Print the result of one scene, above the progress bar."""
    figures = result.figures
    lines = [f"{figures['scene']}: {figures['sentence']}"]
    for one in figures["versions"]:
        causes = f", because of {', '.join(one['causes']['names'])}" if one["causes"] and one["causes"]["names"] else ""
        said = f"{one['verdict']}{causes}" if one["status"] == "finished" else f"{one['status']}: {one['message']}"
        lines.append(f"  {one['label']} against the reference: {said}")
    for change in figures["changes"]:
        lines.append(f"  {change['from']} to {change['to']}: {' '.join(change['sentences'])}")
    tqdm.write("\n".join(map(one_line, lines)), file=sys.stdout)
    sys.stdout.flush()


def _painted(verdict: str | None, summary: str) -> str:
    return f"{paint(WORDS[verdict], verdict)}: {one_line(summary)}" if verdict else one_line(summary)
