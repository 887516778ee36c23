# SPDX-License-Identifier: GPL-3.0-or-later
"""Where errors are looked for.

These are the corners of every domain, and places between them that crowd towards its ends.
"""

from __future__ import annotations

import numpy as np

ALPHAS = (1e-6, 1e-4, 1e-2, 0.3, 1.0)
ANGLES = np.radians([0.0, 1e-12, 1e-6, 1e-3, 1.0, 30.0, 60.0, 85.0, 89.9, 90.0 - 1e-6, 90.0 - 1e-12])
UNIFORMS = (2.0**-53, 2.0**-33, 1e-8, 1e-3, 0.1, 0.5, 0.75, 1.0 - 1e-3, 1.0 - 1e-8, 1.0 - 2.0**-33, 1.0 - 2.0**-53)
INDICES = (1.0 - 1e-8, 1.0 + 1e-8, 1.0 - 1e-4, 1.0 + 1e-4, 0.4, 1.0 / 1.5, 1.33, 1.5, 2.4, 10.0)


def alphas(rng: np.random.Generator, count: int) -> np.ndarray:
    """alpha_x and alpha_y from 1e-6 to 1, (2, n): a third isotropic, the rest both axes apart."""
    pair = _mixed(rng, count, ALPHAS, (10.0 ** rng.uniform(-6.0, 0.0, (2, count)), rng.uniform(1e-6, 1.0, (2, count))))
    pair[1] = np.where(rng.random(count) < 1.0 / 3.0, pair[0], pair[1])
    return pair


def directions(rng: np.random.Generator, count: int) -> np.ndarray:
    """Draw unit vectors (3, n) of the upper hemisphere.

    They come to within 1e-12 degrees of the horizon and of the normal.
    """
    low = 10.0 ** rng.uniform(-14.0, 0.0, (1, count))
    choices = (
        low,
        0.5 * np.pi - 10.0 ** rng.uniform(-13.7, 0.0, (1, count)),
        rng.uniform(0.0, 0.5 * np.pi, (1, count)),
    )
    theta = _mixed(rng, count, ANGLES, choices)[0]
    phi = rng.uniform(0.0, 2.0 * np.pi, count)
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


def uniforms(rng: np.random.Generator, count: int, dimensions: int = 1) -> np.ndarray:
    """Uniforms from 2^-53 to 1 - 2^-53, (dimensions, n)."""
    shape = (dimensions, count)
    low = 2.0 ** rng.uniform(-53.0, -1.0, shape)
    choices = (low, 1.0 - 2.0 ** np.ceil(rng.uniform(-53.0, -1.0, shape)), rng.random(shape))
    return np.clip(_mixed(rng, count, UNIFORMS, choices), 2.0**-53, 1.0 - 2.0**-53)


def cosines(rng: np.random.Generator, count: int) -> np.ndarray:
    """Cosines in (0, 1], (1, n), crowding at both ends."""
    choices = (10.0 ** rng.uniform(-14.0, 0.0, (1, count)), 1.0 - 10.0 ** rng.uniform(-15.0, 0.0, (1, count)))
    return np.abs(_mixed(rng, count, np.cos(ANGLES), (*choices, rng.random((1, count)))))


def indices(rng: np.random.Generator, count: int) -> np.ndarray:
    """Relative indices of refraction, (1, n), down to 1 +- 1e-8."""
    near = 1.0 + rng.choice([-1.0, 1.0], (1, count)) * 10.0 ** rng.uniform(-8.0, -0.5, (1, count))
    return _mixed(rng, count, INDICES, (near, 10.0 ** rng.uniform(-0.7, 1.0, (1, count))))


def lobe_normals(rng: np.random.Generator, alpha: np.ndarray) -> np.ndarray:
    """Draw microfacet normals (3, n).

    Half of them lie where a lobe of that `alpha` (2, n) has its mass, half anywhere.
    """
    count = alpha.shape[1]
    tangent = 10.0 ** rng.uniform(-3.0, 1.0, count)
    phi = rng.uniform(0.0, 2.0 * np.pi, count)
    m = np.stack([alpha[0] * tangent * np.cos(phi), alpha[1] * tangent * np.sin(phi), np.ones(count)])
    m /= np.sqrt((m * m).sum(axis=0))
    return np.where(rng.random(count) < 0.5, m, directions(rng, count))


def _mixed(
    rng: np.random.Generator, count: int, corners: tuple[float, ...] | np.ndarray, choices: tuple[np.ndarray, ...]
) -> np.ndarray:
    """Draw a quarter of all entries from `corners`, the rest in equal parts from `choices`.

    Each choice is (k, count).
    """
    shape = choices[0].shape
    which = rng.integers(0, len(choices), shape)
    mixed = np.choose(which, choices)
    return np.where(rng.random(shape) < 0.25, rng.choice(np.asarray(corners), shape), mixed)
