# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes at the edge, rendered by the reference and by Cycles.

Both are compared with the radiance that each scene should show.
"""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np

from ...lib.film.rendering import Rendering
from ...lib.sampling.streams import COUNTED
from ...lib.settings.reference import Options
from ...lib.stability.case import Case
from ...lib.wavefront.render import ReferenceRenderer
from ...reference_scenes.edge import CASES, EdgeCase
from ..cycles.renderer import CyclesRenderer
from ..host.quiet import quiet
from ..job import export

FAMILY = "scene at the edge"


def edge_cases() -> Iterator[Case]:
    """One case a scene, as it is done; about a second each."""
    for case in CASES:
        with quiet():
            case.build()
            scene = bpy.context.scene
            options = Options(threads=2)
            reference = ReferenceRenderer(export(scene), options).render(COUNTED.number(0), case.samples)
            cycles = CyclesRenderer(scene, threads=options.threads).render(COUNTED.number(0), case.samples)
        worst, where = _error(case, reference)
        theirs, _ = _error(case, cycles)
        lost = [int(np.count_nonzero(rendering.nonfinite)) for rendering in (reference, cycles)]
        found = f"{where}; pixels not finite: reference {lost[0]}, Cycles {lost[1]}"
        unit = "relative error" if case.radiance else "radiance"
        yield Case(FAMILY, case.name, worst, case.tolerance, unit, found, cycles=theirs, points=case.samples)


def _error(case: EdgeCase, rendering: Rendering) -> tuple[float, str]:
    """The largest error of a quarter of the image, and where it is.

    Where all is black it is that of a pixel. It is infinite where a sample was not finite.
    """
    if rendering.nonfinite.any():
        return float("inf"), "samples that are not finite"
    image = rendering.radiance
    if not case.radiance:
        return float(np.abs(image).max()), "brightest pixel"
    half = image.shape[0] // 2
    quarters = image.reshape(2, half, 2, half, 3).mean(axis=(1, 3, 4))
    error = np.abs(quarters / case.radiance - 1.0)
    row, column = np.unravel_index(int(error.argmax()), error.shape)
    return float(error.max()), f"quarter {row}, {column} of the image"
