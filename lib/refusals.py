# SPDX-License-Identifier: GPL-3.0-or-later
"""The reasons why a scene is refused, as a user reads them.

The same reason appears once, with its owners, and what blocks most comes first.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from .errors import Refusal, Refused

# So many owners of a reason are named; the others are counted.
NAMED = 4
# With more properties to set than this, the command that works is too long to be of use.
MOST_ASSIGNMENTS = 8
MATERIAL = "material"


@dataclass(frozen=True)
class Reason:
    """One thing that is not simulated.

    It has the `kind` of what the user named (material, object, ...), all their `names`, `what` and `remedy`.
    `assignments` are what `--set` takes to leave it out of the scene, one for each of the names, or none.
    """

    kind: str
    names: tuple[str, ...]
    what: str
    remedy: str
    assignments: tuple[str, ...] = ()

    def __str__(self) -> str:
        if len(self.names) == 1:
            return str(Refusal(f"{self.kind} {self.names[0]}".rstrip(), self.what, self.remedy))
        shown = ", ".join(self.names[:NAMED])
        others = f" and {len(self.names) - NAMED} more" if len(self.names) > NAMED else ""
        return f"{len(self.names)} {self.kind}s ({shown}{others}): {self.what} is not simulated; {self.remedy}"


def group_refusals(refusals: Iterable[Refusal]) -> list[Reason]:
    """The reasons among `refusals`, those with most owners first, each owner once.

    >>> [str(r) for r in group_refusals([Refusal("material 'A'", "Toon", "remove it"), Refusal("material 'B'", "Toon", "remove it")])]
    ["2 materials ('A', 'B'): Toon is not simulated; remove it"]
    """
    owners: dict[tuple[str, str, str], dict[str, str]] = {}
    for refusal in refusals:
        kind, _, name = refusal.owner.partition(" ")
        kind, name = (kind, name) if name.startswith("'") else (refusal.owner, "")
        owners.setdefault((kind, refusal.what, refusal.remedy), {})[name] = refusal.assignment
    reasons = [
        Reason(kind, tuple(names), what, remedy, tuple(names.values()) if all(names.values()) else ())
        for (kind, what, remedy), names in owners.items()
    ]
    return sorted(reasons, key=lambda reason: -len(reason.names))


def describe_refusals(refused: Refused) -> list[str]:
    """A line for each reason, and one for what can be compared as things are, if anything can."""
    reasons = group_refusals(refused.refusals)
    rest = what_would_work(reasons, refused.allows_partial)
    return [str(reason) for reason in reasons] + ([rest] if rest is not None else [])


def is_for_command_line(line: str) -> bool:
    """Whether a line of `describe_refusals` names options that compare the rest, which the panel does not have.

    >>> is_for_command_line("without 'smoke', --partial compares the rest")
    True
    """
    return bool(re.search(r"(^|, )--.* compares? the rest$", line))


def what_would_work(reasons: Sequence[Reason], allows_partial: bool = True) -> str | None:
    """What can be compared as things are, in a sentence; None where nothing can.

    Materials stand in the way too where --partial is not allowed.
    """
    assignments = [f"--set {shlex.quote(one)}" for reason in reasons for one in reason.assignments]
    if len(assignments) > MOST_ASSIGNMENTS:
        assignments = []
    partial = [one for one in reasons if one.kind == MATERIAL and allows_partial]
    others = [one for one in reasons if one not in partial and not (assignments and one.assignments)]
    if len(others) == len(reasons):
        return None
    options = ["--partial"] * bool(partial) + assignments
    what = "compares" if len(options) == 1 else "compare"
    if not others:
        return f"{' '.join(options)} {what} the rest"
    count = f"the {len(others)} other reasons" if len(others) > 1 else f"'{others[0].what}'"
    return f"without {count}, {' '.join(options)} {what} the rest"
