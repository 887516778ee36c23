# SPDX-License-Identifier: GPL-3.0-or-later
"""Transmittance of homogeneous volumes, and free paths in them.

The free path is how far light flies before it is scattered.
"""

from __future__ import annotations

import numpy as np


def depth(extinction: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Return the optical depth: extinction times length, (n,).

    It is 0 where nothing is extinguished, over an infinite length too.
    """
    extinction, length = np.broadcast_arrays(extinction, length)
    return np.multiply(extinction, length, out=np.zeros(extinction.shape), where=extinction > 0.0)


def transmittance(extinction: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Return the part exp(-extinction distance) of light that is left after `distance`.

    `distance` is (n,) in metres; the result has the shape of `extinction` (3, n), 1/m.

    Beer and Lambert's law (Pharr, Jakob and Humphreys 2023, eq. 11.9). Distances may be infinite: where nothing is
    extinguished all of the light is left even then. Both are at least 0.
    """
    return np.exp(-depth(extinction, distance))


def mean_transmittance(tau: np.ndarray) -> np.ndarray:
    """Return the mean of exp(-x) over x from 0 to `tau`, (1 - exp(-tau)) / tau.

    It is 1 at 0, and it does not cancel near it.
    """
    return np.divide(-np.expm1(-tau), tau, out=np.ones(np.shape(tau)), where=tau > 0.0)


def attenuated_length(extinction: np.ndarray, length: np.ndarray) -> np.ndarray:
    """The integral of exp(-extinction t) over t from 0 to `length`, in metres, (n,).

    What emits evenly sends so many metres of its emission along the way. Infinite where nothing is extinguished over an infinite length.
    """
    extinction, length = np.broadcast_arrays(extinction, length)
    finite = np.isfinite(length)
    inside = np.where(finite, length, 0.0) * mean_transmittance(depth(extinction, np.where(finite, length, 0.0)))
    with np.errstate(divide="ignore"):
        return np.where(finite, inside, 1.0 / extinction)


def sample_distance(extinction: np.ndarray, length: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return distances (n,) up to `length`, of density proportional to exp(-extinction t).

    They come from uniforms `u` in [0, 1).

    t = -log(1 - u (1 - exp(-tau))) / extinction with tau the optical depth; where that is 0, t = u length. An
    infinite length needs an extinction above 0 (Pharr, Jakob and Humphreys 2023, section A.4.2, restricted to the
    length).
    """
    tau = depth(extinction, length)
    dense = tau > 0.0
    inside = np.divide(-np.log1p(u * np.expm1(-tau)), extinction, out=np.zeros(tau.shape), where=dense)
    return np.minimum(np.where(dense, inside, u * np.where(dense, 0.0, length)), length)


def distance_density(extinction: np.ndarray, length: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Return the density of `distance` in `sample_distance`, per metre.

    Shapes broadcast. Infinite lengths need extinction.
    """
    return np.exp(-depth(extinction, distance)) / attenuated_length(extinction, length)
