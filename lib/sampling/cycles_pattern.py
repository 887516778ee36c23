# SPDX-License-Identifier: GPL-3.0-or-later
"""The points at which Cycles samples: a Sobol' sequence that is shuffled and scrambled by hashes of fixed keys.

Burley 2020, with the permutation of Vegdahl 2021. A pixel takes successive points from its own place in one long sequence, with the
same scrambling whatever the seed (kernel/sample/sobol_burley.h, pattern.h: blue noise). So what a few successive points have in
common is the same all over the image, and where it matters, ideal scrambling gives another mean.
"""

from __future__ import annotations

import numpy as np

OCCLUSION, BEVEL = 4, 5
"""Decisions of a step of a path: the rays of ambient occlusion, and the probes of bevels (kernel/types.h)."""

# Dimensions for each step.
_DIMENSIONS_PER_STEP = 16
# The keys of the shuffling and of the scrambling of each coordinate.
_SHUFFLE, _SCRAMBLE = 0xF8ADE99A, (0xE0AAAF76, 0x94964D4E)


def dimension_at(step: int, decision: int) -> int:
    """Return the dimension of a `decision` at a step of the path, from 0."""
    return _DIMENSIONS_PER_STEP * (step + 1) + decision


def branches(place: np.ndarray, samples: int) -> np.ndarray:
    """Return so many successive places in the sequence for each of the uniforms `place` (n,), uint32 (samples, n).

    Where a path branches, its branches take them. The first is a multiple of the largest power of two that divides their
    number, as it is in Cycles.
    """
    first = (place * 2.0**32).astype(np.uint32) & np.uint32(2**32 - (samples & -samples))
    return first + np.arange(samples, dtype=np.uint32)[:, None]


def cycles_pairs(index: np.ndarray, dimension: int) -> np.ndarray:
    """Return the pairs of uniforms in (0, 1), (2, ...), at the places `index`, uint32, of the sequence of a `dimension`."""
    key = np.uint32(_hash(dimension))
    place = _scramble(reverse_bits(index), key ^ np.uint32(_SHUFFLE))
    first = reverse_bits(place)
    second, direction = np.zeros_like(first), 1
    for bit in range(32):
        second ^= (first >> np.uint32(bit) & np.uint32(1)) * np.uint32(direction)
        direction ^= direction << 1 & 0xFFFFFFFF
    scrambled = (_scramble(row, key ^ np.uint32(one)) for row, one in zip((first, second), _SCRAMBLE, strict=True))
    return np.stack([(reverse_bits(row) + 0.5) * 2.0**-32 for row in scrambled])


def reverse_bits(bits: np.ndarray) -> np.ndarray:
    """The bits of uint32 numbers in the opposite order."""
    for shift, mask in ((1, 0x55555555), (2, 0x33333333), (4, 0x0F0F0F0F), (8, 0x00FF00FF), (16, 0x0000FFFF)):
        low = np.uint32(mask)
        bits = (bits >> np.uint32(shift) & low) | (bits & low) << np.uint32(shift)
    return bits


def _scramble(bits: np.ndarray, key: np.uint32) -> np.ndarray:
    """Flip each bit by a hash of the lower ones: Owen's scrambling of numbers whose bits are reversed."""
    bits = bits ^ bits * np.uint32(0x3D20ADEA)
    with np.errstate(over="ignore"):
        bits = (bits + key) * (key >> np.uint32(16) | np.uint32(1))
    bits = bits ^ bits * np.uint32(0x05526C56)
    return bits ^ bits * np.uint32(0x53A22864)


def _hash(number: int) -> int:
    """Mix a 32-bit number (Hash Prospector)."""
    number ^= number >> 16
    number = number * 0x21F0AAAD & 0xFFFFFFFF
    number ^= number >> 15
    number = number * 0xD35A2D97 & 0xFFFFFFFF
    return number ^ number >> 15 ^ 0xE6FE3BEB
