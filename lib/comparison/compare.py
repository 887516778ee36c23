# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole comparison in one function: two renderers of one scene, their films, and the verdict on them."""

from __future__ import annotations

import platform
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np
import scipy

from ... import __version__
from ..departures.effects import Alternatives
from ..errors import EtalonError
from ..film.film import nonfinite_pixels
from ..film.regions import Coverage, Regions, image_regions
from ..scene.scene import Scene
from ..verdict.attribution import ATTRIBUTION_SHARE
from ..verdict.causes import Explanation
from ..verdict.outcome import Outcome
from ..verdict.sequential import SequentialTest, next_look
from ..verdict.verdict import Verdict, conclude
from .focus import focus
from .meter import Meter
from .options import CompareOptions
from .pilot import pilot
from .search import Search, conclude_causes
from .sides import Renderer, Side

__all__ = ["CompareOptions", "Comparison", "Renderer", "Side", "compare", "versions"]

# What is set aside of the time to find out why regions differ, where there are departures to ask.
ASIDE_SHARE = 0.15


@dataclass(frozen=True)
class Comparison:
    """All that came of a comparison of the scene named `scene`.

    `excluded` (height, width) marks pixels with non-finite samples on either side, `left_out` those whose paths meet a material that is
    not known to the reference; `unknown` says of each of these materials, by name, what is not simulated. `explanation` is there
    where regions differ and causes were sought. `stopped` is 'decided', 'time', 'replicates' or 'cancelled'. `seconds` counts
    everything, `pilot_seconds` the pilot alone, `round_seconds` what one more replicate of both sides takes, of all that
    is open; `started` is ISO 8601 in UTC.
    """

    scene: str
    options: CompareOptions
    reference: Side
    candidate: Side
    regions: Regions
    excluded: np.ndarray
    verdict: Verdict
    explanation: Explanation | None
    stopped: str
    started: str
    seconds: float
    pilot_seconds: float
    round_seconds: float
    versions: dict[str, str]
    left_out: np.ndarray
    unknown: dict[str, str]


def compare(
    scene: Scene,
    reference: Renderer,
    candidate: Renderer,
    coverage: Coverage,
    options: CompareOptions,
    progress: Callable[[float], None] = lambda fraction: None,
    cancelled: Callable[[], bool] = lambda: False,
    among: Alternatives | None = None,
    left_out: np.ndarray | None = None,
) -> Comparison:
    """Render `scene` with both renderers in turns until every region is decided, or a limit of `options` is reached.

    `coverage` maps a kind of region ('material', 'object') to its (name, weights (height, width)) pairs. Once the open regions fill
    no more than a part of the image, only that is sampled on. `progress` is told the share of the time (or of the replicates)
    that is spent. Cancelling keeps what both sides finished; EtalonError is raised if that is nothing, or if the renderers disagree on
    the size of the image. Where regions differ, the causes are sought `among` departures, in a time that is set aside for it,
    and sampling goes on until they are found or ruled out. Pixels (height, width) that are `left_out` belong to no region, nor
    do those whose paths meet a material that is not known; EtalonError is raised where none is left.
    """
    started = datetime.now(UTC).isoformat(timespec="seconds")
    asked = among is not None and bool(among.departures)
    size = (scene.camera.height, scene.camera.width)
    meter = Meter(options, progress, cancelled, ASIDE_SHARE if asked else 0.0)
    samples = _both(options.samples) or pilot(reference, candidate, options, meter)
    pilot_seconds = meter.elapsed
    unknown = {material.name: material.unknown for material in scene.materials if material.unknown}
    regions = image_regions(*size, coverage, left_out=None if left_out is None else _compared(scene, left_out))
    left_out = np.zeros(size, bool) if left_out is None else left_out
    del coverage  # as large as the regions made of it
    sides = tuple(Side.empty(r, regions, s) for r, s in zip((reference, candidate), samples, strict=True))
    excluded = np.zeros(regions.shape, bool)
    held_back = ATTRIBUTION_SHARE if asked else 0.0
    test = SequentialTest(len(regions), options.tolerance, options.confidence, held_back)
    search = Search(among, test, meter, regions) if asked else None
    stopped, wanted, windows = "", None, None
    while not stopped:
        for side, renderer in zip(sides, (reference, candidate), strict=True):
            rendering = meter.render(renderer, side.replicates, side.film.samples, windows)
            if rendering is None:
                break
            excluded = excluded | nonfinite_pixels(rendering, regions.shape)
            if rendering.unknown is not None:
                left_out = _compared(scene, left_out | (rendering.unknown > 0))
            for one in sides:
                one.exclude(excluded | left_out, wanted)
            side.add(rendering, wanted)
            del rendering  # not while the other side renders
        n = sides[1].replicates
        if n == 0:
            raise EtalonError(f"{scene.name}: cancelled before both sides had an image; there is nothing to compare")
        due = next_look(n - 1)
        # How fast parts come depends on what was seen elsewhere, and so does the time left once that set aside is overdrawn: then, time
        # decides neither when to look nor what a look may spend.
        timely = windows is None and not meter.is_overdrawn
        stopped = meter.why_stop(n, n + 1 if timely else due if n < due else next_look(n))
        last = stopped == "replicates" or bool(stopped and timely)
        if n != due and not last:
            continue
        test.look(sides[0].regions.moments, sides[1].regions.moments, last)
        open_ = test.undecided
        if search is not None:
            if search.look(sides, excluded | left_out, last):
                open_ = test.outcomes != Outcome.EQUIVALENT
            elif search.complete:
                open_ = np.zeros_like(open_)
        open_ = open_ & (sides[0].regions.sizes > 0)
        if not open_.any():
            stopped = stopped or "decided"
        elif windows is not None or focus(regions, open_) is not None:
            wanted = open_ if wanted is None else wanted & open_
            windows = focus(regions, wanted)
            meter.mark(n)
    nonfinite = {side.name: int((side.film.nonfinite > 0).sum()) for side in sides}
    explanation = None if among is None else conclude_causes(search, test, sides)
    verdict = conclude(test, sides[0].regions, sides[1].regions, nonfinite, explanation)
    return Comparison(
        scene=scene.name,
        options=options,
        reference=sides[0],
        candidate=sides[1],
        regions=regions,
        excluded=excluded,
        verdict=verdict,
        explanation=explanation,
        stopped=stopped,
        started=started,
        seconds=meter.elapsed,
        pilot_seconds=pilot_seconds,
        round_seconds=meter.round_seconds,
        versions=versions(),
        left_out=left_out,
        unknown=unknown,
    )


def _compared(scene: Scene, left_out: np.ndarray) -> np.ndarray:
    """`left_out`, if it leaves anything to compare; raises EtalonError otherwise."""
    if left_out.all():
        raise EtalonError(
            f"{scene.name}: light from materials that are not simulated reaches every pixel; simplify them, or lower the bounces"
        )
    return left_out


def _both(samples: int | tuple[int, int] | None) -> tuple[int, int] | None:
    return (samples, samples) if isinstance(samples, int) else samples


def versions() -> dict[str, str]:
    """What a report says about the software it was made with."""
    return {
        "etalon": __version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "system": platform.platform(),
    }
