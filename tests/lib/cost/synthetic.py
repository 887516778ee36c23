# SPDX-License-Identifier: GPL-3.0-or-later
"""Renderers whose variance, bias and seconds are known because they are made of them."""

from dataclasses import dataclass, field

import numpy as np
from etalon.lib.cost.ways import Bias, Way
from etalon.lib.film.rendering import Rendering

HEIGHT, WIDTH = 12, 16
# Radiance of two decades.
TRUTH = np.geomspace(0.1, 10.0, HEIGHT * WIDTH * 3).reshape(HEIGHT, WIDTH, 3)
# What the floor of the weights leaves of a relative squared error of 1.
RELATIVE = float((TRUTH**2 / (TRUTH**2 + (0.01 * TRUTH.mean()) ** 2)).mean())


@dataclass
class Synthetic:
    """Gaussian noise of relative variance `variance` / N^rate on the truth times 1 + `bias`.

    `seconds` a sample, `fixed` a call.
    """

    seed: int
    variance: float = 1.0
    bias: float = 0.0
    rate: float = 1.0
    seconds: float = 1e-3
    fixed: float = 0.0
    jitter: float = 0.02
    name: str = "synthetic"
    settings: dict = field(default_factory=dict)

    def render(self, replicate, samples, progress=None, windows=None):
        rng = np.random.default_rng([self.seed, replicate, samples])
        noise = np.sqrt(self.variance / samples**self.rate) * rng.standard_normal(TRUTH.shape)
        seconds = (self.fixed + self.seconds * samples) * np.exp(self.jitter * rng.standard_normal())
        zeros = np.zeros((HEIGHT, WIDTH), np.int64)
        return Rendering(
            TRUTH * (1.0 + self.bias + noise), zeros, seconds, {"shade": seconds}, HEIGHT * WIDTH * samples
        )


def way(key, kind=Bias.NONE, known=None, **renderer):
    return Way(key, key, "sampling", lambda: Synthetic(**renderer), kind, known)
