# SPDX-License-Identifier: GPL-3.0-or-later
"""One scene under several Blenders, each a process of its own; nothing here imports bpy."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from ..lib.batch.comparer import Comparer
from ..lib.batch.comparison import Limits, run_comparison
from ..lib.errors import Cancelled, EtalonError, Refused
from ..lib.files.ownership import temporary_folder
from ..lib.plain_text import folder_name
from ..lib.progress import Progress
from ..lib.settings.common import Target
from ..lib.settings.comparison import ComparisonSettings
from ..lib.settings.words import write_changes
from ..lib.versions.document import scene_figures, version_figures
from ..lib.versions.measure import Opened, measure
from ..lib.versions.page import pictures_of
from ..lib.versions.programs import Blender
from .cycles.second_blender import AnotherBlender

# What comparisons with the reference take of a scene's time; the rest is for comparing the versions with each other.
REFERENCE_SHARE = 0.5


@dataclass(frozen=True)
class SceneResult:
    """The result of one scene: its figures, and its pictures for the page."""

    figures: dict[str, Any]
    pictures: dict[str, str]


def compare_versions(
    name: str, target: Target, blenders: Sequence[Blender], settings: ComparisonSettings, out: Path, progress: Progress
) -> SceneResult:
    """Compare a scene with the reference in each Blender, and the Blenders with each other.

    `name` is the scene's name, and reports go below `out`. The figures say what keeps a version from being compared.
    Raises Cancelled where the user ended it.
    """
    folder = out / folder_name(Path(name).stem)
    share = REFERENCE_SHARE * settings.time / len(blenders)
    versions = []
    for k, blender in enumerate(blenders):
        progress.check()
        progress.begin(f"{blender.label} against the reference")
        limits = Limits(is_ending=lambda: progress.is_cancelled)
        versions.append(_against_reference(target, blender, replace(settings, time=share), folder, out, limits))
        progress.report(REFERENCE_SHARE * (k + 1) / len(blenders))
    progress.check()
    usable = [one for one, told in zip(blenders, versions, strict=True) if told["status"] == "finished"]
    if len(usable) < 2:
        error = "fewer than two versions can render it"
        return SceneResult(scene_figures(name, versions, None, error), {})
    try:
        with _opened(target, usable, settings) as opened:
            own = replace(settings, time=(1 - REFERENCE_SHARE) * settings.time)
            measured = measure(name, opened, own, progress.within(REFERENCE_SHARE, 1.0))
    except Cancelled:
        raise
    except EtalonError as error:
        return SceneResult(scene_figures(name, versions, None, str(error)), {})
    return SceneResult(scene_figures(name, versions, measured, ""), pictures_of(measured, settings.tolerance))


def _against_reference(
    target: Target, blender: Blender, settings: ComparisonSettings, folder: Path, out: Path, limits: Limits
) -> dict[str, Any]:
    """Run `etalon compare` in a Blender, and return its result."""
    report = folder / folder_name(blender.label)
    words = ["compare", *write_changes(target, settings), f"--out={report.absolute()}", "--quiet"]
    status, code, message = run_comparison(partial(Comparer, blender.request({"words": words})), report, limits)
    return version_figures(blender.label, report, out, status, code, message)


@contextmanager
def _opened(target: Target, blenders: Sequence[Blender], settings: ComparisonSettings) -> Iterator[list[Opened]]:
    """The scene in each of the Blenders, which start side by side and end with the block."""
    with ExitStack() as stack:
        processes = []
        for blender in blenders:
            folder = stack.enter_context(temporary_folder())
            request = {"target": target.to_json(), "settings": settings.to_json(), "packages": blender.packages}
            process = AnotherBlender(blender.command, request, folder, f"Blender {blender.label}")
            stack.callback(process.close)
            processes.append(process)
        opened = []
        for blender, process in zip(blenders, processes, strict=True):
            try:
                scene = process.export()
            except Refused as refused:
                raise EtalonError(f"Blender {blender.label}: {refused}") from refused
            opened.append(Opened(blender.label, scene, process, process.may_shrink))
        yield opened
