# SPDX-License-Identifier: GPL-3.0-or-later
"""The interface of lobes.

A lobe is made for the `wo` of n points, and returns values, samples and densities of directions `wi`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np


class Lobe(ABC):
    """One way in which a surface scatters light; see the folder's docstring.

    `delta`: it sends light into single directions, has density inf and evaluates to nothing. `diffuse`: rays that it sends out are
    diffuse ones to what only some kinds of rays meet, else glossy ones (scene/rays.py).
    """

    delta: bool = False
    diffuse: bool = False

    @property
    def estimate(self) -> np.ndarray | float:
        """Roughly its albedo before its colour, () or (n,): by it a lobe is picked among several."""
        return 1.0

    @abstractmethod
    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the value f |cos theta_i|, (3, n), and the density of `sample`, (n,).

        The density is per steradian of `wi`.
        """

    @abstractmethod
    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the direction wi (3, n), its weight f |cos| / pdf (3, n) and its pdf (n,).

        The pdf is 0 where the sample is rejected.
        """

    def widening(self, wi: np.ndarray) -> np.ndarray:
        """Return the factor (n,) by which a delta lobe widens a solid angle from wo to `wi`.

        For reflection it is 1.
        """
        return np.ones(wi.shape[1])

    def reflects(self, wi: np.ndarray) -> np.ndarray:
        """Return whether light from `wi` (3, n) arrives on the side of the lobe's normal.

        The result is (n,) bool.
        """
        return wi[2] > 0.0

    @abstractmethod
    def part(self, index: np.ndarray) -> Lobe:
        """Return the same lobe at fewer points."""


class DeltaLobe(Lobe):
    """A lobe of single directions."""

    delta = True

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return nothing, twice: no given direction is one of the lobe's."""
        zero = np.zeros(wi.shape[1])
        return to_rgb(zero), zero


class Wrapper(Lobe):
    """A lobe that does something to another: what a subclass does not say is the other's own."""

    def __init__(self, lobe: Lobe) -> None:
        self._lobe = lobe
        self.delta, self.diffuse = lobe.delta, lobe.diffuse

    @property
    def estimate(self) -> np.ndarray | float:
        """The wrapped lobe's own."""
        return self._lobe.estimate

    def widening(self, wi: np.ndarray) -> np.ndarray:
        """Return the wrapped lobe's own, (n,)."""
        return self._lobe.widening(wi)


def to_rgb(value: np.ndarray) -> np.ndarray:
    """Return `value` (n,) as the grey colour (3, n).

    Nothing is copied, and the result is read-only.
    """
    return np.broadcast_to(value, (3, value.shape[0]))
