# SPDX-License-Identifier: GPL-3.0-or-later
"""The page docs/options.md, made from the declared options.

Run `python -m etalon.addon.command.documentation > docs/options.md`.
"""

from __future__ import annotations

import sys

from ...lib.settings.declaration import Declared, Option
from ...lib.settings.units import Flag, Pair
from .table import COMMANDS, Command

INTRODUCTION = """\
# Options

This file is made from the declarations in `lib/settings/`: `python -m etalon.addon.command.documentation > docs/options.md`.
A test compares the two.

Times may be written as `90`, `90s`, `2m` or `1h30m`, shares as `0.01` or `1%`. In the `[options]` of a batch the same names are
used without the dashes: numbers, texts as on the command line, `true` and `false`, and lists for options that may be repeated.
In a script, `etalon.Settings`, `etalon.RenderOptions` and `etalon.CostOptions` have a field for each option, named in the last
column; values have the same forms.
"""


def _usage(declared: Option) -> str:
    """How an option is written on the command line."""
    if declared.positional:
        return f"`{declared.unit.metavar}`"
    if isinstance(declared.unit, Flag):
        return f"`--{declared.flag}`, `--no-{declared.flag}`" if declared.default else f"`--{declared.flag}`"
    join = " " if isinstance(declared.unit, Pair) else "="
    return f"`--{declared.flag}{join}{declared.unit.metavar}`"


def _default(declared: Option) -> str:
    if declared.required:
        return "must be given"
    if isinstance(declared.unit, Flag):
        return "on" if declared.default else "off"
    return declared.shown_default or "none"


def _row(declared: Option) -> str:
    panel = declared.panel.label if declared.panel else ""
    cells = (_usage(declared), declared.help, _default(declared), panel, f"`{declared.name}`")
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _table(kinds: tuple[type[Declared], ...]) -> list[str]:
    lines = ["| option | meaning | default | in the panel | field |", "|---|---|---|---|---|"]
    return lines + [_row(declared) for kind in kinds for group in kind.groups().values() for declared in group]


def _section(command: Command) -> list[str]:
    sentence = f"{command.help[0].upper()}{command.help[1:]}."
    return ["", f"## etalon {command.name}", "", sentence, "", *_table(command.settings)]


def document() -> str:
    """The whole text of docs/options.md."""
    lines = [line for command in COMMANDS for line in _section(command)]
    return INTRODUCTION + "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.stdout.write(document())
