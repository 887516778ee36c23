# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of `etalon versions`, one file with its pictures in it.

versions.json lies beside it.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..files.ownership import temporary_folder
from ..files.plain_data import write_json
from ..film.pictures import middle_exposure, signed8, srgb8, write_png
from ..pages import render_page
from ..pages.formats import format_bound
from ..report.page import averaged
from .measure import Measured
from .words import WORDS, describe

# Maps are drawn up to this many tolerances.
LIMIT = 5
# Pixels of a picture in the page.
SHOWN = 400 * 400


def pictures_of(measured: Measured, tolerance: float) -> dict[str, str]:
    """The pictures of a scene, PNG in base64.

    They are the image of each version by its label, and the map of each change by 'FROM to TO'.
    """
    exposure = middle_exposure(measured.rounds.images[0])
    shown = {
        label: srgb8(image, exposure) for label, image in zip(measured.labels, measured.rounds.images, strict=True)
    }
    for change in measured.changes:
        title = f"{measured.labels[change.first]} to {measured.labels[change.second]}"
        shown[title] = signed8(change.map, LIMIT * tolerance)
    return {title: _embed(pixels) for title, pixels in shown.items()}


def _embed(pixels: np.ndarray) -> str:
    """A picture (height, width, 3) of no more pixels than are shown, as PNG in base64."""
    step = math.ceil(math.sqrt(max(pixels.shape[0] * pixels.shape[1] / SHOWN, 1.0)))
    if step > 1:
        pixels = np.rint(averaged(pixels.astype(float), step)).astype(np.uint8)
    with temporary_folder() as folder:
        write_png(folder / "picture.png", pixels)
        return base64.b64encode((folder / "picture.png").read_bytes()).decode()


def write_versions(figures: dict[str, Any], pictures: Mapping[str, Mapping[str, str]], folder: Path) -> None:
    """Write versions.json and versions.html into `folder`; `pictures` are those of each scene."""
    write_json(folder / "versions.json", figures)
    values = {"figures": figures, "pictures": pictures, "words": WORDS, "limit": LIMIT * figures["tolerance"]}
    filters = {"change": describe, "bound": lambda bound: "no bound" if bound is None else format_bound(bound)}
    page = render_page(Path(__file__).with_name("versions.html"), values, filters)
    (folder / "versions.html").write_text(page, encoding="utf-8")
