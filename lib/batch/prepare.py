# SPDX-License-Identifier: GPL-3.0-or-later
"""A plan checked as a whole before its first comparison.

It finds what each scene has, and which comparisons the journal lacks.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from ..cluster.client import Cluster
from ..errors import EtalonError
from ..files.atomic import replace_files
from ..progress import Progress
from ..report.read import read_verdict
from .asked import ask_plan
from .comparison import ENDED, FINISHED
from .journal import Entry, Journal, open_journal
from .keys import Hashes, make_key
from .plan import BatchPlan, Unit

Tell = Callable[[str], None]


@dataclass(frozen=True)
class Host:
    """A Blender that comparisons run in.

    It has its `name`, with the build, and the command line that runs words of `etalon` in it.
    """

    name: str
    command: Callable[[list[str]], list[str]]


@dataclass(frozen=True)
class How:
    """How a plan is run.

    `blender` names the release and the build at hand, `hosts` are the Blenders that the plan names. `jobs` comparisons run side by side, with
    `threads` each (None: as the plan says); with a `cluster`, on its workers. `force` runs all again, `retry` those
    that were refused or failed.
    """

    blender: str
    hosts: Mapping[str, Host] = field(default_factory=dict)
    jobs: int = 1
    threads: int | None = None
    force: bool = False
    retry: bool = False
    cluster: Cluster | None = None


@dataclass(frozen=True)
class Batch:
    """A plan that was checked.

    It has its `units` by their keys, the keys of those that are `missing`, and the journal, which is open. `files`
    are, for each scene of a batch on a cluster, the paths of its files with their hashes.
    """

    plan: BatchPlan
    how: How
    journal: Journal
    units: dict[str, Unit]
    missing: list[str]
    files: Mapping[str, Mapping[str, str]] = field(default_factory=dict)

    def recorded(self) -> list[tuple[Unit, Entry | None]]:
        """Every unit with its entry, None where it has none."""
        known = self.journal.read_all()
        return [(unit, known.get(key)) for key, unit in self.units.items()]


@contextmanager
def prepare(plan: BatchPlan, how: How, tell: Tell, progress: Progress) -> Iterator[Batch]:
    """Check a plan and open its journal for the length of a block.

    Each scene that has comparisons to run is read by `etalon plan`, in a process of its own. `tell`
    receives the earlier results that cannot be used. Raises EtalonError where a scene cannot be read, or lacks what the
    plan varies.
    """
    with replace_files(plan.out):  # says at once when the folder cannot be written
        pass
    with open_journal(plan.out) as journal:
        hashes = Hashes(journal)
        new = [scene for scene in plan.scenes if hashes.of_scene(plan.target(scene)) is None]
        _ask(plan, new, hashes, progress)
        units = {_key(plan, unit, how, hashes): unit for unit in plan.units()}
        known = journal.read_all()
        missing = [key for key in units if not _is_done(plan.out, known.get(key), how, tell)]
        if plan.variations:
            scenes = dict.fromkeys(units[key].scene for key in missing)
            _ask(plan, [scene for scene in scenes if scene not in new], hashes, progress)
        targets = {units[key].target for key in missing} if how.cluster else ()
        yield Batch(plan, how, journal, units, missing, {target: hashes.of_files(target) for target in targets})


def _ask(plan: BatchPlan, scenes: Sequence[str], hashes: Hashes, progress: Progress) -> None:
    """Have each of the scenes read, and check that it has what the plan varies.

    The files that it refers to are kept.
    """
    if not scenes:
        return
    progress.begin("reading the scenes")
    stop = threading.Event()
    asking = Progress(is_cancelled=stop.is_set)
    with ThreadPoolExecutor(max_workers=2) as pool:
        try:
            answers = list(pool.map(lambda scene: ask_plan(plan.target(scene), plan.asked, asking), scenes))
        except BaseException:  # Ctrl-C does not wait for large files
            stop.set()
            raise
    for scene, answer in zip(scenes, answers, strict=True):
        if answer.found is None:
            raise EtalonError(f"{scene}: {answer.error.removeprefix(f'{scene}: ')}")
        plan.check_facts(scene, answer.found)
        hashes.learn(plan.target(scene), answer.found.get("files", ()))


def _key(plan: BatchPlan, unit: Unit, how: How, hashes: Hashes) -> str:
    host = how.hosts.get(unit.blender or "")
    return make_key(unit, plan.options, how.blender if host is None else host.name, hashes.of_scene(unit.target) or "")


def _is_done(out: Path, entry: Entry | None, how: How, tell: Tell) -> bool:
    """Whether there is nothing to run.

    That holds for a verdict that the folder still has, or a reason why there is none. A file that cannot be used is
    reported by `tell`.
    """
    if entry is None or how.force or entry.status == ENDED:
        return False
    if entry.status != FINISHED:
        return not how.retry
    path = out / entry.folder / "verdict.json"
    if not path.is_file():
        return False
    try:
        read_verdict(path)
    except EtalonError as error:
        tell(str(error))
        return False
    return True
