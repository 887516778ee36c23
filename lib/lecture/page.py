# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes the figures and writes the page."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path

from markupsafe import Markup

from ..files.atomic import replace_file
from ..files.plain_data import make_plain
from ..pages import render_page
from ..progress import NO_PROGRESS, Progress
from . import captions
from .caches import illustrate_caches
from .densities import illustrate_densities
from .facets import illustrate_facets
from .figure import Figure
from .illustrations import illustrate_missing
from .inversions import illustrate_inversions
from .masking import illustrate_masking
from .slips import illustrate_slips
from .uniform import illustrate_uniform

Makers = Mapping[str, Callable[[int], Figure]]
"""For each figure by its name the function that makes it from the seed of its random numbers."""


FIGURES: Makers = {
    "densities": illustrate_densities,
    "facets": illustrate_facets,
    "uniform": illustrate_uniform,
    "inversions": illustrate_inversions,
    "slips": illustrate_slips,
    "illustrations": lambda seed: illustrate_missing("Blender"),
    "caches": illustrate_caches,
    "masking": illustrate_masking,
}
"""All figures, without Blender: whoever has it replaces `illustrations`."""


def make_figures(
    names: tuple[str, ...], seed: int, progress: Progress = NO_PROGRESS, makers: Makers = FIGURES
) -> dict[str, Figure]:
    """Make the figures of these names, in their order; raises Cancelled."""
    figures = {}
    for k, name in enumerate(names):
        progress.check()
        figures[name] = makers[name](seed)
        progress.report((k + 1) / len(names))
    return figures


def make_page(figures: dict[str, Figure], seed: int) -> str:
    """The whole page as HTML, which loads nothing.

    It is complete without its script, which only makes the inversions interactive.
    """
    rows = [
        {
            "name": name,
            "caption": captions.CAPTIONS[name],
            "drawing": figure.drawing,
            "json": _embed(figure),
            "command": f"etalon illustrate --only {name} --seed {seed}",
        }
        for name, figure in figures.items()
    ]
    values = {"figures": rows, "title": captions.TITLE, "introduction": captions.INTRODUCTION}
    labels = {"remade": captions.REMADE, "held": captions.HELD}
    return render_page(Path(__file__).with_name("lecture.html"), {**values, **labels})


def illustrate(
    path: Path, names: tuple[str, ...], seed: int, progress: Progress = NO_PROGRESS, makers: Makers = FIGURES
) -> dict[str, Figure]:
    """Compute the figures and write the page to `path`, whole or not at all.

    Raises Cancelled when asked to stop, and EtalonError where `path` cannot be written, before anything is computed.
    """
    with replace_file(path) as beside:
        figures = make_figures(names, seed, progress, makers)
        beside.write_text(make_page(figures, seed), encoding="utf-8")
    return figures


def _embed(figure: Figure) -> Markup:
    """The numbers as JSON that cannot end the element that it stands in."""
    text = json.dumps(make_plain(figure.numbers), ensure_ascii=False, allow_nan=False)
    return Markup(text.replace("<", "\\u003c"))
