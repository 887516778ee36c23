# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure: radiosity and irradiance caching in a diffuse box.

They stand beside path tracing, with the bias of each.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from markupsafe import Markup

from ..film.moments import Moments
from ..film.pictures import middle_exposure, srgb8
from ..pages.formats import format_percent
from ..report.pixels import write_shot
from ..sampling.streams import COUNTED
from ..settings.reference import Options
from ..wavefront.render import ReferenceRenderer
from . import captions
from .box import average_pixels, find_patch, find_plain_pixels, look, make_patches, make_scene
from .figure import Figure, Words, show_words
from .irradiance_cache import Gather, interpolate_indirect
from .radiosity import solve_radiosity

GRIDS, FINEST = (4, 8, 12), 8
ACCURACIES = (0.5, 0.25, 0.1)
SAMPLES, REPLICATES = 32, 8


def trace_box(seed: int, samples: int = SAMPLES, replicates: int = REPLICATES) -> Moments:
    """The box by path tracing: moments over independent replicates of the picture."""
    renderer = ReferenceRenderer(make_scene(), Options(seed=seed))
    moments: Moments | None = None
    for k in range(replicates):
        picture = renderer.render(COUNTED.number(k), samples).radiance
        moments = Moments.empty(picture.shape) if moments is None else moments
        moments.add(picture)
    assert moments is not None
    return moments


def solve_box(count: int) -> np.ndarray:
    """The picture by radiosity alone, each patch of one colour."""
    points, wall = look()
    return average_pixels(solve_radiosity(make_patches(count))[find_patch(points, wall, count)])


class GatheredBox:
    """Two pictures from the light of the finest patches.

    One is made by a last gathering at every point, the other by interpolation of it.
    """

    def __init__(self, count: int = FINEST) -> None:
        patches = make_patches(count)
        self._points, wall = look()
        at = find_patch(self._points, wall, count)
        self._albedos, self._emitted, self._normals = patches.albedos[at], patches.emitted[at], patches.normals[at]
        self._gather = Gather(patches, solve_radiosity(patches))
        self._direct = self._gather.direct(self._points, self._normals)

    def exact(self) -> np.ndarray:
        """Every point gathers for itself."""
        return self._picture(self._gather.indirect(self._points, self._normals))

    def cached(self, accuracy: float) -> tuple[np.ndarray, int]:
        """Irradiance caching, and how many records it made."""
        found, records = interpolate_indirect(self._gather, self._points, self._normals, accuracy)
        return self._picture(found), records

    def _picture(self, indirect: np.ndarray) -> np.ndarray:
        return average_pixels(self._emitted + self._albedos * (self._direct + indirect))


def compare_pictures(picture: np.ndarray, truth: np.ndarray) -> tuple[float, float]:
    """The relative difference of the mean, and that of a pixel, root mean square.

    Both are over the mean of `truth`. Pixels on edges and on the lamp are left out.
    """
    plain = find_plain_pixels()
    gap = (picture - truth)[plain] / truth[plain].mean()
    return float(gap.mean()), float(np.sqrt(np.square(gap).mean()))


def illustrate_caches(seed: int) -> Figure:
    """Pictures of path tracing, radiosity and caching, and a table of their differences."""
    start = time.perf_counter()
    traced = trace_box(seed)
    error = float(np.sqrt(np.square(traced.standard_error).mean()) / traced.mean.mean())
    rows = [_row(captions.TRACED, time.perf_counter() - start, traced.mean, traced.mean)]
    shown = [(captions.TRACED, traced.mean)]
    for count in GRIDS:
        start = time.perf_counter()
        picture = solve_box(count)
        name = Words(f"Radiosity, {6 * count**2} patches", f"Radiosité, {6 * count**2} facettes")
        rows.append(_row(name, time.perf_counter() - start, picture, traced.mean))
        if count == GRIDS[1]:
            shown.append((name, picture))
    start = time.perf_counter()
    gathered = GatheredBox()
    exact = gathered.exact()
    rows.append(_row(captions.GATHERED, time.perf_counter() - start, exact, traced.mean))
    for accuracy in ACCURACIES:
        start = time.perf_counter()
        picture, records = gathered.cached(accuracy)
        bias, spread = compare_pictures(picture, exact)
        name = Words(f"Irradiance cache, a = {accuracy:g}", f"Cache d'éclairement, a = {accuracy:g}")
        row = _row(name, time.perf_counter() - start, picture, traced.mean)
        rows.append({**row, "records": records, "bias": bias, "bias_of_a_pixel": spread})
        if accuracy == ACCURACIES[0]:
            shown.append((name, picture))
    exposure = middle_exposure(np.minimum(traced.mean, 0.5))
    pictures = Markup("").join(
        Markup('<figure><img src="{}" alt="{} / {}"><figcaption>{}</figcaption></figure>').format(
            write_shot(srgb8(image, exposure)), title.english, title.french, show_words(title)
        )
        for title, image in shown
    )
    plain = [{**row, "by": row["by"].english} for row in rows]
    numbers = {"samples": SAMPLES, "replicates": REPLICATES, "noise_of_a_pixel": error, "seed": seed, "rows": plain}
    return Figure(Markup('<div class="shots small">{}</div>').format(pictures) + _table(rows), numbers)


def _row(name: Words, seconds: float, picture: np.ndarray, truth: np.ndarray) -> dict[str, Any]:
    mean, spread = compare_pictures(picture, truth)
    return {"by": name, "seconds": seconds, "mean": mean, "pixel": spread, "records": None, "bias": None}


def _percent(value: float) -> str:
    return f"{100.0 * value:.2g} %"


def _table(rows: list[dict[str, Any]]) -> Markup:
    heads = Markup("").join(
        Markup('<th class="{}">{}</th>').format("number" if k else "", show_words(words))
        for k, words in enumerate(captions.CACHE_HEADS)
    )
    body = Markup("").join(
        Markup("<tr><td>{}</td>" + '<td class="number">{}</td>' * 5 + "</tr>").format(
            show_words(row["by"]),
            f"{row['seconds']:.2f} s",
            format_percent(row["mean"]) if k else "",
            _percent(row["pixel"]) if k else "",
            row["records"] or "",
            "" if row["bias"] is None else f"{format_percent(row['bias'])}, {_percent(row['bias_of_a_pixel'])}",
        )
        for k, row in enumerate(rows)
    )
    return Markup('<div class="scroll"><table><tr>{}</tr>{}</table></div>').format(heads, body)
