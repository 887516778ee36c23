# SPDX-License-Identifier: GPL-3.0-or-later
"""Which of several lights to sample."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..sampling.tables import Distribution1D
from .light import LightSampler


class LightSelection:
    """One light for each point, with probability proportional to its power. With a single light there is nothing to do."""

    def __init__(self, samplers: Sequence[LightSampler]) -> None:
        if not samplers:
            raise ValueError("there is no light to select")
        self.samplers = tuple(samplers)
        self._choice = Distribution1D(np.array([sampler.power for sampler in samplers]))

    def choose(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Index (n,) into `samplers`, its probability (n,), and what is left of the uniform `u`, uniform again (n,)."""
        index, rest = self._choice.sample(u)
        return index, self.probability(index), rest

    def probability(self, index: np.ndarray) -> np.ndarray:
        """Probability with which `choose` gives `index`, (n,)."""
        return np.take(self._choice.probability, index)
