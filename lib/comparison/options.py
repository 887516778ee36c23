# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user asks of a comparison."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import EtalonError


@dataclass(frozen=True)
class CompareOptions:
    """What the user asks of a comparison.

    tolerance: the relative difference that counts as none. confidence: the probability that no claim on any region is false.
    time: seconds for everything, None for no limit. samples: per pixel and replicate, for both sides or (reference,
    candidate); None: chosen by a pilot. replicates: the most on each side, None for no limit. seed: of the whole, for the record.
    Sampling ends when all is decided or at the first limit. Raises EtalonError for values out of range.
    """

    tolerance: float = 0.01
    confidence: float = 0.99
    time: float | None = 120.0
    samples: int | tuple[int, int] | None = None
    replicates: int | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        pair = self.samples if isinstance(self.samples, tuple) else (self.samples, self.samples)
        if not 0 < self.tolerance < 1:
            raise EtalonError(f"tolerance is {self.tolerance}; give a share between 0 and 1, 0.01 for 1 %")
        if not 0.5 <= self.confidence < 1:
            raise EtalonError(f"confidence is {self.confidence}; give at least 0.5 and less than 1")
        if self.time is not None and not self.time > 0:
            raise EtalonError(f"time is {self.time} s; give more than 0")
        if any(s is not None and s < 1 for s in pair):
            raise EtalonError(f"samples is {self.samples}; give at least 1")
        if self.replicates is not None and self.replicates < 1:
            raise EtalonError(f"replicates is {self.replicates}; give at least 2 to judge by, 8 or more to judge well")
        if self.time is None and (self.samples is None or self.replicates is None):
            raise EtalonError(
                "without a time limit nothing ends the comparison; give samples and replicates, or a time"
            )
