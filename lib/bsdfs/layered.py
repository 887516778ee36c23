# SPDX-License-Identifier: GPL-3.0-or-later
"""What layers leave of light for those below them (Blender's Principled BSDF)."""

from __future__ import annotations

import functools

import numpy as np

from ..microfacets.albedo import directional_albedo
from ..microfacets.cycles_tables import Tables, layer_share_cycles
from ..microfacets.layers import layer_albedo, read_albedo, tabulate_albedo
from ..microfacets.thin_film import cycles_sensitivity, exact_sensitivity
from .compensated import albedos_of, multiple_scattering
from .films import Film, FilmDielectric
from .fresnels import reflectance_at_normal, tinted_dielectric


def layer_reflectance(
    cos_o: np.ndarray, alpha: np.ndarray, eta: float, tint: np.ndarray, compensated: bool, lossless: bool = False
) -> np.ndarray:
    """Return the directional albedo (3, n) of a glossy layer of index `eta`.

    `tint` (3, 1) or (3, n); `cos_o` (n,); `alpha` () or (n,).

    The albedo is that of the lobe itself, `compensated` for multiple scattering where the lobe is: nothing is lost
    between layers. `lossless` takes the light that facets hand to each other for reflected: the albedo divided by
    E + Fms (1 - E), a departure of Cycles.
    """
    if eta == 1.0:
        return np.zeros((3, cos_o.size))
    curve = tinted_dielectric(np.asarray(eta), tint)
    from_normal, to_grazing = layer_albedo(cos_o, alpha, eta)
    albedo = curve.f0 * from_normal + to_grazing
    if lossless:
        return albedo / directional_albedo(cos_o, alpha)
    return albedo * multiple_scattering(cos_o, alpha, curve.average) if compensated else albedo


def layer_reflectance_cycles(
    cos_o: np.ndarray,
    alpha: np.ndarray,
    eta: float,
    tint: np.ndarray,
    compensated: bool,
    lossless: bool,
    tables: Tables,
) -> np.ndarray:
    """Return the directional albedo of a glossy layer as Cycles estimates it.

    It is f0 + (1 - f0) times `layer_share_cycles`, from `tables`, as if single scattering lost nothing.

    What the compensation takes from coloured light, 1 less E + Fms (1 - E), is taken off again, unless `lossless`.
    """
    curve = tinted_dielectric(np.asarray(eta), tint)
    albedo = curve.f0 + (1.0 - curve.f0) * layer_share_cycles(cos_o, alpha, eta, tables)
    if lossless or not compensated:
        return albedo
    scattering = multiple_scattering(cos_o, alpha, curve.average_cycles, albedos_of(tables))
    return albedo * scattering * tables.directional_albedo(cos_o, alpha)


def film_layer_reflectance(
    cos_o: np.ndarray,
    alpha: np.ndarray,
    eta: float,
    tint: np.ndarray,
    compensated: bool,
    film: Film,
    tables: Tables | None = None,
) -> np.ndarray:
    """The same for a layer under a thin film, whose thickness and index are single numbers.

    With `tables` as Cycles takes it: the reflectance of a smooth surface, in place of the mean over facets.
    """
    curve = FilmDielectric(film, np.asarray(eta), np.clip(reflectance_at_normal(np.asarray(eta)) * tint, 0.0, 1.0))
    if tables is not None:
        albedo = curve(np.clip(cos_o, 0.0, 1.0))
        if not compensated:
            return albedo
        scattering = multiple_scattering(cos_o, alpha, curve.average_cycles, albedos_of(tables))
        return albedo * scattering * tables.directional_albedo(cos_o, alpha)
    how = float(eta), float(film.thickness), float(film.index), film.to.orders is None
    albedo = np.stack([read_albedo(table, cos_o, alpha) for table in _film_tables(*how, 0)])
    if np.any(curve.tint != 1.0):
        tinted = np.stack([read_albedo(table, cos_o, alpha) for table in _film_tables(*how, 1)])
        albedo = albedo + (curve.tint - 1.0) * tinted
    return albedo * multiple_scattering(cos_o, alpha, curve.average) if compensated else albedo


@functools.lru_cache(maxsize=32)
def _film_tables(eta: float, thickness: float, index: float, exact: bool, part: int) -> list[np.ndarray]:
    """Tabulate the albedo of one of `FilmDielectric.parts` for each colour.

    The parts are interpolated between 4,097 cosines.
    """
    film = Film(np.asarray(thickness), np.asarray(index), exact_sensitivity() if exact else cycles_sensitivity())
    cosines = np.linspace(0.0, 1.0, 4097)
    curves = FilmDielectric(film, np.asarray(eta), reflectance_at_normal(np.full((3, 1), eta))).parts(cosines)[part]
    return [tabulate_albedo(functools.partial(np.interp, xp=cosines, fp=curve)) for curve in curves]


def beneath_layer(
    distribution: str,
    eta: float,
    tint: np.ndarray,
    roughness: np.ndarray,
    weight: np.ndarray,
    cos_wo: np.ndarray,
    tables: Tables | None = None,
    lossless: bool = False,
    film: Film | None = None,
) -> np.ndarray:
    """Return the share of light, (n,), at least 0, that a layer leaves for those below it.

    It is 1 - weight times the largest colour of the layer's albedo; under a `film`, if one is given.

    The largest is taken, so that a tinted layer leaves no tint of its complement below (Blender's choice). With `tables` the
    albedo is Cycles' estimate; `lossless` as in `layer_reflectance`.
    """
    alpha = np.clip(roughness, 0.0, 1.0) ** 2
    compensated = distribution == "MULTI_GGX"
    if film is not None:
        albedo = film_layer_reflectance(cos_wo, alpha, eta, tint, compensated, film, tables)
    elif tables is None:
        albedo = layer_reflectance(cos_wo, alpha, eta, tint, compensated, lossless)
    else:
        albedo = layer_reflectance_cycles(cos_wo, alpha, eta, tint, compensated, lossless, tables)
    return np.maximum(1.0 - weight * albedo.max(axis=0), 0.0)


def coat_tint(ior: np.ndarray, tint: np.ndarray, weight: np.ndarray, cos_wo: np.ndarray) -> np.ndarray:
    """Return the tint of a coat of thickness 1, (3, n), by Beer's law.

    It is (1 - weight) + weight tint^(1 / cos), along the refracted direction to the viewer.
    """
    ior = np.maximum(ior, 1.0)
    inside = np.sqrt((ior - 1.0) * (ior + 1.0) + cos_wo * cos_wo) / ior
    return (1.0 - weight) + weight * np.maximum(tint, 0.0) ** (1.0 / inside)
