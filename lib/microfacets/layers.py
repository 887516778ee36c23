# SPDX-License-Identifier: GPL-3.0-or-later
"""Albedos of rough dielectrics: glossy layers and glass interfaces.

A glossy layer reflects; a glass interface reflects and refracts.
Directional albedos of GGX with height-correlated masking, by quadrature, tabulated for one index at a time.
"""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np
import scipy
from scipy.special import roots_legendre

from ..sampling.warps import circle
from .albedo import integrate_albedo
from .fresnel import dielectric

_NODES = (33, 65)  # coarse nodes along roughness and along the root of the cosine
_CELLS = 256
_LEAST = 1e-8  # stands for a cosine or an alpha of zero
_LINE = roots_legendre(24)  # nodes and weights, worked out once: materials by the hundred ask for them
# Fibonacci lattices over visible normals, number of points and generator. Total reflection, inside, needs more of them.
_OUTSIDE, _INSIDE = (4181, 2584), (10946, 6765)
_BATCH = 1 << 14  # points worked on at a time: what they take stays in cache


def layer_albedo(cos_o: np.ndarray, alpha: np.ndarray, eta: float) -> tuple[np.ndarray, np.ndarray]:
    """The integrals of D G / (4 mu) over wi with weights 1 - s and s, (n,) each.

    s = (F - F0) / (1 - F0).
    A layer whose reflectance runs from f0 to 1 along the dielectric's curve has the albedo f0 times the first plus the
    second. `cos_o` (n,) and `alpha`, () or (n,), in [0, 1]; `eta` > 0.
    """
    from_normal, to_grazing = _layer_tables(float(eta))
    return read_albedo(from_normal, cos_o, alpha), read_albedo(to_grazing, cos_o, alpha)


def average_reflectance(eta: float | np.ndarray) -> np.ndarray:
    """Integral of 2 mu F(mu) over mu, shaped as `eta` > 0.

    It is the share of diffuse light that an interface reflects.
    Below the critical angle mu^2 = mu_c^2 + x^2, so that the integrand is smooth in x.
    """
    eta = np.asarray(eta, np.float64)
    critical = np.maximum(1.0 - eta * eta, 0.0)
    x, weight = _LINE
    reach = np.sqrt(1.0 - critical)
    x = np.multiply.outer(0.5 + 0.5 * x, reach)
    reflected = dielectric(np.sqrt(critical + x * x), eta) * x
    return critical + np.tensordot(weight, reflected, 1) * reach


def glass_albedo(cos_o: np.ndarray, alpha: np.ndarray, eta: float) -> np.ndarray:
    """The albedo, (n,), of a white interface of index `eta` after one scattering.

    It counts what the interface reflects and refracts together.
    """
    return read_albedo(_glass_table(float(eta))[0], cos_o, alpha)


def average_glass_albedo(alpha: np.ndarray, eta: float) -> np.ndarray:
    """Integral of 2 mu times `glass_albedo` over mu, shaped as `alpha`."""
    return np.interp(np.sqrt(alpha), np.linspace(0.0, 1.0, _CELLS + 1), _glass_table(float(eta))[1])


def tabulate_albedo(reflectance: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """The albedo of GGX facets with a `reflectance` of the cosine, for `read_albedo`; to 1e-4."""
    return _tabulated(lambda mu, alpha: integrate_albedo(mu, alpha, reflectance=reflectance))


def read_albedo(table: np.ndarray, cos_o: np.ndarray, alpha: float | np.ndarray) -> np.ndarray:
    """A table over roughness sqrt(alpha) and the root of the cosine, bilinear, (n,).

    `cos_o` (n,), `alpha` () or (n,), in [0, 1].
    """
    column = np.sqrt(np.clip(cos_o, 0.0, 1.0)) * _CELLS
    row = np.broadcast_to(np.sqrt(alpha), column.shape) * _CELLS
    i = np.minimum(row.astype(np.intp), _CELLS - 1)
    j = np.minimum(column.astype(np.intp), _CELLS - 1)
    across, along = row - i, column - j
    first = i * (_CELLS + 1) + j
    flat = table.ravel()
    low = flat.take(first) * (1.0 - along) + flat.take(first + 1) * along
    first += _CELLS + 1
    high = flat.take(first) * (1.0 - along) + flat.take(first + 1) * along
    return low * (1.0 - across) + high * across


def _tabulated(integral: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> np.ndarray:
    """`integral` of cosine and alpha at coarse nodes.

    A cubic spline through them gives the values on the fine grid.
    """
    roughness, root = (np.linspace(0.0, 1.0, count) for count in _NODES)
    mu, alpha = np.maximum(root * root, _LEAST), np.maximum(roughness * roughness, _LEAST)
    values = np.stack([integral(mu, np.full_like(mu, a)) for a in alpha])
    fine = np.linspace(0.0, 1.0, _CELLS + 1)
    table = np.clip(scipy.interpolate.RectBivariateSpline(roughness, root, values)(fine, fine), 0.0, 1.0)
    table.flags.writeable = False
    return table


@functools.lru_cache(maxsize=64)
def _layer_tables(eta: float) -> tuple[np.ndarray, np.ndarray]:
    """Both integrals of `layer_albedo` on the grid."""
    normal = ((eta - 1.0) / (eta + 1.0)) ** 2

    def share(cos: np.ndarray) -> np.ndarray:
        return np.clip((dielectric(cos, eta) - normal) / max(1.0 - normal, 1e-12), 0.0, 1.0)

    return tabulate_albedo(lambda cos: 1.0 - share(cos)), tabulate_albedo(share)


@functools.lru_cache(maxsize=64)
def _glass_table(eta: float) -> tuple[np.ndarray, np.ndarray]:
    """`glass_albedo` on the grid, and its average over the cosine.

    The average is at each roughness of the grid.
    """
    table = _tabulated(lambda mu, alpha: integrate_glass(mu, alpha, eta))
    x, weight = roots_legendre(64)
    root = 0.5 + 0.5 * x
    weight = 2.0 * weight * root * root * root
    average = [(weight * read_albedo(table, root * root, r * r)).sum() for r in np.linspace(0.0, 1.0, _CELLS + 1)]
    return table, np.array(average)


def integrate_glass(
    cos_o: np.ndarray, alpha: np.ndarray, eta: float, lattice: tuple[int, int] | None = None
) -> np.ndarray:
    """The albedo of a white interface by quadrature over visible normals, (n,), to 1e-4.

    `cos_o` and `alpha` (n,) in (0, 1].
    Under the density of visible normals each facet counts G2 / G1(o), split by Fresnel, where its ray leaves to the
    right side. `lattice`: the number of points and the generator, two Fibonacci numbers.
    """
    if lattice is None:
        lattice = _INSIDE if eta < 1.0 else _OUTSIDE
    at_once = max(_BATCH // lattice[0], 1)
    parts = [slice(k, k + at_once) for k in range(0, cos_o.size, at_once)]
    return np.concatenate([_integrate_glass(cos_o[part], alpha[part], eta, lattice) for part in parts])


def _integrate_glass(cos_o: np.ndarray, alpha: np.ndarray, eta: float, lattice: tuple[int, int]) -> np.ndarray:
    """As `integrate_glass`: rows of the arrays are pairs of cosine and alpha, columns are visible normals."""
    mu, rough = cos_o[:, None], alpha[:, None]
    sine = np.sqrt((1.0 - mu) * (1.0 + mu))
    lambda_o = _smith_lambda(mu, rough)
    m_x, m_z, weight = _visible_normals(mu, sine, rough, lambda_o, lattice)
    cos_om = np.clip(sine * m_x + mu * m_z, 0.0, 1.0)
    # Squared cosine of the refracted ray, negative where there is none.
    beyond = 1.0 - (1.0 - cos_om * cos_om) / (eta * eta)
    reflectance = dielectric(cos_om, eta)
    mirrored = 2.0 * cos_om * m_z - mu
    refracted = mu / eta - (cos_om / eta - np.sqrt(np.maximum(beyond, 0.0))) * m_z
    total = reflectance * _seen(mirrored, rough, lambda_o)
    total += (1.0 - reflectance) * np.where(beyond > 0.0, _seen(refracted, rough, lambda_o), 0.0)
    return (total * weight).sum(axis=1)


@functools.lru_cache(maxsize=4)
def _points(lattice: tuple[int, int]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Nodes of a quadrature over the cap of visible normals, (k,) each: x and squared y of the turn, height, and weight.

    The integrand is periodic in the turn; the height is bent, u = 3 v^2 - 2 v^3, so that it seems so: the lattice then
    errs by less than its kinks at total reflection.
    """
    many, generator = lattice
    k = np.arange(many)
    x, y = circle((k + 0.5) / many)
    v = (k * generator % many + 0.5) / many
    return x, y * y, v * v * (3.0 - 2.0 * v), 6.0 * v * (1.0 - v) / many


def _visible_normals(
    mu: np.ndarray, sine: np.ndarray, alpha: np.ndarray, lambda_o: np.ndarray, lattice: tuple[int, int]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Visible normals for wo = (sine, 0, mu), (n, 1): their x and z, (n, k), and their weights (k,).

    It is `GGX.sample_visible` for one alpha, on all of a lattice: the turns are worked out once, and y, which has no part
    in a cosine with wo, is not.
    """
    turn_x, turn_y2, u, weight = _points(lattice)
    length = mu * (1.0 + 2.0 * lambda_o)
    height = 1.0 + mu / length
    drop = height * u
    radius2 = np.clip(drop * (2.0 - drop), 0.0, 1.0)
    x = alpha * (sine * alpha / length + np.sqrt(radius2) * turn_x)
    z = height * (1.0 - u)
    scale = 1.0 / np.sqrt(x * x + alpha * alpha * radius2 * turn_y2 + z * z)
    return x * scale, z * scale, weight


def _smith_lambda(cos: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """`GGX.smith_lambda` for one alpha, of directions at `cos` > 0 from the normal; shapes broadcast."""
    sine2 = alpha * alpha * ((1.0 - cos) * (1.0 + cos))
    return 0.5 * sine2 / (cos * (cos + np.sqrt(cos * cos + sine2)))


def _seen(cos: np.ndarray, alpha: np.ndarray, lambda_o: np.ndarray) -> np.ndarray:
    """G2 / G1(o) for a direction at `cos` from the normal on its own side, 0 on the wrong one."""
    lambda_i = _smith_lambda(np.clip(cos, 1e-9, 1.0), alpha)
    return np.where(cos > 0.0, (1.0 + lambda_o) / (1.0 + lambda_o + lambda_i), 0.0)
