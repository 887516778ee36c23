# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon microsurface`: height fields, traced, beside the formulas of masking."""

from __future__ import annotations

from ...lib.exit_codes import ExitCode
from ...lib.microsurface.measure import figures_of, lines_of, measure_microsurface, write_field
from ...lib.plain_text import one_line
from ...lib.progress import Progress
from ...lib.settings.commands import MicrosurfaceOptions
from ...lib.settings.common import Terminal
from .console import bar, interruptible, print_json

_ANGLES = (30.0, 60.0, 75.0, 82.0)


def run(options: MicrosurfaceOptions, terminal: Terminal) -> int:
    """Trace the fields and print the tables, or JSON."""
    angles = _ANGLES if options.angle is None else (float(options.angle),)
    with interruptible() as interrupted, bar("microsurface", terminal) as shown:
        progress = Progress(shown.report, interrupted, shown.tell, shown.begin)
        if options.mesh is not None:
            write_field(options.mesh, options.alpha, options.correlation, options.seed)
        found = measure_microsurface(options.alpha, angles, options.fields, options.correlation, options.seed, progress)
    if terminal.json:
        print_json(figures_of(found, options.alpha, options.fields, options.correlation, options.seed))
    else:
        print("\n".join(lines_of(found)))
        if options.mesh is not None:
            print(f"\nmesh: {one_line(str(options.mesh))}")
    return ExitCode.DONE
