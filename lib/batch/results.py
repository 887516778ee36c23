# SPDX-License-Identifier: GPL-3.0-or-later
"""The results of a batch.

They are tables, JSON, JUnit XML and a page, the lines that sum them up, and the exit code.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cached_property
from typing import Any
from xml.etree import ElementTree

from ..errors import EtalonError
from ..exit_codes import ExitCode
from ..files.atomic import replace_files
from ..files.plain_data import write_json
from ..pages.formats import format_bound, format_percent
from ..plain_text import one_line
from ..plural import plural
from ..report.batch import Row, write_csv, write_grid
from ..report.read import read_verdict
from ..settings.units import Share
from ..verdict.outcome import Outcome
from .against import FORMAT, VERSION, Changed, find_changes
from .comparison import FINISHED, VERDICTS
from .journal import Entry
from .plan import BatchPlan, Unit

# From the best to the worst: a batch ends with the exit code of its worst comparison.
_SEVERITY = (ExitCode.EQUIVALENT, ExitCode.EXPLAINED, ExitCode.UNDECIDED, ExitCode.DIFFERENT)
DIFFERENT, CHANGED, BOUND = "different", "changed", "bound"


@dataclass(frozen=True)
class FailOn:
    """The rule by which a batch fails.

    It is a verdict DIFFERENT, a change against an earlier batch, or a bound above `limit`.
    """

    rule: str
    limit: float = 0.0

    def has_failed(self, row: Row, has_changed: bool) -> bool:
        """Whether one comparison breaks the rule; one without a verdict breaks that of bounds."""
        if self.rule == DIFFERENT:
            return row.verdict == Outcome.DIFFERENT.value
        if self.rule == CHANGED:
            return has_changed
        return row.bound is None or row.bound > self.limit


def read_fail_on(text: str) -> FailOn:
    """The rule that 'different', 'changed' or 'bound:2%' says; raises ValueError."""
    rule, colon, limit = text.partition(":")
    if rule in (DIFFERENT, CHANGED) and not colon:
        return FailOn(rule)
    if rule == BOUND and colon:
        return FailOn(rule, Share().read(limit))
    raise ValueError(f"'{text}' is no rule; give {DIFFERENT}, {CHANGED} or {BOUND}:2%")


@dataclass(frozen=True)
class End:
    """How a batch ends.

    It has the rule by which it fails (None: the code of its worst comparison), and the batch.json of an `earlier` one.
    """

    fail_on: FailOn | None = None
    earlier: Mapping[str, Any] | None = None


@dataclass(frozen=True)
class Results:
    """The rows of a batch, by the labels of its comparisons, and their results."""

    plan: BatchPlan
    rows: list[tuple[str, Row]]
    end: End = field(default_factory=End)

    @cached_property
    def changes(self) -> tuple[Changed, ...]:
        """What changed since the earlier batch."""
        return () if self.end.earlier is None else find_changes(self.end.earlier, self.rows, self.plan.out)

    @property
    def failing(self) -> list[str]:
        """The labels of comparisons that break the rule."""
        rule, changed = self.end.fail_on, {one.label for one in self.changes}
        return [label for label, row in self.rows if rule is not None and rule.has_failed(row, label in changed)]

    @property
    def exit_code(self) -> ExitCode:
        """The exit code of the batch.

        It is BAD_INPUT where a comparison has no verdict, else that of the rule, else the code of the worst comparison.
        """
        if any(row.status != FINISHED for _, row in self.rows):
            return ExitCode.BAD_INPUT
        if self.end.fail_on is not None:
            return ExitCode.DIFFERENT if self.failing else ExitCode.DONE
        return max((ExitCode[row.verdict] for _, row in self.rows), key=_SEVERITY.index)

    def sentences(self) -> list[str]:
        """The result of the batch: comparisons of each verdict, what changed, what fails."""
        counts = Counter(row.verdict or row.status for _, row in self.rows)
        shown = ", ".join(f"{count} {outcome}" for outcome, count in counts.most_common())
        said = [f"{plural(len(self.rows), 'comparison')}: {shown}"]
        if self.end.earlier is not None:
            said += [f"changed: {one}" for one in self.changes] or ["nothing changed since the earlier batch"]
        if self.end.fail_on is not None:
            limit = f" {format_percent(self.end.fail_on.limit, sign=False)}" if self.end.fail_on.rule == BOUND else ""
            said.append(
                f"{len(self.failing)} of {plural(len(self.rows), 'comparison')} fail by the rule {self.end.fail_on.rule}{limit}"
            )
        return said


def outcome_of(entry: Entry) -> str:
    """The verdict of a comparison, or why it has none."""
    return VERDICTS[entry.exit_code] if entry.status == FINISHED else entry.status


def write_results(results: Results) -> None:
    """Write batch.csv, batch.json, junit.xml and batch.html.

    They are about the whole plan, as far as the journal knows it.
    """
    plan, rows = results.plan, [row for _, row in results.rows]
    names = [v.name for v in plan.variations]
    with replace_files(plan.out) as beside:
        write_csv(names, rows, beside / "batch.csv")
        write_json(beside / "batch.json", _document(results, names))
        _junit(results).write(beside / "junit.xml", encoding="utf-8", xml_declaration=True)
        paths = [v.path for v in plan.variations]
        write_grid(names, rows, beside / "batch.html", plan.out, paths, [str(one) for one in results.changes])


def _document(results: Results, names: list[str]) -> dict[str, Any]:
    """batch.json as a dictionary; its published form is batch.schema.json beside this file."""
    plan = results.plan
    comparisons = [
        {"label": label, **asdict(row), "values": dict(zip(names, row.values, strict=True))}
        for label, row in results.rows
    ]
    return {
        "format": FORMAT,
        "version": VERSION,
        "axes": [{"name": v.name, "path": v.path, "values": list(v.values)} for v in plan.variations],
        "comparisons": comparisons,
        "changes": [asdict(one) for one in results.changes],
        "failing": results.failing,
        "exit_code": int(results.exit_code),
        "sentences": results.sentences(),
    }


def _junit(results: Results) -> ElementTree.ElementTree:
    """The rows as JUnit XML.

    What breaks the rule is a failure; without a rule what is DIFFERENT. UNDECIDED is skipped, no verdict an error.
    """
    failing = set(results.failing) if results.end.fail_on else _different(results)
    seconds = sum(row.seconds for _, row in results.rows)
    suite = ElementTree.Element(
        "testsuite", name=one_line(results.plan.out.name), tests=str(len(results.rows)), time=f"{seconds:.1f}"
    )
    counts = Counter[str]()
    for label, row in results.rows:
        case = ElementTree.SubElement(
            suite, "testcase", classname=one_line(row.scene), name=one_line(label), time=f"{row.seconds:.1f}"
        )
        bound = "no bound" if row.bound is None else f"bound {format_bound(row.bound)}"
        if row.status != FINISHED:
            kind, message = "error", f"{row.status}: {row.message}"
        elif label in failing:
            kind, message = "failure", f"{row.verdict}, {bound}"
        elif row.verdict == Outcome.UNDECIDED.value:
            kind, message = "skipped", f"UNDECIDED, {bound}"
        else:
            continue
        counts[kind] += 1
        ElementTree.SubElement(case, kind, message=one_line(message))
    for name, kind in (("errors", "error"), ("failures", "failure"), ("skipped", "skipped")):
        suite.set(name, str(counts[kind]))
    return ElementTree.ElementTree(suite)


def _different(results: Results) -> set[str]:
    return {label for label, row in results.rows if row.verdict == Outcome.DIFFERENT.value}


def read_row(plan: BatchPlan, unit: Unit, entry: Entry | None) -> tuple[str, Row]:
    """The label of a unit, and its row.

    The row is what the journal has on it, and the comparison's own verdict.json of the whole image.
    """
    values = tuple(value for _, value in unit.assignments)
    if entry is None:
        return unit.label, Row(unit.scene, values, status="not run")
    facts: dict[str, Any] = {name: getattr(entry, name) for name in ("status", "seconds", "folder", "message")}
    if entry.status != FINISHED:
        return unit.label, Row(unit.scene, values, **facts)
    try:
        figures = read_verdict(plan.out / entry.folder / "verdict.json")
    except EtalonError as error:
        facts |= {"status": "not run", "message": str(error)}
        return unit.label, Row(unit.scene, values, **facts)
    image, blender = figures["image"], figures["blender"]
    low, high = image["interval"]
    programs = [f"{name} {version}" for name, version in figures["versions"].items()]
    row = Row(
        unit.scene,
        values,
        **facts,
        verdict=VERDICTS[entry.exit_code],
        difference=image["difference"],
        low=low,
        high=high,
        bound=figures["bound"]["value"],
        counts=dict(Counter(region["outcome"] for region in figures["regions"])),
        tolerance=figures["tolerance"],
        confidence=figures["confidence"],
        versions=(*([f"Blender {blender['version']}"] if blender["version"] else []), *programs),
    )
    return unit.label, row
