# SPDX-License-Identifier: GPL-3.0-or-later
"""One comparison of a batch on a worker.

Its command line and files go there, and the files of its report come back.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from pathlib import Path

from ..cluster.client import Cluster
from ..cluster.worker import Lacks, find_files, folder, watch_task, worker_name
from ..errors import Cancelled, EtalonError
from ..exit_codes import ExitCode
from ..files.atomic import replace_files
from ..version import VERSION
from .asked import ask_plan
from .comparer import Comparer
from .comparison import ENDED, FAILED, REFUSED, Limits, run_comparison
from .process import etalon_command


@dataclass(frozen=True)
class Done:
    """The result of a comparison on a worker, in the form of `run_comparison`.

    `report` has contents by file names.
    """

    status: str
    code: int
    message: str
    report: Mapping[str, bytes] = field(default_factory=dict)


def run_on_cluster(
    cluster: Cluster, words: Sequence[str], files: Mapping[str, str], out: Path, limits: Limits
) -> tuple[str, int, str]:
    """Run `etalon` with these words on a worker, and write its report to `out`.

    The second of the words is the scene. `files` are the paths of the scene's files with their digests. Returns what
    `run_comparison` does. Workers that die again and again, or a scheduler that is gone, give FAILED; the end of the
    command gives ENDED.
    """
    contents = {digest: Path(path) for path, digest in files.items()}
    arguments = (VERSION, list(words), dict(files), limits.seconds, limits.memory)
    try:
        done = cluster.call(run_on_worker, arguments, contents, limits.is_ending)
    except Cancelled:
        return ENDED, int(ExitCode.BAD_INPUT), "it was ended with the command"
    except EtalonError as error:
        return FAILED, int(ExitCode.BAD_INPUT), str(error)
    if done.report:
        with replace_files(out) as beside:
            for name, content in done.report.items():
                (beside / Path(name).name).write_bytes(content)
    return done.status, done.code, done.message


def run_on_worker(
    version: str, words: list[str], files: Mapping[str, str], seconds: float | None, memory: int | None
) -> Done | Lacks:
    """Run one comparison in a process of its own on the worker that this call came to."""
    if version != VERSION:
        message = (
            f"worker {worker_name()} has Étalon {VERSION}; install Étalon {version} there, and run the batch again"
        )
        return Done(ENDED, int(ExitCode.BAD_INPUT), message)
    places = find_files(files)
    if isinstance(places, Lacks):
        return places
    name, scene, *rest = words
    if str(places.get(scene, scene)) != scene and (message := find_absolute(scene, str(places[scene]))):
        return Done(REFUSED, int(ExitCode.BAD_INPUT), message)
    with tempfile.TemporaryDirectory(dir=folder()) as made:
        out = Path(made) / "out"
        command = [*etalon_command(), name, str(places.get(scene, scene)), *rest, *_threads(words), f"--out={out}"]
        status, code, message = run_comparison(
            partial(Comparer, command, temporary=Path(made)), out, Limits(seconds, memory, watch_task())
        )
        report = {path.name: path.read_bytes() for path in out.glob("*") if path.is_file()}
    return Done(status, code, message, report)


@lru_cache
def find_absolute(scene: str, copy: str) -> str:
    """Why the copy of a scene does not find the copies of its files, or ''."""
    answer = ask_plan(copy, ())
    if answer.found is None:
        return answer.error.removeprefix(f"{copy}: ")
    outside = [path for path in answer.found.get("files", ()) if folder() not in Path(path).parents]
    if not outside:
        return ""
    return f"{scene} refers to {outside[0]} by an absolute path; make it relative, or share the file with the workers"


def _threads(words: Sequence[str]) -> list[str]:
    """An equal share of the processors for each call that the worker runs at once.

    It applies where the plan does not set the threads.
    """
    from distributed import get_worker

    if any(word.startswith("--threads=") for word in words):
        return []
    return [f"--threads={max((os.cpu_count() or 1) // get_worker().state.nthreads, 1)}"]
