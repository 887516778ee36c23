# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon completion`: a script for the completion of a shell.

It completes commands, options and their values.
"""

from __future__ import annotations

import argparse

from ...lib.errors import EtalonError
from ...lib.settings.commands import CompletionOptions
from ...lib.settings.common import REFERENCE_SCENES, Terminal
from ...lib.settings.units import Choice, FilePath
from .arguments import command_parsers
from .cli import parser
from .console import print_json
from .table import COMMANDS

# A scene is one of these or a .blend; both are offered by a function of bash, other shells offer files.
_SCENE = "_etalon_scene"
_BASH = f"""\
{_SCENE}() {{
  compgen -W '{" ".join(REFERENCE_SCENES)}' -- "$1"
  compgen -f -X '!*.blend' -- "$1"
  compgen -d -S / -- "$1"
}}
"""


def run(settings: CompletionOptions, terminal: Terminal) -> int:
    """Print the script."""
    try:
        import shtab
    except ImportError as error:  # inside Blender, which has no shell
        raise EtalonError("completion needs the package shtab; run: pip install shtab") from error
    top = parser(everything=True)
    for command in COMMANDS:
        options = {declared.name: declared for kind in command.settings for declared in kind.options()}
        for action in command_parsers(top)[command.name]._actions:
            if action.dest in options:
                _offer(action, options[action.dest].unit, shtab.FILE)
            if action.dest == "scene":
                action.complete = {**shtab.FILE, "bash": _SCENE}
    script = shtab.complete(top, settings.shell, preamble={"bash": _BASH})
    if terminal.json:
        print_json({"shell": settings.shell, "script": script})
    else:
        print(script)
    return 0


def _offer(action: argparse.Action, unit: object, file: dict[str, str]) -> None:
    """Have the values of an option offered: the names that it takes, or files."""
    if isinstance(unit, Choice):
        action.choices = unit.names
    elif isinstance(unit, FilePath):
        action.complete = file
