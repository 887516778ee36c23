# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon render`: the reference alone, as an EXR image."""

from __future__ import annotations

from ...lib.cluster.replicates import render_where_asked
from ...lib.errors import EtalonError
from ...lib.files.atomic import replace_file
from ...lib.film.exr import write_film
from ...lib.plain_text import one_line
from ...lib.plural import plural
from ...lib.progress import Progress
from ...lib.settings.common import Target, Terminal
from ...lib.settings.reference import RenderOptions, RenderOutput
from .console import bar, interruptible, print_json
from .exported import read_scene


def run(target: Target, settings: RenderOutput, terminal: Terminal) -> int:
    """Render the reference and write it; Ctrl-C writes the replicates that are done."""
    scene = read_scene(target)
    with replace_file(settings.out) as path, interruptible() as interrupted, bar(scene.name, terminal) as shown:
        shown.begin("rendering")
        progress = Progress(shown.report, interrupted)
        film = render_where_asked(scene, settings.part(RenderOptions), progress)
        if not film.moments.n:
            raise EtalonError(f"{scene.name}: interrupted before the first replicate was done; nothing was written")
        write_film(path, film)
    if terminal.json:
        height, width = film.shape
        figures = {"scene": scene.name, "file": settings.out, "width": width, "height": height}
        print_json(
            figures
            | {"replicates": film.moments.n, "samples": film.samples, "seconds": film.seconds, "remarks": film.remarks}
        )
    else:
        replicates, samples = plural(film.moments.n, "replicate"), plural(film.samples, "sample")
        print(f"{one_line(str(settings.out))}: {replicates} of {samples}, {film.seconds:.1f} s")
        for remark in film.remarks:
            print(f"  {remark}")
    return 0
