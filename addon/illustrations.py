# SPDX-License-Identifier: GPL-3.0-or-later
"""The lecture's two rows of spheres, compared with Cycles.

They are the reference scene sigma_sweep, small.
"""

from __future__ import annotations

from dataclasses import replace

import bpy
import numpy as np

from ..lib.comparison.compare import Comparison
from ..lib.lecture.illustrations import Rows, Sphere
from ..lib.progress import Progress
from ..lib.relative import worst_channel
from ..lib.sampling.streams import COUNTED
from ..lib.settings.comparison import Settings
from ..lib.settings.reference import Options
from ..lib.wavefront.render import ReferenceRenderer
from ..reference_scenes import build
from . import job
from .host.quiet import quiet

SCENE, PERCENT = "sigma_sweep", 32
SETTINGS = Settings(time=80.0, tolerance=0.03, size="full")
MOST_SAMPLES = 256
_NAMES = {"BECKMANN": "Beckmann", "GGX": "GGX"}


def render_rows(seed: int, progress: Progress, settings: Settings = SETTINGS, percent: int = PERCENT) -> Rows:
    """Render both rows with both renderers; the scene that is open is replaced.

    `percent` is the size of the image. After the comparison the reference renders once more, with GGX in both rows.
    Raises EtalonError where this Blender comes without its HDRIs.
    """
    with quiet():
        build(SCENE)
        bpy.context.scene.render.resolution_percentage = percent
        comparison = job.compare_here(bpy.context.scene, replace(settings, seed=seed), progress=progress)
        options = replace(settings.part(Options), seed=seed, model="ggx")
        other = ReferenceRenderer(job.export(bpy.context.scene), options)
    film = comparison.reference.film
    samples = min(film.moments.n * film.samples, MOST_SAMPLES)
    return _rows(comparison, other.render(COUNTED.number(0), samples, progress).radiance)


def _rows(comparison: Comparison, all_ggx: np.ndarray) -> Rows:
    films = comparison.reference.film, comparison.candidate.film
    regions, verdict = comparison.regions, comparison.verdict
    spheres = []
    for k in regions.indices("object"):
        distribution, sigma = regions.names[k].split()
        channel = int(worst_channel(verdict.difference[k]))
        weights = np.asarray(regions.weights[[k]].todense()).reshape(regions.shape)
        gap, bound = float(verdict.difference[k, channel]), float(verdict.bounds[k])
        outcome = verdict.outcomes[k].value
        spheres.append(Sphere(_NAMES[distribution], float(sigma), weights, outcome, gap, bound))
    return Rows(
        films[0].moments.mean,
        films[1].moments.mean,
        all_ggx,
        (films[0].moments.standard_error, films[1].moments.standard_error),
        tuple(spheres),
        comparison.options.tolerance,
        comparison.seconds,
        f"Cycles, Blender {bpy.app.version_string}",
    )
