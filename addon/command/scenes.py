# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon scenes`: list the reference scenes, or save one."""

from __future__ import annotations

from pathlib import Path

from ...lib.settings.commands import ScenesOptions
from ...lib.settings.common import Terminal
from ...reference_scenes import SCENES, save
from ..host.quiet import quiet
from .console import print_json


def run(settings: ScenesOptions, terminal: Terminal) -> int:
    """List the reference scenes, or save one as a .blend."""
    if settings.save is None:
        about = {name: module.__doc__.splitlines()[0] for name, module in SCENES.items()}
        if terminal.json:
            print_json([{"name": name, "description": text} for name, text in about.items()])
        else:
            width = max(map(len, SCENES))
            print("\n".join(f"{name:{width}}  {text}" for name, text in about.items()))
        return 0
    name, path = settings.save
    with quiet():
        save(name, Path(path))
    if terminal.json:
        print_json({"name": name, "file": path})
    else:
        print(f"{name} saved as {path}")
    return 0
