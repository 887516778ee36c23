# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors a user can meet: one line that names the thing and the remedy, exit code 2."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass


class EtalonError(Exception):
    """Bad input or an environment that cannot serve.

    Its text is the whole message to the user.
    """


class Cancelled(EtalonError):
    """The caller asked to stop; the unfinished replicate is not kept."""


class SceneError(EtalonError):
    """Scene arrays that break their own rules (shape, range, finiteness)."""


@dataclass(frozen=True)
class Refusal:
    """One thing of the scene that is not simulated.

    `owner` is what the user named (material, light, object, world, scene), `what` the node, socket or
    setting, `remedy` what to do about it; `assignment` is the property and value that `--set` takes to have the scene compared without it,
    '' where there is none.
    """

    owner: str
    what: str
    remedy: str
    assignment: str = ""

    def __str__(self) -> str:
        return f"{self.owner}: {self.what} is not simulated; {self.remedy}"


class Refused(EtalonError):
    """The scene asks for effects that are not simulated; nothing is replaced in silence.

    `allows_partial`: --partial may be advised for materials.
    """

    def __init__(self, refusals: tuple[Refusal, ...] | list[Refusal], allows_partial: bool = True) -> None:
        self.refusals, self.allows_partial = tuple(refusals), allows_partial
        super().__init__("; ".join(str(r) for r in self.refusals))


def unknown(what: str, name: str, known: Sequence[str]) -> str:
    """The text of an error about a name that is not among the `known` ones.

    It suggests a near one, or all of them.

    >>> unknown("strategy", "mss", ("mis", "lights"))
    "unknown strategy 'mss'; did you mean 'mis'?"
    """
    near = difflib.get_close_matches(name, known, n=1)
    return f"unknown {what} '{name}'; " + (f"did you mean '{near[0]}'?" if near else f"choose from {', '.join(known)}")
