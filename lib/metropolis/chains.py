# SPDX-License-Identifier: GPL-3.0-or-later
"""The random numbers of many Markov chains, and their mutations.

The path tracer asks for them as it asks a sampler.
"""

from __future__ import annotations

import numpy as np

from ..sampling.sobol import RandomTile
from ..sampling.streams import PIXEL

# The chance of a large step, which draws all numbers anew.
LARGE = 0.3
# The least and the largest size of a small step (Kelemen et al. 2002, section 4).
LEAST_STEP, LARGEST_STEP = 1.0 / 1024.0, 1.0 / 64.0


class ChainUniforms(RandomTile):
    """Pairs of uniforms for `count` chains over an image of `width` x `height` pixels.

    Chains stand in place of pixels.

    The pair of the pixel is scaled to the whole raster. A pair that no path has asked for yet is drawn when one does:
    until then it is uniform, whatever the chain does.
    """

    def __init__(self, generator: np.random.Generator, count: int, width: int, height: int) -> None:
        super().__init__(generator)
        self._count, self._raster = count, np.array([[width], [height]], float)
        self._state: dict[int, np.ndarray] = {}
        self._proposed: dict[int, np.ndarray] = {}
        self._large = np.ones(count, bool)

    def pair(self, dimension: int, pixel: np.ndarray, sample: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The proposed pair for the chains `pixel` (n,), float64 (n,)."""
        if dimension not in self._proposed:
            self._state[dimension] = self._generator.random((2, self._count))
            self._proposed[dimension] = self._mutated(self._state[dimension])
        first, second = np.take(self._proposed[dimension], pixel, axis=1)
        if dimension == PIXEL:
            return first * self._raster[0], second * self._raster[1]
        return first, second

    def propose(self) -> None:
        """Mutate all chains: by a large step with the chance LARGE, else by a small one."""
        self._large = self._generator.random(self._count) < LARGE
        self._proposed = {dimension: self._mutated(state) for dimension, state in self._state.items()}

    def accept(self, accepted: np.ndarray) -> None:
        """Make the proposals the state of the chains that are `accepted`, (n,) bool."""
        for dimension, state in self._state.items():
            np.copyto(state, self._proposed[dimension], where=accepted)

    def start(self, chosen: np.ndarray) -> ChainUniforms:
        """Chains that begin where the proposals `chosen` (n,) are."""
        chains = ChainUniforms(self._generator, chosen.size, 1, 1)
        chains._raster = self._raster
        chains._state = {k: np.take(a, chosen, axis=1) for k, a in self._proposed.items()}
        return chains

    def place(self) -> tuple[np.ndarray, np.ndarray]:
        """Raster points (n,) of the proposals, in pixels, x to the right and y up."""
        x, y = self._proposed[PIXEL] * self._raster
        return x, y

    def _mutated(self, state: np.ndarray) -> np.ndarray:
        """Return proposals for a pair, (2, n).

        They are uniform, or moved by LARGEST exp(-log(LARGEST / LEAST) u) to either side, around the end.
        """
        generator = self._generator
        sign = np.where(generator.random(state.shape) < 0.5, -1.0, 1.0)
        length = LARGEST_STEP * np.exp(-np.log(LARGEST_STEP / LEAST_STEP) * generator.random(state.shape))
        small = np.mod(state + sign * length, 1.0)
        small[small == 1.0] = 0.0  # what is just below 0 rounds to 1
        return np.where(self._large, generator.random(state.shape), small)
