# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon plan FOLDER`: which of many files can be compared, and what stops the others."""

from __future__ import annotations

import csv
import io
import json
import os
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

from ...lib.batch.asked import ask_plan
from ...lib.errors import Cancelled, EtalonError, Refusal
from ...lib.exit_codes import ExitCode
from ...lib.plain_text import one_line, spreadsheet_cell
from ...lib.plural import plural
from ...lib.progress import Progress
from ...lib.refusals import group_refusals

PASSES, REFUSED, FAILED = "passes", "refused", "failed"
_COLUMNS = ("file", "state", "triangles", "lights", "reasons")


@dataclass(frozen=True)
class Surveyed:
    """The result for one file.

    It is its path below the folder, its `state`, what it is `refused` for, or the `error` that ended it.
    """

    file: str
    state: str
    triangles: int = 0
    lights: int = 0
    refused: tuple[Refusal, ...] = ()
    error: str | None = None

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why it does not pass, one text a reason."""
        return (self.error,) if self.error else tuple(str(reason) for reason in group_refusals(self.refused))

    @property
    def kinds(self) -> frozenset[str]:
        """The reasons without the names in this file, to count over files."""
        if self.error:
            return frozenset([self.error.rsplit(": ", 1)[-1].partition(";")[0]])
        return frozenset(f"{reason.kind}: {_nameless(reason.what)}" for reason in group_refusals(self.refused))


def find_files(folder: Path) -> list[Path]:
    """All .blend files below `folder`, in order; raises EtalonError where there is none."""
    found = sorted(path for path in folder.rglob("*.blend") if path.is_file())
    if not found:
        raise EtalonError(f"{folder}: no .blend file in it; check the path")
    return found


def survey(files: Sequence[Path], folder: Path, options: Sequence[str], progress: Progress) -> Iterator[Surveyed]:
    """Yield every one of the `files` below `folder` as it is done, in order.

    Each is read in a process of its own: one that crashes is a row like the others. When asked to stop, what is being
    read is given up, and what was finished is yielded.
    """
    with ThreadPoolExecutor(max_workers=min(os.cpu_count() or 1, 4)) as pool:
        reading = [pool.submit(_read, path, str(path.relative_to(folder)), options, progress) for path in files]
        for done, one in enumerate(reading, 1):
            with suppress(Cancelled):
                yield one.result()
            progress.report(done / len(files))


def _read(path: Path, name: str, options: Sequence[str], progress: Progress) -> Surveyed:
    answer = ask_plan(str(path.resolve()), options, progress)
    if answer.found is None:
        return Surveyed(name, REFUSED if answer.code == ExitCode.BAD_INPUT else FAILED, error=answer.error)
    if answer.code == ExitCode.BAD_INPUT:
        return Surveyed(name, REFUSED, refused=tuple(Refusal(**one) for one in answer.found["refusals"]))
    return Surveyed(name, PASSES, answer.found["triangles"], answer.found["lights"])


def _nameless(what: str) -> str:
    """`what` with the kind of a node alone, where it has the name that the user gave it too."""
    return re.sub(r"node '.*?' \((.*?)\)", r"\1", what).strip(" ,")


def count_reasons(files: Sequence[Surveyed]) -> list[tuple[str, int, int]]:
    """Each reason, the files that it stops, and those that nothing else stops.

    The reason that stops most files is first.
    """
    every = Counter(kind for one in files for kind in one.kinds)
    alone = Counter(next(iter(one.kinds)) for one in files if len(one.kinds) == 1)
    return [(kind, count, alone[kind]) for kind, count in every.most_common()]


def as_text(files: Sequence[Surveyed], found: int) -> str:
    """A row a file, and what blocks, for a terminal; of `found` files these were read."""
    width = max((len(one.file) for one in files), default=0)
    lines = [f"{one.file:{width}}  {one.state:7}  {'; '.join(one.reasons)}".rstrip() for one in files]
    passing = sum(one.state == PASSES for one in files)
    lines += ["", f"{passing} of {plural(len(files), 'file')} can be compared."]
    if len(files) < found:
        lines.append(f"Interrupted: {found - len(files)} of {plural(found, 'file')} were not read.")
    counted = count_reasons(files)
    if counted:
        lines += ["", "files  alone  what stops them"]
        lines += [f"{count:5}  {alone:5}  {kind}" for kind, count, alone in counted]
    return "\n".join(map(one_line, lines))


def as_json(folder: Path, files: Sequence[Surveyed], found: int) -> str:
    """The same as JSON."""
    rows = [{**asdict(one), "reasons": one.reasons} for one in files]
    counted = [{"reason": kind, "files": count, "alone": alone} for kind, count, alone in count_reasons(files)]
    figures = {"folder": str(folder), "found": found, "files": rows, "reasons": counted}
    return json.dumps(figures, indent=2)


def as_csv(files: Sequence[Surveyed]) -> str:
    """One row a file; the reasons in one cell, a line each."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(_COLUMNS)
    for one in files:
        cells = one.file, one.state, one.triangles, one.lights, "\n".join(one.reasons)
        rows.writerow(map(spreadsheet_cell, cells))
    return text.getvalue()
