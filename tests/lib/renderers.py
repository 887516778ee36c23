# SPDX-License-Identifier: GPL-3.0-or-later
"""Renderers without a scene.

They have a known image, known noise, and a clock that only they move.
"""

import zlib
from dataclasses import replace

import numpy as np
from etalon.lib.film.film import finite_pixels
from etalon.lib.film.rendering import Rendering
from etalon.tests.scenes import diffuse, floor, orthographic, scene


def blank(width=24, height=20, name="Test"):
    """A scene of which only its size and its name matter here."""
    return replace(scene(floor(), diffuse(0.5), orthographic(width, height, 1.0, (0.0, 0.0, 1.0))), name=name)


class Clock:
    """Stands in for the module `time`."""

    def __init__(self):
        self.now = 100.0

    def monotonic(self):
        return self.now


class Painter:
    """Gives the image `truth` (height, width, 3) with noise `sigma` of one sample.

    It counts the calls. `passes` are the parts of it, light pass -> (height, width, 3); each has noise of its own.
    """

    def __init__(self, name, truth, sigma=0.05, settings=None, clock=None, cost=(0.01, 0.001), change=None, passes=()):
        self.passes = dict(passes)
        self.name, self.settings = name, settings or {"kind": "painter"}
        self.truth, self.sigma, self.cost = truth, sigma, cost
        self.clock, self.change = clock or Clock(), change
        self.asked, self.windows = [], []

    def render(self, replicate, samples, progress, windows=None):
        self.asked.append((replicate, samples))
        self.windows.append(windows)
        rng = np.random.default_rng([zlib.crc32(self.name.encode()), replicate])
        noise = self.sigma / np.sqrt(samples) * rng.standard_normal((*self.truth.shape[:2], 1))
        image = self.truth * (1.0 + noise)
        if self.change is not None:
            image = self.change(replicate, image)
        share = 1.0 if windows is None else windows.mask.mean()
        seconds = self.cost[0] + self.cost[1] * samples * share
        if windows is not None:
            image = np.where(windows.mask[..., None], image, np.nan)
        parts = {}
        for light, part in self.passes.items():
            parts[light] = part * (1.0 + self.sigma / np.sqrt(samples) * rng.standard_normal((*part.shape[:2], 1)))
            if self.change is not None:
                parts[light] = self.change(replicate, parts[light])
        self.clock.now += seconds
        progress.report(0.5)
        progress.report(1.0)
        counts = (~finite_pixels(image)).astype(int)
        return Rendering(
            image,
            counts,
            seconds,
            {"paint": seconds},
            round(image[..., 0].size * share) * samples,
            7,
            windows,
            None,
            parts,
        )


def grey(value=1.0, width=24, height=20):
    """A constant image."""
    return np.full((height, width, 3), value)
