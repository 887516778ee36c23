# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon probe`: the light of a pixel by its parts.

It also lists the lights of the scene in all units.
"""

from __future__ import annotations

import bpy

from ...lib.plain_text import one_line
from ...lib.progress import Progress
from ...lib.settings.common import Target, Terminal
from ...lib.settings.probe import ProbeOptions
from ..host.quiet import quiet
from ..probe import probe_here
from .console import bar, interruptible, print_json
from .opening import open_target, refuse_archive


def run(target: Target, options: ProbeOptions, terminal: Terminal) -> int:
    """Open the scene, read the pixel, and print the parts of its light.

    Ctrl-C reads from the replicates that are done.
    """
    refuse_archive(target)
    name = open_target(target.scene, target.frame, target.camera, target.assignments)
    with interruptible() as interrupted, bar(name, terminal) as shown, quiet():
        progress = Progress(shown.report, interrupted, shown.tell, shown.begin)
        found = probe_here(name, bpy.context.scene, options, progress)
    if terminal.json:
        print_json(found.figures)
    else:
        print("\n".join(map(one_line, found.lines)))
    return 0
