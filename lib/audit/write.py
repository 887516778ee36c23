# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder an audit leaves: audit.html, audit.json, the neutral image, and a signed map for each setting, as PNG."""

from __future__ import annotations

import base64
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from ..film.pictures import middle_exposure, signed8, srgb8, write_png
from ..report.words import percent, seconds
from ..report.write import averaged
from .document import ORIGINS, SAME, WORDS, bias, document, map_name, ratio
from .findings import Audit

_REPORT = Path(__file__).parent.parent / "report"  # its style sheet is this page's too
NEUTRAL = "neutral.png"
# Maps are drawn up to this many tolerances.
LIMIT = 5
# Pixels of a picture in the page; the files beside it hold all.
SHOWN = 400 * 400


def write_audit(audit: Audit, folder: Path, command: str = "") -> dict[str, Any]:
    """Write all files into `folder`, which must be there; returns what audit.json holds."""
    figures = document(audit, command)
    text = json.dumps(figures, indent=1, ensure_ascii=False, allow_nan=False)
    (folder / "audit.json").write_text(text + "\n", encoding="utf-8")
    limit = LIMIT * audit.options.tolerance
    pictures = {map_name(finding.setting.key): signed8(finding.map, limit) for finding in audit.findings}
    if audit.rounds:
        pictures[NEUTRAL] = srgb8(audit.neutral, middle_exposure(audit.neutral))
    for name, pixels in pictures.items():
        write_png(folder / name, pixels)
    environment = Environment(
        loader=FileSystemLoader([Path(__file__).parent, _REPORT]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(percent=percent, seconds=seconds, bias=bias, ratio=ratio)
    page = environment.get_template("audit.html").render(
        figures=figures,
        limit=limit,
        words={outcome.value: word for outcome, word in WORDS.items()},
        origins=ORIGINS,
        same=SAME,
        pictures={name: _small(pixels, folder / name) for name, pixels in pictures.items()},
    )
    (folder / "audit.html").write_text(page, encoding="utf-8")
    return figures


def _small(pixels: np.ndarray, path: Path) -> str:
    """A picture (height, width, 3) as the page carries it: no more pixels than it shows, PNG in base64; `path` holds the whole of it."""
    step = math.ceil(math.sqrt(max(pixels.shape[0] * pixels.shape[1] / SHOWN, 1.0)))
    if step == 1:
        return base64.b64encode(path.read_bytes()).decode()
    small = path.with_name(f".small-{path.name}")
    write_png(small, np.rint(averaged(pixels.astype(float), step)).astype(np.uint8))
    found = small.read_bytes()
    small.unlink()
    return base64.b64encode(found).decode()
