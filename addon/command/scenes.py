# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon scenes`: list the reference scenes, or save one."""

from __future__ import annotations

from pathlib import Path

from ...lib.settings.commands import ScenesOptions
from ...reference_scenes import SCENES, save
from ..host.quiet import quiet


def run(settings: ScenesOptions) -> int:
    """List the reference scenes, or save one as a .blend."""
    if settings.save is None:
        width = max(map(len, SCENES))
        for name, module in SCENES.items():
            print(f"{name:{width}}  {module.__doc__.splitlines()[0]}")
        return 0
    name, path = settings.save
    with quiet():
        save(name, Path(path))
    print(f"{name} saved as {path}")
    return 0
