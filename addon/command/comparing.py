# SPDX-License-Identifier: GPL-3.0-or-later
"""The comparison of the open scene, on this machine or on the workers of a scheduler.

The command line and scripts call the same function.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path

import bpy

from ...lib.cluster.client import connect
from ...lib.cluster.worker import digest_of
from ...lib.comparison.compare import Comparison
from ...lib.files.ownership import temporary_folder
from ...lib.progress import Progress
from ...lib.settings.common import LOCAL, Target
from ...lib.settings.comparison import ComparisonSettings, Settings
from ...lib.settings.words import repeating_command
from .. import job
from ..background import save_copy
from ..cycles.spread import spread_over
from .facts import external_files
from .opening import as_opened


def compare_opened(target: Target, settings: Settings, folder: Path | None, progress: Progress) -> Comparison:
    """Compare the open scene, which `target` named, where `settings.scheduler` says.

    The report goes to `folder`, if there is one. Raises EtalonError or Refused, also for a scheduler that does not
    answer, a worker that differs, and workers that cannot open the scene.
    """
    repeat = repeating_command("compare", as_opened(target), settings)
    with _workers(target, settings) as spread:
        return job.compare_here(bpy.context.scene, settings, folder, repeat, progress, spread)


@contextmanager
def _workers(target: Target, settings: Settings) -> Iterator[job.Spread]:
    """Yield what has the workers of the scheduler render, or this machine.

    Where `target` names no scene, workers open a copy of the open file: the one on the disk may be another.
    """
    if settings.scheduler == LOCAL:
        yield job.here
        return
    with ExitStack() as stack:
        cluster = stack.enter_context(connect(settings.scheduler))
        version, commit, date = bpy.app.version_string, *map(_text, (bpy.app.build_hash, bpy.app.build_date))
        cluster.check(f"{version} {commit}")
        if target.scene is None:
            copy = stack.enter_context(temporary_folder()) / "scene.blend"
            save_copy(copy)
            target = replace(target, scene=str(copy))
        files: dict[str, str] = {}
        if str(target.scene).endswith(".blend"):
            target = replace(target, scene=str(Path(str(target.scene)).resolve()))
            paths = [Path(str(target.scene)), *map(Path, external_files())]
            files = {str(path): digest_of(path.read_bytes()) for path in paths if path.is_file()}
        options = settings.part(ComparisonSettings)
        yield stack.enter_context(spread_over(cluster, (version, f"{commit}, {date}"), target, options, files))


def _text(value: bytes) -> str:
    return value.decode(errors="replace")
