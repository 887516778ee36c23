# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder that an audit writes.

It holds audit.html, audit.json, the neutral image, and a signed map for each setting, as PNG.
"""

from __future__ import annotations

import base64
import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from ..files.plain_data import write_json
from ..film.pictures import middle_exposure, signed8, srgb8, write_png
from ..pages import render_page
from ..report.page import averaged
from .document import ORIGINS, SAME, WORDS, bias, document, map_name, ratio
from .findings import Audit
from .summary import summarize

NEUTRAL = "neutral.png"
# Maps are drawn up to this many tolerances.
LIMIT = 5
# Pixels of a picture in the page; the files beside it hold all.
SHOWN = 400 * 400


def write_audit(audit: Audit, folder: Path, command: str = "") -> dict[str, Any]:
    """Write all files into `folder`, which must be there; returns what audit.json holds."""
    figures = document(audit, command)
    write_json(folder / "audit.json", figures)
    limit = LIMIT * audit.options.tolerance
    pictures = {map_name(finding.setting.key): signed8(finding.map, limit) for finding in audit.findings}
    if audit.rounds:
        pictures[NEUTRAL] = srgb8(audit.neutral, middle_exposure(audit.neutral))
    for name, pixels in pictures.items():
        write_png(folder / name, pixels)
    values = {
        "figures": figures,
        "summary": summarize(figures),
        "limit": limit,
        "words": {outcome.value: word for outcome, word in WORDS.items()},
        "origins": ORIGINS,
        "same": SAME,
        "pictures": {name: _small(pixels, folder / name) for name, pixels in pictures.items()},
    }
    page = render_page(Path(__file__).with_name("audit.html"), values, {"bias": bias, "ratio": ratio})
    (folder / "audit.html").write_text(page, encoding="utf-8")
    return figures


def old_pictures(folder: Path) -> list[str]:
    """The pictures of the audit whose figures are in `folder`.

    Which there are depends on the settings.
    """
    try:
        figures = json.loads((folder / "audit.json").read_text(encoding="utf-8"))
        return [NEUTRAL, *(map_name(str(setting["key"])) for setting in figures["settings"])]
    except (OSError, ValueError, LookupError, TypeError):  # none, or of something else
        return []


def _small(pixels: np.ndarray, path: Path) -> str:
    """A picture (height, width, 3) for the page: no more pixels than it shows, PNG in base64.

    The file `path` gets the whole picture.
    """
    step = math.ceil(math.sqrt(max(pixels.shape[0] * pixels.shape[1] / SHOWN, 1.0)))
    if step == 1:
        return base64.b64encode(path.read_bytes()).decode()
    small = path.with_name(f".small-{path.name}")
    write_png(small, np.rint(averaged(pixels.astype(float), step)).astype(np.uint8))
    found = small.read_bytes()
    small.unlink()
    return base64.b64encode(found).decode()
