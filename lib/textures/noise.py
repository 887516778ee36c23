# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Noise texture: Perlin's gradient noise and the fractals made of it.

It has one to four dimensions.

Perlin 2002, "Improving noise"; Musgrave in "Texturing and Modeling", ch. 16. A point is a list of one to four
coordinates, (n,) each.
"""

from __future__ import annotations

import itertools

import numpy as np

from .hashes import hash_cells, hash_floats

Point = list[np.ndarray]

# What brings each dimension's noise to [-1, 1], about (Cycles, kernel/svm/noise.h).
_SCALE = {1: 0.2500, 2: 0.6616, 3: 0.9820, 4: 0.8344}
_PERIOD = 100000.0


def _signed(value: np.ndarray, bit: np.ndarray) -> np.ndarray:
    return np.where(bit != 0, -value, value)


def _slope(hashed: np.ndarray, offset: Point) -> np.ndarray:
    """The corner's gradient times the offset from the corner."""
    if len(offset) == 1:
        h = hashed & 15
        return _signed(1.0 + (h & 7), h & 8) * offset[0]
    x, y = offset[0], offset[1]
    if len(offset) == 2:
        h = hashed & 7
        u, v = np.where(h < 4, x, y), 2.0 * np.where(h < 4, y, x)
        return _signed(u, h & 1) + _signed(v, h & 2)
    z = offset[2]
    if len(offset) == 3:
        h = hashed & 15
        u = np.where(h < 8, x, y)
        v = np.where(h < 4, y, np.where((h == 12) | (h == 14), x, z))
        return _signed(u, h & 1) + _signed(v, h & 2)
    h = hashed & 31
    u, v, s = np.where(h < 24, x, y), np.where(h < 16, y, z), np.where(h < 8, z, offset[3])
    return _signed(u, h & 1) + _signed(v, h & 2) + _signed(s, h & 4)


def perlin(point: Point) -> np.ndarray:
    """Signed noise of about [-1, 1], (n,); it repeats every 100,000 units, as Cycles' does."""
    point = [np.fmod(p, _PERIOD) + 0.5 * (np.abs(p) >= 1000000.0) for p in point]
    cell = [np.floor(p) for p in point]
    inside = [p - c for p, c in zip(point, cell, strict=True)]
    fade = [t * t * t * (t * (t * 6.0 - 15.0) + 10.0) for t in inside]
    total = np.zeros_like(inside[0])
    for corner in itertools.product((0.0, 1.0), repeat=len(point)):
        weight = np.ones_like(total)
        for f, k in zip(fade, corner, strict=True):
            weight = weight * (f if k else 1.0 - f)
        hashed = hash_cells(*(c + k for c, k in zip(cell, corner, strict=True)))
        total += weight * _slope(hashed, [t - k for t, k in zip(inside, corner, strict=True)])
    return _SCALE[len(point)] * total


def fbm(point: Point, detail: np.ndarray, roughness: np.ndarray, lacunarity: np.ndarray, normalize: bool) -> np.ndarray:
    """Return the fractal sum of octaves, scaled to [0, 1] if `normalize`.

    Each octave is `lacunarity` times finer and `roughness` times weaker.

    `detail`, () or (n,), is the number of octaves beyond the first; its broken part fades the last one in.
    """
    scale, amplitude = np.ones(1), np.ones(1)
    largest, total = np.zeros(1), np.zeros_like(point[0])
    whole = np.floor(detail)
    result = np.zeros_like(point[0])
    for octave in range(int(np.max(whole)) + 2):
        if octave > 0:
            # Where `octave - 1` is the last whole one, what there is so far, mixed with one more by the rest of detail.
            rest = np.clip(detail - (octave - 1.0), 0.0, 1.0)
            before = 0.5 * total / largest + 0.5 if normalize else total
        more = perlin([p * scale for p in point])
        total = total + more * amplitude
        largest = largest + amplitude
        after = 0.5 * total / largest + 0.5 if normalize else total
        if octave > 0:
            result = np.where(whole == octave - 1.0, (1.0 - rest) * before + rest * after, result)
        amplitude, scale = amplitude * roughness, scale * lacunarity
    return result


def multifractal(point: Point, detail: np.ndarray, roughness: np.ndarray, lacunarity: np.ndarray) -> np.ndarray:
    """Product of octaves."""
    value, power = np.ones_like(point[0]), np.ones(1)
    for octave in range(int(np.max(np.floor(detail))) + 2):
        share = np.clip(detail - octave + 1.0, 0.0, 1.0) if octave else 1.0
        value = value * np.where(share > 0.0, share * power * perlin(point) + 1.0, 1.0)
        power, point = power * roughness, [p * lacunarity for p in point]
    return value


def hetero_terrain(
    point: Point, detail: np.ndarray, roughness: np.ndarray, lacunarity: np.ndarray, offset: np.ndarray
) -> np.ndarray:
    """Octaves that grow with the height reached."""
    value, power = offset + perlin(point), roughness
    for octave in range(1, int(np.max(np.floor(detail))) + 2):
        point = [p * lacunarity for p in point]
        share = np.clip(detail - octave + 1.0, 0.0, 1.0)
        value = value + share * (perlin(point) + offset) * power * value
        power = power * roughness
    return value


def hybrid_multifractal(
    point: Point,
    detail: np.ndarray,
    roughness: np.ndarray,
    lacunarity: np.ndarray,
    offset: np.ndarray,
    gain: np.ndarray,
) -> np.ndarray:
    """Octaves weighed by what the ones before have reached."""
    value, weight, power = np.zeros_like(point[0]), np.ones_like(point[0]), np.ones(1)
    for octave in range(int(np.max(np.floor(detail))) + 2):
        share = np.clip(detail - octave + 1.0, 0.0, 1.0) if octave else 1.0
        weight = np.where(weight > 0.001, np.minimum(weight, 1.0), 0.0)  # once below, an octave ends the sum
        signal = (perlin(point) + offset) * power
        value = value + share * weight * signal
        weight = weight * gain * signal
        power, point = power * roughness, [p * lacunarity for p in point]
    return value


def ridged_multifractal(
    point: Point,
    detail: np.ndarray,
    roughness: np.ndarray,
    lacunarity: np.ndarray,
    offset: np.ndarray,
    gain: np.ndarray,
) -> np.ndarray:
    """Octaves of ridges, each weighed by the one before; no broken octave."""
    signal = np.square(offset - np.abs(perlin(point)))
    value, power = signal, roughness
    for octave in range(1, int(np.max(np.floor(detail))) + 1):
        point = [p * lacunarity for p in point]
        weight = np.clip(signal * gain, 0.0, 1.0)
        signal = np.square(offset - np.abs(perlin(point))) * weight
        value = value + np.where(octave <= np.floor(detail), signal * power, 0.0)
        power = power * roughness
    return value


def _shifted(point: Point, seed: float) -> Point:
    """The point moved by 100 to 200 units along each axis, by `seed`: another noise."""
    if len(point) == 1:
        return [point[0] + (100.0 + 100.0 * hash_floats(seed))]
    return [p + (100.0 + 100.0 * hash_floats(seed, float(axis))) for axis, p in enumerate(point)]


def noise_texture(
    point: Point,
    kind: str,
    fractal: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    distortion: np.ndarray,
    normalize: bool,
    colored: bool,
) -> np.ndarray:
    """The Noise texture at a scaled point: (n,), or (3, n) if `colored`.

    `fractal` holds detail, roughness, lacunarity, offset and gain.
    """
    count = len(point)
    detail, roughness, lacunarity, offset, gain = fractal
    detail, roughness = np.clip(detail, 0.0, 15.0), np.maximum(roughness, 0.0)
    if np.any(distortion):
        point = [p + perlin(_shifted(point, float(k))) * distortion for k, p in enumerate(point)]

    def value(at: Point) -> np.ndarray:
        if kind == "FBM":
            return fbm(at, detail, roughness, lacunarity, normalize)
        if kind == "MULTIFRACTAL":
            return multifractal(at, detail, roughness, lacunarity)
        if kind == "HETERO_TERRAIN":
            return hetero_terrain(at, detail, roughness, lacunarity, offset)
        many = hybrid_multifractal if kind == "HYBRID_MULTIFRACTAL" else ridged_multifractal
        return many(at, detail, roughness, lacunarity, offset, gain)

    if not colored:
        return value(point)
    return np.stack([value(point), value(_shifted(point, float(count))), value(_shifted(point, float(count + 1)))])
