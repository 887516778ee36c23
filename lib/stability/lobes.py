# SPDX-License-Identifier: GPL-3.0-or-later
"""The catalogue of lobes without our microfacets, and of the reflectances of lobes."""

from __future__ import annotations

import numpy as np

from ..bsdfs.ashikhmin_shirley import AshikhminShirley, exponent, sample_half_vector
from ..bsdfs.fresnels import TintedDielectric
from ..bsdfs.oren_nayar import OrenNayar
from ..bsdfs.velvet import LEAST_SIGMA, inverted_gaussian
from ..microfacets import fresnel
from . import closed_forms, domain, exact, exact_lobes, inversions
from .measure import Function

FAMILY = "lobe"
_DIRECTIONS = tuple(f"{w}.{c}" for w in ("wi", "wo") for c in ("x", "y", "z"))
_ALPHAS = ("alpha_x", "alpha_y")


def opposite(rng: np.random.Generator, count: int) -> np.ndarray:
    """Draw wi and wo, (6, n), a third of them grazing the surface from opposite sides.

    They come to within 1e-10 of each other's horizon.
    """
    pair = np.concatenate([domain.directions(rng, count), domain.directions(rng, count)])
    low = 10.0 ** rng.uniform(-10.0, 0.0, (2, count))
    phi = rng.uniform(0.0, 2.0 * np.pi, count)
    across = phi + np.pi + 10.0 ** rng.uniform(-12.0, 0.0, count)
    grazing = [
        component
        for cosine, angle in zip(low, (phi, across), strict=True)
        for component in (np.cos(angle) * np.sqrt(1.0 - cosine**2), np.sin(angle) * np.sqrt(1.0 - cosine**2), cosine)
    ]
    return np.where(rng.random(count) < 1.0 / 3.0, np.stack(grazing), pair)


def _blender_alphas(rng: np.random.Generator, count: int) -> np.ndarray:
    """Draw alpha_x and alpha_y, (2, n).

    Their range is that which the exponent of a power of the cosine takes.
    """
    return np.maximum(domain.alphas(rng, count), 1e-4)


def _powers(rng: np.random.Generator, count: int) -> np.ndarray:
    """wi, wo and alphas; half of the wi mirror wo about a normal where the lobe shines."""
    pair, alpha = opposite(rng, count), _blender_alphas(rng, count)
    m, wo = domain.lobe_normals(rng, alpha), pair[3:]
    mirrored = 2.0 * (wo * m).sum(axis=0) * m - wo
    mirrored[2] = np.abs(mirrored[2]) + 1e-300
    pair[:3] = np.where(rng.random(count) < 0.5, mirrored, pair[:3])
    return np.concatenate([pair, alpha])


def _half_vectors(rng: np.random.Generator, count: int) -> np.ndarray:
    return np.concatenate([_blender_alphas(rng, count), domain.uniforms(rng, count, 2)])


def _rough(rng: np.random.Generator, count: int) -> np.ndarray:
    """wi, wo, roughness down to 1e-12 and a colour."""
    roughness = np.where(
        rng.random((1, count)) < 0.5, 10.0 ** rng.uniform(-12.0, 0.0, (1, count)), rng.random((1, count))
    )
    return np.concatenate([opposite(rng, count), roughness, rng.random((1, count))])


def _velvets(rng: np.random.Generator, count: int) -> np.ndarray:
    """Normals and sigma."""
    return np.concatenate([domain.directions(rng, count), rng.uniform(LEAST_SIGMA, 1.0, (1, count))])


def _dim_layers(rng: np.random.Generator, count: int) -> np.ndarray:
    """Draw cosines and indices of a dielectric, and f0 down to 1e-30.

    Some lie next to the critical angle.
    """
    f0 = np.where(rng.random((1, count)) < 0.5, 10.0 ** rng.uniform(-30.0, 0.0, (1, count)), rng.random((1, count)))
    return np.concatenate([closed_forms.dielectrics(rng, count), f0])


def _clear_metals(rng: np.random.Generator, count: int) -> np.ndarray:
    """Draw cosines and indices of a metal without absorption; k is 0.

    Some lie next to the critical angle.
    """
    return np.concatenate([closed_forms.dielectrics(rng, count), np.zeros((1, count))])


def _ashikhmin_shirley(a: np.ndarray) -> np.ndarray:
    return AshikhminShirley(a[3:6], a[6], a[7]).evaluate(a[:3])[0][0]


def _half_vector(a: np.ndarray) -> np.ndarray:
    return sample_half_vector(exponent(a[0]), exponent(a[1]), a[2], a[3])


def _oren_nayar(a: np.ndarray) -> np.ndarray:
    return OrenNayar(a[3:6], a[6], a[7][None]).evaluate(a[:3])[0]


def lobes() -> list[Function]:
    """All of them."""
    bound = closed_forms.BOUND
    return [
        Function(
            FAMILY,
            "Ashikhmin-Shirley lobe",
            (*_DIRECTIONS, *_ALPHAS),
            _powers,
            _ashikhmin_shirley,
            exact_lobes.ashikhmin_shirley,
            bound,
        ),
        Function(
            FAMILY,
            "Ashikhmin-Shirley half vectors",
            (*_ALPHAS, "u1", "u2"),
            _half_vectors,
            _half_vector,
            exact_lobes.ashikhmin_shirley_half_vector,
            inversions.BOUND,
        ),
        Function(
            FAMILY,
            "velvet, normals",
            ("m.x", "m.y", "m.z", "sigma"),
            _velvets,
            lambda a: inverted_gaussian(a[:3], a[3]),
            exact_lobes.inverted_gaussian,
            bound,
        ),
        Function(
            FAMILY,
            "Oren-Nayar",
            (*_DIRECTIONS, "roughness", "color"),
            _rough,
            _oren_nayar,
            exact_lobes.oren_nayar,
            bound,
        ),
        Function(
            FAMILY,
            "Fresnel, conductor without absorption",
            ("cos", "eta", "k"),
            _clear_metals,
            lambda a: fresnel.conductor(*a),
            exact.conductor,
            bound,
        ),
        Function(
            FAMILY,
            "Fresnel, tinted dielectric",
            ("cos", "eta", "f0"),
            _dim_layers,
            lambda a: TintedDielectric(a[1], a[2])(a[0]),
            exact_lobes.tinted_dielectric,
            bound,
        ),
    ]
