# SPDX-License-Identifier: GPL-3.0-or-later
"""Independent replicates of an image, and what can be concluded from them.

Samples inside one replicate are not independent (they are stratified); replicates are. All tests are two-sided t tests over
replicates, region by region, with one family-wise level for all regions and channels together (Sidak). A region counts only if its
standard error is small enough for the test to mean something: `precision` is asserted too.
"""

import numpy as np
from etalon.lib.scene.scene import Scene
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.chi2 import sidak
from scipy import stats

LEVEL = 1e-4


def replicates(scene: Scene, count: int, samples: int, make=ReferenceRenderer, **options) -> np.ndarray:
    """Images (count, height, width, 3) by the renderer that `make` gives.

    One thread and no roulette unless `options` say otherwise.
    """
    renderer = make(scene, Options(**{"threads": 1, "russian_roulette": False, **options}))
    images = []
    for replicate in range(count):
        rendering = renderer.render(replicate, samples)
        assert not rendering.nonfinite.any()
        images.append(rendering.radiance)
    return np.array(images)


def blocks(images: np.ndarray, size: int) -> np.ndarray:
    """Means of size x size blocks, (count, height / size, width / size, 3)."""
    count, height, width, _ = images.shape
    return images.reshape(count, height // size, size, width // size, size, 3).mean(axis=(2, 4))


def _flat(values: np.ndarray) -> np.ndarray:
    return values.reshape(len(values), -1)


def _check(difference, error, freedom, scale, precision, rounding, level) -> None:
    """No region's difference exceeds its quantile times its standard error.

    Errors are below `precision` of the scale (or of its mean).
    """
    per_region = sidak(level, difference.size)
    allowed = stats.t.ppf(1.0 - 0.5 * per_region, freedom) * error + rounding * scale
    worst = np.argmax(np.abs(difference) / np.maximum(allowed, 1e-300))
    found = f"region {worst}: difference {difference[worst]:.3g}, error {error[worst]:.3g} of {scale[worst]:.5g}"
    assert np.all(np.abs(difference) <= allowed), found
    scale = np.maximum(scale, scale.mean())
    poor = np.argmax(error / scale)
    assert error[poor] <= precision * scale[poor], f"region {poor} is too noisy: {error[poor]:.3g} of {scale[poor]:.3g}"


def assert_mean(images: np.ndarray, exact, precision: float, rounding: float = 1e-9, level: float = LEVEL) -> None:
    """The replicates' mean is `exact` (broadcast to one image).

    Standard errors are below `precision` of it.

    `rounding`, relative, is for regions that every sample gets right: what float32 ray directions and the closed form
    itself may err.
    """
    values = _flat(images)
    exact = np.broadcast_to(exact, images.shape[1:]).ravel()
    error = values.std(axis=0, ddof=1) / np.sqrt(len(values))
    _check(values.mean(axis=0) - exact, error, len(values) - 1, np.abs(exact), precision, rounding, level)


def assert_same(a: np.ndarray, b: np.ndarray, precision: float, rounding: float = 1e-9, level: float = LEVEL) -> None:
    """Two sets of replicates have the same mean in every region (Welch).

    Standard errors are below `precision` of it.
    """
    a, b = _flat(a), _flat(b)
    share_a, share_b = a.var(axis=0, ddof=1) / len(a), b.var(axis=0, ddof=1) / len(b)
    error = np.sqrt(share_a + share_b)
    spread = share_a**2 / (len(a) - 1) + share_b**2 / (len(b) - 1)
    freedom = np.where(
        spread > 0.0, (share_a + share_b) ** 2 / np.where(spread > 0.0, spread, 1.0), len(a) + len(b) - 2.0
    )
    scale = np.maximum(np.abs(a.mean(axis=0)), np.abs(b.mean(axis=0)))
    _check(a.mean(axis=0) - b.mean(axis=0), error, freedom, scale, precision, rounding, level)
