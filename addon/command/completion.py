# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon completion`: a script that lets a shell complete commands, options and their values."""

from __future__ import annotations

from ...lib.errors import EtalonError
from ...lib.settings.commands import CompletionOptions
from ...lib.settings.common import Terminal
from .cli import parser
from .console import print_json


def run(settings: CompletionOptions, terminal: Terminal) -> int:
    """Print the script."""
    try:
        import shtab
    except ImportError as error:  # inside Blender, which has no shell
        raise EtalonError("completion needs the package shtab; run: pip install shtab") from error
    script = shtab.complete(parser(everything=True), settings.shell)
    if terminal.json:
        print_json({"shell": settings.shell, "script": script})
    else:
        print(script)
    return 0
