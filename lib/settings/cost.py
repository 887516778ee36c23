# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of a cost measurement."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ..errors import EtalonError
from .common import Run
from .declaration import option
from .units import FilePath, Flag, Keys, Seconds, Share


@dataclass(frozen=True, kw_only=True)
class CostOptions(Run):
    """What the user asks of `etalon cost` and `etalon.cost`.

    time: seconds for everything. target: the relative error to forecast the time for. verify: put the forecast to the test.
    ways: the keys of the strategies to measure, None for all. out: folder for the results.
    """

    time: float | None = option(
        None,
        Seconds(),
        "time budget, such as 90s or 2m",
        absent="5 minutes; 24 seconds of pilots where a target is given",
    )
    target: float | None = option(
        None, Share("ERROR"), "forecast how long each strategy takes to this relative RMSE, such as 1%"
    )
    verify: bool = option(
        False, Flag(), "then run the cheapest strategy and show the result beside the forecast; needs a target"
    )
    ways: tuple[str, ...] | None = option(
        None, Keys(), "measure only these strategies; cost.json lists their keys", absent="all", advanced=True
    )
    out: Path | None = option(
        None, FilePath("FOLDER"), "folder for cost.html, .json, .csv and plots", absent="etalon-out/SCENE"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.verify and self.target is None:
            raise EtalonError("--verify tests the forecast for one error; name that error with --target")
