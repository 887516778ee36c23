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
# The least and the largest bound of a small step. Kelemen et al. (2002, section 4) go up to 1 / 64; a chain that must cross
# a raster of few pixels needs longer ones, and one that lies in a narrow peak still gets its short ones.
LEAST_STEP, LARGEST_STEP = 1.0 / 1024.0, 1.0 / 8.0


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

    def take_over(self, chain: np.ndarray, other: ChainUniforms, chosen: np.ndarray) -> None:
        """Move the chains `chain` (n,) to where the proposals `chosen` (n,) of `other` are.

        Pairs that only one of the two has been asked for are uniform in the other.
        """
        for dimension in other._proposed.keys() - self._state.keys():
            self._state[dimension] = self._generator.random((2, self._count))
        for dimension, state in self._state.items():
            proposed = other._proposed.get(dimension)
            new = self._generator.random((2, chain.size)) if proposed is None else np.take(proposed, chosen, axis=1)
            state[:, chain] = new

    @property
    def large(self) -> np.ndarray:
        """Which chains propose an independent sample, (n,) bool."""
        return self._large

    def place(self) -> tuple[np.ndarray, np.ndarray]:
        """Raster points (n,) of the proposals, in pixels, x to the right and y up."""
        x, y = self._proposed[PIXEL] * self._raster
        return x, y

    def _mutated(self, state: np.ndarray) -> np.ndarray:
        """Return proposals for a pair, (2, n).

        They are uniform, or moved by a uniform step around the end. Its bound is LARGEST_STEP^(1 - u) LEAST_STEP^u, for each
        pair with another uniform u, so that some pairs move far while others stay near.
        """
        uniform = self._generator.random(state.shape)
        bound = LARGEST_STEP * (LEAST_STEP / LARGEST_STEP) ** self._generator.random(self._count)
        small = np.mod(state + bound * (2.0 * uniform - 1.0), 1.0)
        small[small == 1.0] = 0.0  # what is just below 0 rounds to 1
        return np.where(self._large, uniform, small)
