# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of an audit of Cycles' settings."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from .common import Run
from .comparison import CompareOptions
from .declaration import again, option
from .units import FilePath, Flag


@dataclass(frozen=True, kw_only=True)
class AuditOptions(CompareOptions, Run):
    """The settings of `etalon audit`.

    all: measure the values that Blender starts with, too. out: folder for the results.
    """

    confidence: float = again(
        CompareOptions, "confidence", help="confidence of all statements on bias together, for all settings and regions"
    )
    time: float | None = again(CompareOptions, "time", help="time budget, such as 90s or 2m")
    samples: int | tuple[int, int] | None = again(
        CompareOptions, "samples", help="samples per pixel in each render", absent="as many as the time allows"
    )
    replicates: int | None = again(CompareOptions, "replicates", help="number of rounds of renders")
    all: bool = option(False, Flag(), "also measure the values that Blender starts with")
    out: Path | None = option(
        None, FilePath("FOLDER"), "folder for audit.html, audit.json and maps", absent="etalon-out/SCENE"
    )
