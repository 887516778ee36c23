# SPDX-License-Identifier: GPL-3.0-or-later
"""All that a comparison found."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..blender_versions import Release
from ..film.regions import Regions
from ..scene.findings import Finding
from ..settings.comparison import CompareOptions
from ..verdict.causes import Explanation
from ..verdict.passes import PassVerdict
from ..verdict.verdict import Verdict
from .catchers import CatcherPixels
from .interim import BoundAt
from .parts import NO_CHOICE, PassChoice
from .run import Stop
from .sides import Side


@dataclass(frozen=True)
class Comparison:
    """All results of a comparison of the scene named `scene`.

    `excluded` (height, width) marks pixels with non-finite samples on either side, `left_out` those whose paths meet a material that is not
    known to the reference; `unknown` says of each of these materials, by name, what is not simulated. `explanation` is there where regions
    differ and causes were sought. `stopped` says why sampling ended. `seconds` counts everything, `pilot_seconds` the timed calls and the
    first look alone, `round_seconds` what one more replicate of both sides takes, of all that is open; `started` is ISO 8601 in UTC;
    `blender` is the release that exported the scene. `history` has the bound at each look. `divisor` says how many times narrower and lower
    the images are than the scene asks for. `caustics` (K,) is the part of each region's light that arrives by caustics, at most, where a
    scouting pass was made. `findings` are those of the scene check, where the caller made one. `passes` is what is claimed of light passes,
    where they were compared. `passive`: the `unknown` materials only send on light, so that pixels that show them are left out and the others
    are judged with room for it. `pass_choice`: which light passes the caller chose. `caught`: the pixels among `left_out` that show shadow
    catchers.
    """

    scene: str
    options: CompareOptions
    reference: Side
    candidate: Side
    regions: Regions
    excluded: np.ndarray
    verdict: Verdict
    explanation: Explanation | None
    stopped: Stop
    started: str
    seconds: float
    pilot_seconds: float
    round_seconds: float
    versions: dict[str, str]
    left_out: np.ndarray
    unknown: dict[str, str]
    blender: Release | None
    history: tuple[BoundAt, ...]
    divisor: int
    caustics: np.ndarray | None
    findings: tuple[Finding, ...] = ()
    passes: PassVerdict | None = None
    passive: bool = False
    pass_choice: PassChoice = NO_CHOICE
    caught: CatcherPixels | None = None
