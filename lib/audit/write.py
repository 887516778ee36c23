# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder an audit leaves: audit.html, audit.json, the neutral image, and a signed map for each setting, as PNG."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from ..film.pictures import middle_exposure, signed8, srgb8, write_png
from ..report.words import percent, seconds
from .document import ORIGINS, SAME, WORDS, bias, document, map_name, ratio
from .findings import Audit

_REPORT = Path(__file__).parent.parent / "report"  # its style sheet is this page's too
NEUTRAL = "neutral.png"
# Maps are drawn up to this many tolerances.
LIMIT = 5


def write_audit(audit: Audit, folder: Path, command: str = "") -> dict[str, Any]:
    """Write all files into `folder`, which must be there; returns what audit.json holds."""
    figures = document(audit, command)
    text = json.dumps(figures, indent=1, ensure_ascii=False, allow_nan=False)
    (folder / "audit.json").write_text(text + "\n", encoding="utf-8")
    limit = LIMIT * audit.options.tolerance
    names = []
    if audit.rounds:
        write_png(folder / NEUTRAL, srgb8(audit.neutral, middle_exposure(audit.neutral)))
        names.append(NEUTRAL)
    for finding in audit.findings:
        names.append(map_name(finding.setting.key))
        write_png(folder / names[-1], signed8(finding.map, limit))
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
        pictures={name: base64.b64encode((folder / name).read_bytes()).decode() for name in names},
    )
    (folder / "audit.html").write_text(page, encoding="utf-8")
    return figures
