# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of `etalon probe`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from .declaration import option, required
from .reference import Options
from .units import Flag, Pixel, Seconds, Whole, WholeRange


@dataclass(frozen=True, kw_only=True)
class ProbeOptions(Options):
    """The settings of `etalon probe`.

    They are which pixels, how long, and which bounces are told apart.
    """

    TITLE: ClassVar[str] = ""

    pixel: tuple[int, int] = required(
        Pixel("X Y"), "column and row of the pixel, counted from the upper left corner as in the report"
    )
    block: int = option(1, Whole("N", 1), "read the mean of N x N pixels, of which the pixel is the upper left one")
    time: float = option(20.0, Seconds(), "time budget, such as 20s or 2m")
    bounces: tuple[int, int] | None = option(
        None,
        WholeRange(),
        "bounces that are told apart; Cycles renders once for each",
        absent="0..4, or as many as the scene has",
    )
    lights: bool = option(True, Flag(), "tell the light of each lamp, emitting object and the world apart")
