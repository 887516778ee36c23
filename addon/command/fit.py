# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon fit`: the model and the parameters behind a measured BRDF.

It also fits a sphere that Cycles renders.
"""

from __future__ import annotations

from ...lib.fit.identify import identify
from ...lib.fit.words import fit_figures, fit_lines
from ...lib.plain_text import one_line
from ...lib.progress import Progress
from ...lib.settings.common import Terminal
from ...lib.settings.fit import FitOptions, FitSettings
from .console import bar, interruptible, print_json
from .observed import observe_file


def run(options: FitOptions, terminal: Terminal) -> int:
    """Read or render, fit, and print what was found."""
    with interruptible() as interrupted, bar(options.file.name, terminal) as shown:
        progress = Progress(shown.report, interrupted, shown.tell, shown.begin)
        seen = observe_file(options.file, options.part(FitSettings), progress.within(0.0, 0.5))
        found = identify(seen, progress.within(0.5, 1.0))
    if terminal.json:
        print_json(fit_figures(found))
    else:
        print("\n".join(map(one_line, fit_lines(found))))
    return 0
