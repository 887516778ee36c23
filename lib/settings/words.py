# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings as the words of a command line.

They serve the command that a report shows, and the comparisons of a batch.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping
from typing import Any

from ..errors import EtalonError, unknown
from .declaration import Declared, Option
from .units import Flag, Pair


def write_words(declared: Option, value: Any) -> list[str]:
    """The words that give `value` to an option."""
    unit, flag = declared.unit, f"--{declared.flag}"
    if declared.positional:
        return list(unit.plain(value)) if unit.repeats else [unit.write(value)]
    if isinstance(unit, Flag):
        return [flag] if value else [f"--no-{declared.flag}"] if declared.default else []
    if isinstance(unit, Pair):
        return [flag, *map(str, value)]
    if unit.repeats:
        return [f"{flag}={one}" for one in unit.plain(value)]
    return [f"{flag}={unit.write(value)}"]


def _changes(settings: tuple[Declared, ...]) -> Iterator[tuple[Option, Any]]:
    for part in settings:
        changed = part.changed()
        yield from ((declared, changed[declared.name]) for declared in part.options() if declared.name in changed)


def write_changes(*settings: Declared) -> list[str]:
    """The words that give these settings again.

    Options that have their default value are left out.
    """
    return [word for declared, value in _changes(settings) for word in write_words(declared, value)]


def repeating_command(command: str, *settings: Declared) -> str:
    """The command line that gives these settings again.

    Options that have their default value are left out.

    >>> from etalon.lib.settings.common import Run, Target
    >>> repeating_command("render", Target("my room.blend"), Run(seed=3))
    "etalon render 'my room.blend' --seed=3"
    """
    return shlex.join(["etalon", command, *write_changes(*settings)])


def read_table(kinds: tuple[type[Declared], ...], table: Mapping[str, Any]) -> tuple[str, ...]:
    """The words for a table of options by their long names, such as [options] of a batch.

    Values may be numbers, or the same texts as on the command line ("2m", "1%"). Raises EtalonError for an option that `kinds` do not
    have, and for a value that it does not take.

    >>> from etalon.lib.settings.common import Run
    >>> read_table((Run,), {"seed": 3, "threads": "2"})
    ('--seed=3', '--threads=2')
    """
    known = {declared.flag: declared for kind in kinds for declared in kind.options() if not declared.positional}
    words: list[str] = []
    for flag, value in table.items():
        if flag not in known:
            raise EtalonError(unknown("option", flag, tuple(known)))
        several = known[flag].unit.repeats and isinstance(value, str)
        words += write_words(known[flag], known[flag].check([value] if several else value))
    return tuple(words)
