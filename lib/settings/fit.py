# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of `etalon fit`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from .common import Run
from .declaration import option, required
from .units import FilePath, Share, Unit, Whole


@dataclass(frozen=True, kw_only=True)
class FitSettings(Run):
    """How the noise of a measured BRDF is taken, and how a sphere is rendered."""

    TITLE: ClassVar[str] = ""

    noise: float | None = option(
        None,
        Share(),
        "relative standard error of a measured value",
        absent="MERL: from the file's own scatter; RGL: 1%; renders: 0.01%, besides that of the replicates",
    )
    object: str | None = option(
        None, Unit("NAME"), "in a .blend file: the sphere", absent="the only mesh that is rendered"
    )
    samples: int = option(64, Whole("N", 1), "in a .blend file: samples per pixel and replicate", advanced=True)
    replicates: int = option(16, Whole("N", 8), "in a .blend file: independent renders by Cycles", advanced=True)


@dataclass(frozen=True, kw_only=True)
class FitOptions(FitSettings):
    """The same with the file."""

    TITLE: ClassVar[str] = ""

    file: Path = required(
        FilePath("FILE"), "a MERL .binary or RGL .bsdf file, or a .blend file with a sphere", positional=True
    )
