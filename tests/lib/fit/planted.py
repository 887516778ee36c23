# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured BRDFs that tests make from a model with known parameters and known noise."""

from dataclasses import replace

import numpy as np
from etalon.lib.fit.candidates import Candidate, design
from etalon.lib.fit.observations import LEAST_SHARE, plain_observations

DIFFUSE = 0.05
COLORS = (0.9, 0.6, 0.3)
METAL = ((0.3, 3.0), (0.5, 2.7), (0.7, 2.4))


def pairs(rng, count):
    """Directions wi and wo, (3, n), with half vectors about the normal.

    All lie within 80 degrees of it.
    """
    cosine, phi = rng.uniform(0.25, 1.0, count), rng.uniform(-np.pi, np.pi, count)
    sine = np.sqrt(1.0 - cosine * cosine)
    wo = np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine])
    m = np.stack([*(0.36 * rng.standard_normal((2, count))), np.ones(count)])
    m /= np.sqrt((m * m).sum(axis=0))
    wi = 2.0 * (wo * m).sum(axis=0) * m - wo
    return wi[:, wi[2] > 0.17], wo[:, wi[2] > 0.17]


def planted_vector(candidate, alpha, *, anisotropy=1.0, inverse=0.5, colors=3):
    """The searched vector of `candidate` with these parameters."""
    values = {"alpha": np.log(alpha), "anisotropy": np.log(anisotropy), "1/g": inverse}
    vector = [values[name] for name in candidate.names]
    vector += [float(np.log(x)) for pair in METAL[:colors] for x in pair] if candidate.fresnel == "exact" else []
    return np.array(vector)


def planted(rng, candidate, alpha, *, noise=0.01, count=500, colors=3, **shape):
    """Observations of `colors` colours, three at most, of `candidate` with these parameters."""
    wi, wo = pairs(rng, count)
    empty = plain_observations(wi, wo, np.zeros((colors, wi.shape[1])), noise, candidate.anisotropic, "planted")
    vector = planted_vector(candidate, alpha, colors=colors, **shape)
    columns, fixed = design(candidate, empty, vector, candidate.lobe(empty, vector))
    # The third column is Multiscatter GGX's: some of what a colour reflects comes back.
    linear = np.array([[DIFFUSE, color, color * color][: columns.shape[1]] for color in COLORS[:colors]])
    exact = np.einsum("ck,ckn->cn", linear, columns) + fixed
    error = noise * np.maximum(exact, LEAST_SHARE * exact.max(axis=1, keepdims=True))
    return replace(empty, values=exact + error * rng.standard_normal(exact.shape))


ISOTROPIC_GGX = Candidate("ggx", "correlated", "schlick", False)
