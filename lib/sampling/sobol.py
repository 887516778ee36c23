# SPDX-License-Identifier: GPL-3.0-or-later
"""Padded, Owen-scrambled Sobol' pairs, and plain random pairs behind the same two methods.

Every decision of a path (pixel filter, lens, lobe, light, ...) is one *dimension*: a pair of uniforms. For each
dimension a replicate holds a few point sets, each its own nested uniform scrambling of the first two Sobol' dimensions in
its own random order (padding: two dimensions of one path are independent). A pixel picks a set by a hash and shifts it digitally
(XOR) by another: pixels are then independent of each other given the sets, and every point is uniform by the shift alone, so that each
pixel is unbiased.

Owen 1995, "Randomly permuted (t,m,s)-nets"; Kollig and Keller 2002, padded (0,2)-sequences; Burley 2020 for hashing the scrambling.
"""

from __future__ import annotations

import threading

import numpy as np

from ..vectors import gather
from .streams import PIXEL_KEYS, RANDOM_NUMBERS

SETS = 32
_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_LOWER = np.uint64(0xFFFFFFFF)


def hash64(key: np.ndarray) -> np.ndarray:
    """Mix unsigned 64-bit integers; the finaliser of SplitMix64 (Steele, Lea and Flood 2014)."""
    key = np.asarray(key, np.uint64)
    with np.errstate(over="ignore"):
        key = key ^ (key >> np.uint64(30))
        key *= np.uint64(0xBF58476D1CE4E5B9)
        key ^= key >> np.uint64(27)
        key *= np.uint64(0x94D049BB133111EB)
    key ^= key >> np.uint64(31)
    return key


def stream_key(*parts: int) -> np.uint64:
    """One 64-bit key from a few integers (seed, replicate, dimension)."""
    key = np.zeros(1, np.uint64)
    for part in parts:
        with np.errstate(over="ignore"):
            key = hash64(key + _GOLDEN * np.uint64((part + 1) & 0xFFFFFFFFFFFFFFFF))
    return key[0]


def sobol_pairs(log2_count: int) -> np.ndarray:
    """The first 2**log2_count points of the first two Sobol' dimensions, (2, n) uint32.

    Their direction numbers are 2**(31 - k), van der Corput's sequence, and v -> v ^ v / 2 (Sobol' 1967). SciPy has the same points; loading
    it for these took half a second at each start.
    """
    points = np.zeros((2, 1), np.uint32)
    first = second = 1 << 31
    for _ in range(log2_count):
        points = np.concatenate([points, points ^ np.array([[first], [second]], np.uint32)], axis=1)
        first, second = first >> 1, second ^ second >> 1
    return points


def owen_scramble(depth: int, keys: np.ndarray) -> np.ndarray:
    """Return nested uniform scramblings (Owen 1995) of the points k / 2**depth.

    The result is (..., 2**depth) uint64 below 2**32.

    `keys`, uint64 (..., 1), one for each scrambling. Each of the first `depth` bits is flipped by a hash of all bits
    above it. No two points share all of these, so that the bits below are independent of point to point: one hash of
    the point gives all of them.
    """
    scrambled = np.zeros(keys.shape, np.uint64)
    for bit in range(depth):
        flip = _hash_level(bit, keys) >> np.uint64(63)
        halves = np.empty((*scrambled.shape, 2), np.uint64)
        halves[..., 0] = scrambled << np.uint64(1) | flip
        halves[..., 1] = halves[..., 0] ^ np.uint64(1)
        scrambled = halves.reshape(*keys.shape[:-1], 2 << bit)
    return scrambled << np.uint64(32 - depth) | _hash_level(depth, keys) >> np.uint64(32 + depth)


def _hash_level(bit: int, keys: np.ndarray) -> np.ndarray:
    """Return a hash of each choice of the first `bit` bits, (..., 2**bit).

    A leading one tells the level.
    """
    with np.errstate(over="ignore"):
        return hash64(keys + _GOLDEN * np.arange(1 << bit, 2 << bit, dtype=np.uint64))


class SobolSampler:
    """Uniform pairs for one replicate of `samples` samples per pixel.

    Powers of two stratify best; any other count takes a random part of the next power of two, which leaves it unbiased.
    """

    def __init__(self, seed: int, replicate: int, samples: int) -> None:
        self.samples = samples
        self._seed, self._replicate = seed, replicate
        self._log2 = max(samples - 1, 0).bit_length()
        # Which of the 2**log2 intervals each point of the net lies in.
        self._base = (sobol_pairs(self._log2).astype(np.uint64) >> np.uint64(32 - self._log2)).astype(np.intp)
        self._tables: dict[int, np.ndarray] = {}
        self._lock = threading.Lock()

    def _table(self, dimension: int) -> np.ndarray:
        """Return the point sets of one dimension, (SETS * n,) uint64.

        The first coordinate is in the lower half, the second in the upper.
        """
        table = self._tables.get(dimension)
        if table is None:
            with self._lock:
                table = self._tables.get(dimension)
                if table is None:
                    table = self._tables[dimension] = self._make_table(dimension)
        return table

    def _make_table(self, dimension: int) -> np.ndarray:
        key = stream_key(self._seed, self._replicate, dimension)
        order = np.random.default_rng(int(key))
        count = self._base.shape[1]
        with np.errstate(over="ignore"):
            keys = hash64(key + _GOLDEN * np.arange(1, 2 * SETS + 1, dtype=np.uint64)).reshape(2, SETS, 1)
        shuffled = order.permuted(np.broadcast_to(np.arange(count), (SETS, count)), axis=1)
        begin = count * np.arange(2 * SETS).reshape(2, SETS, 1)
        first, second = np.take(owen_scramble(self._log2, keys), self._base[:, shuffled] + begin).reshape(2, -1)
        return first | second << np.uint64(32)

    def tile(self, pixels: np.ndarray) -> SobolTile:
        """The sampler's view of some pixels, given by their index in the image."""
        return SobolTile(self, np.asarray(pixels, np.uint64))


class SobolTile:
    """Pairs for the paths of one tile; a path is a local pixel index and a sample index."""

    def __init__(self, sampler: SobolSampler, pixels: np.ndarray) -> None:
        self._sampler = sampler
        with np.errstate(over="ignore"):
            self._pixel_keys = hash64(pixels * _GOLDEN + stream_key(sampler._seed, sampler._replicate, PIXEL_KEYS))

    def pair(self, dimension: int, pixel: np.ndarray, sample: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Two uniforms in (0, 1) for each path, float64 (n,); `pixel` and `sample` are (n,) intp."""
        sampler = self._sampler
        table = sampler._table(dimension)
        with np.errstate(over="ignore"):
            key = hash64(self._pixel_keys + _GOLDEN * np.uint64(dimension + 1))
        start = (hash64(key) % np.uint64(SETS)).astype(np.intp) * (table.size // SETS)
        index = gather(start, pixel)
        index += sample
        bits = gather(table, index)
        bits ^= gather(key, pixel)  # both coordinates at once
        return _uniform(bits & _LOWER), _uniform(bits >> np.uint64(32))


def _uniform(bits: np.ndarray) -> np.ndarray:
    """Integers below 2**32 as the midpoints of 2**-32 wide cells: never 0, never 1."""
    u = bits.view(np.int64) * 2.0**-32
    u += 2.0**-33
    return u


class RandomSampler:
    """Plain independent uniforms behind the same interface.

    They show what stratification gains.
    """

    def __init__(self, seed: int, replicate: int, samples: int) -> None:
        self.samples = samples
        self._key = int(stream_key(seed, replicate, RANDOM_NUMBERS))

    def tile(self, pixels: np.ndarray) -> RandomTile:
        """The sampler's view of some pixels; their first index seeds the tile."""
        return RandomTile(np.random.default_rng([self._key, int(pixels[0])]))


class RandomTile:
    """Independent pairs for the paths of one tile."""

    def __init__(self, generator: np.random.Generator) -> None:
        self._generator = generator

    def pair(self, dimension: int, pixel: np.ndarray, sample: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Two uniforms in [0, 1) for each path, float64 (n,)."""
        return self._generator.random(pixel.shape[0]), self._generator.random(pixel.shape[0])
