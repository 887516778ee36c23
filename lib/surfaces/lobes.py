# SPDX-License-Identifier: GPL-3.0-or-later
"""From closures to lobes at surface points: a dictionary, closure type -> builder."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ..bsdfs.compensated import Compensated, albedos_of, multiple_scattering
from ..bsdfs.dielectric import Interface, RoughDielectric, SmoothInterface
from ..bsdfs.films import Film, FilmConductor, FilmDielectric, FilmF82, make_film, under_film
from ..bsdfs.fresnels import (
    F82,
    Conductor,
    CyclesFresnel,
    Dielectric,
    Fresnel,
    TintedDielectric,
    reflectance_at_normal,
    tinted_dielectric,
)
from ..bsdfs.lambert import Lambert, LambertTransmission
from ..bsdfs.lobe import Lobe
from ..bsdfs.microfacet import MicrofacetReflection
from ..bsdfs.oren_nayar import OrenNayar
from ..bsdfs.reflected import Reflected
from ..bsdfs.rotated import Rotated, rotate_in
from ..bsdfs.sheen import Sheen as SheenLobe
from ..bsdfs.specular import Mirror, SmoothDielectric
from ..bsdfs.tilted import Tilted
from ..bsdfs.toon import Toon as ToonLobe
from ..bsdfs.velvet import Velvet as VelvetLobe
from ..departures.closures import ashikhmin_shirley_form, distribution_form, oren_nayar_form, with_stated_density
from ..departures.light_below import LIGHT_BELOW, hold_against_face
from ..microfacets.cycles_tables import Tables, average_glass_albedo_cycles, glass_albedo_cycles
from ..microfacets.dispersion import cauchy_index
from ..microfacets.distribution import Distribution
from ..microfacets.layers import average_glass_albedo, glass_albedo
from ..sampling.wavelengths import NODES
from ..scattering.subsurface import LEAST_RADIUS
from ..scene.expressions import Expression
from ..scene.materials import (
    Anisotropic,
    Closure,
    Diffuse,
    Glass,
    Glossy,
    GlossyToon,
    Metallic,
    Microfacets,
    Refraction,
    Sheen,
    Specular,
    Subsurface,
    Toon,
    Translucent,
    Velvet,
)
from ..settings.reference import Options
from ..textures.evaluate import Evaluator
from ..textures.fold import is_constant
from ..vectors import dot, orthonormal_basis, to_local
from .models import distribution_of, empirical_form, fresnel_curve
from .surface import SurfacePoints

# Below this product of the alphas a lobe is a mirror, as in Cycles (bsdf_microfacet.h); D(0) would exceed 1.6e9.
MIRROR_ALPHA_PRODUCT = 2e-10
_FLOOR = float(np.sqrt(MIRROR_ALPHA_PRODUCT))
# An index this close to 1 bends nothing, as in Cycles.
_LEAST_CONTRAST = 1e-4


@dataclass(frozen=True)
class Site:
    """Points of one material, where the sockets of its closures are evaluated.

    `read` evaluates a socket. `wo` (3, n) is local to the frame (t, s, n), (3, n) each.

    `tables`: those of Cycles, where multiple scattering departs by them.
    """

    points: SurfacePoints
    read: Evaluator
    wo: np.ndarray
    t: np.ndarray
    s: np.ndarray
    n: np.ndarray
    options: Options
    tables: Tables | None = None


def build(closure: Closure, site: Site) -> tuple[Lobe, np.ndarray]:
    """The lobe of a closure and the colour, (3, 1) or (3, n), that multiplies it."""
    normal: Expression | None = getattr(closure, "normal", None)
    if normal is None and LIGHT_BELOW not in site.options.departures:
        return _BUILDERS[type(closure)](closure, site)
    n = site.n if normal is None else np.broadcast_to(site.read(normal), site.n.shape)
    t, s = orthonormal_basis(n)
    turned = replace(site, wo=to_local(site.points.wo, t, s, n), t=t, s=s, n=n)
    lobe, color = _BUILDERS[type(closure)](closure, turned)
    rows = np.stack([to_local(axis, site.t, site.s, site.n) for axis in (t, s, n)])
    if LIGHT_BELOW not in site.options.departures:
        return Tilted(lobe, rows), color
    return hold_against_face(lobe, rows, to_local(site.points.ng, site.t, site.s, site.n), closure), color


def _diffuse(closure: Diffuse, site: Site) -> tuple[Lobe, np.ndarray]:
    roughness, color = np.clip(site.read(closure.roughness), 0.0, 1.0), site.read(closure.color)
    if not np.any(roughness):
        return Lambert(), color
    first = oren_nayar_form(site.options.departures)
    # What scatters again has a colour of at most 1, as in Cycles; what leaves is multiplied by the colour as it is.
    return OrenNayar(site.wo, roughness, np.clip(color, 0.0, 1.0), first), np.where(
        color < 0.0, 0.0, np.maximum(color, 1.0)
    )


def _glossy(closure: Glossy, site: Site) -> tuple[Lobe, np.ndarray]:
    anisotropy = np.clip(site.read(closure.anisotropy), -0.99, 0.99)
    stretch = None if not np.any(np.abs(anisotropy) > 1e-4) else glossy_stretch(anisotropy)
    curve, color = fresnel_curve(closure.fresnel, site.read(closure.color))
    lobe, alpha = _reflection(closure, stretch, site)
    if curve is None:
        return _compensated(lobe, closure.distribution, alpha, np.maximum(color, 0.0), site), color
    tone = curve.average * np.maximum(color, 0.0)
    return _compensated(Reflected(lobe, site.wo, curve), closure.distribution, alpha, tone, site), color


def _metallic(closure: Metallic, site: Site) -> tuple[Lobe, np.ndarray]:
    base, edge, film = site.read(closure.base), site.read(closure.edge), _film(closure, site)
    if closure.fresnel == "CONDUCTOR":
        eta, k = np.maximum(base, 0.0), np.maximum(edge, 0.0)
        curve = Conductor(eta, k) if film is None else under_film(FilmConductor(film, eta, k))
    else:
        f0, tint = np.clip(base, 0.0, 1.0), np.clip(edge, 0.0, 1.0)
        curve = F82(f0, tint) if film is None else under_film(FilmF82(film, f0, tint))
    return _fresnel_reflection(closure, curve, site), np.ones((3, 1))


def _specular(closure: Specular, site: Site) -> tuple[Lobe, np.ndarray]:
    ior, tint = np.maximum(site.read(closure.ior), 1e-5), np.maximum(site.read(closure.tint), 0.0)
    curve, film = tinted_dielectric(ior, tint), _film(closure, site)
    if film is not None:
        curve = under_film(FilmDielectric(film, ior, curve.f0))
    return _fresnel_reflection(closure, curve, site), np.ones((3, 1))


def _fresnel_reflection(closure: Metallic | Specular, curve: CyclesFresnel, site: Site) -> Lobe:
    """Return microfacets that reflect by `curve`.

    The stretch is that of Blender's Metallic and Principled BSDF.
    """
    anisotropy = np.clip(site.read(closure.anisotropy), 0.0, 1.0)
    stretch = np.sqrt(1.0 - 0.9 * anisotropy) if np.any(anisotropy) else None
    lobe, alpha = _reflection(closure, None if stretch is None else (1.0 / stretch, stretch), site)
    average = curve.average if site.tables is None else curve.average_cycles
    return _compensated(Reflected(lobe, site.wo, curve), closure.distribution, alpha, average, site)


def _alphas(
    closure: Microfacets, stretch: tuple[np.ndarray, np.ndarray] | None, site: Site
) -> tuple[np.ndarray, np.ndarray]:
    """Roughness squared along x and y, each at most 1."""
    alpha = np.clip(site.read(closure.roughness), 0.0, 1.0) ** 2
    if stretch is None:
        return alpha, alpha
    return np.minimum(alpha * stretch[0], 1.0), np.minimum(alpha * stretch[1], 1.0)


def _reflection(
    closure: Anisotropic, stretch: tuple[np.ndarray, np.ndarray] | None, site: Site
) -> tuple[Lobe, np.ndarray]:
    """Return white microfacet reflection, and the geometric mean of its alphas.

    Its alpha is stretched by two factors.
    """
    alpha_x, alpha_y = _alphas(closure, stretch, site)
    if closure.distribution == "ASHIKHMIN_SHIRLEY":
        form = ashikhmin_shirley_form(site.options.departures)
        lobe = _turned(closure, stretch, site, lambda wo: form(wo, alpha_x, alpha_y))
        return lobe, np.sqrt(alpha_x * alpha_y)
    if np.all(alpha_x * alpha_y <= MIRROR_ALPHA_PRODUCT):
        return Mirror(site.wo), np.sqrt(alpha_x * alpha_y)
    alpha_x, alpha_y = (
        np.maximum(alpha_x, _FLOOR),
        np.maximum(alpha_y, _FLOOR),
    )  # where a texture reaches zero roughness
    form = empirical_form(closure.distribution)
    if form is not None:
        return _turned(closure, stretch, site, lambda wo: form(wo, alpha_x, alpha_y)), np.sqrt(alpha_x * alpha_y)
    options, distribution = site.options, _distribution(closure, site.options)

    def make(wo: np.ndarray) -> Lobe:
        lobe = MicrofacetReflection(wo, alpha_x, alpha_y, distribution, _masking(options), options.strategy)
        if options.strategy == "visible":
            return with_stated_density(lobe, distribution, wo, alpha_x, alpha_y, options.departures)
        return lobe

    return _turned(closure, stretch, site, make), np.sqrt(alpha_x * alpha_y)


def _turned(closure: Microfacets, stretch: object, site: Site, make: Callable[[np.ndarray], Lobe]) -> Lobe:
    """Return the lobe that `make` returns for wo.

    Where the lobe is stretched, it is in the frame of the closure's tangent.
    """
    if stretch is None or not isinstance(closure, Anisotropic):
        return make(site.wo)
    tangent, _ = site.points.tangent(closure.tangent, site.read(closure.rotation), site.n)
    cos, sin = dot(tangent, site.t), dot(tangent, site.s)
    return Rotated(make(rotate_in(site.wo, cos, sin)), cos, sin)


def _compensated(lobe: Lobe, distribution: str, alpha: np.ndarray, color: np.ndarray, site: Site) -> Lobe:
    """Return the lobe, compensated for lost light if the distribution is Multiscatter GGX.

    `color` is that of one bounce.
    """
    if distribution != "MULTI_GGX" or lobe.delta:
        return lobe
    return Compensated(lobe, multiple_scattering(site.wo[2], alpha, color, albedos_of(site.tables)))


def _glass(closure: Glass, site: Site) -> tuple[Lobe, np.ndarray]:
    color = site.read(closure.color)
    reflection, transmission = (np.maximum(site.read(tint), 0.0) for tint in (closure.reflection, closure.transmission))
    eta, curve = _dielectric(closure, site)
    interface = Interface(curve, reflection, transmission)
    anisotropy = np.clip(site.read(closure.anisotropy), -0.99, 0.99)
    stretch = glossy_stretch(anisotropy) if np.any(anisotropy) else None
    lobe = _interface(closure, interface, eta, stretch, site)
    if closure.distribution == "MULTI_GGX" and not lobe.delta:
        alpha_x, alpha_y = _alphas(closure, stretch, site)
        alpha = alpha_x if stretch is None else np.sqrt(alpha_x * alpha_y)
        lobe = Compensated(lobe, _glass_scattering(closure, site, alpha, transmission))
    return lobe, color


def _dielectric(closure: Glass, site: Site) -> tuple[np.ndarray, Fresnel]:
    """Return the relative index (n,) and the reflectance of a dielectric.

    The index is that of the far side over the near side, at the light's wavelength where it depends on that.
    """
    ior, tint = np.maximum(site.read(closure.ior), 1e-5), np.maximum(site.read(closure.tint), 0.0)
    dispersion, wavelength = site.read(closure.dispersion), site.points.wavelength
    disperses = wavelength is not None and np.any(dispersion)
    index = cauchy_index(ior, dispersion, wavelength) if wavelength is not None and disperses else ior
    eta = np.where(site.points.backfacing, 1.0 / index, index)
    undispersed = disperses and "undispersed reflectance" in site.options.departures
    film = _film(closure, site)
    if film is not None:
        outside = np.where(site.points.backfacing, index, 1.0)
        film = replace(film, index=film.index / outside)
        if "thin film from inside" not in site.options.departures:
            film = replace(film, outside=outside)
        return eta, FilmDielectric(
            film, eta, np.clip(reflectance_at_normal(ior if undispersed else eta) * tint, 0.0, 1.0)
        )
    if undispersed:
        return eta, TintedDielectric(eta, np.clip(reflectance_at_normal(ior) * tint, 0.0, 1.0))
    return eta, Dielectric(eta) if np.all(tint == 1.0) else tinted_dielectric(eta, tint)


def _film(closure: Metallic | Specular | Glass, site: Site) -> Film | None:
    """Return the film on a closure, or None where there is none anywhere.

    The film's index is that over the index outside.
    """
    by_table = "thin film series" in site.options.departures
    return make_film(site.read(closure.film_thickness), site.read(closure.film_ior), by_table)


def _refraction(closure: Refraction, site: Site) -> tuple[Lobe, np.ndarray]:
    ior = np.maximum(site.read(closure.ior), 1e-5)
    eta = np.where(site.points.backfacing, 1.0 / ior, ior)
    white = np.ones((3, 1))
    return _interface(closure, Interface(None, white, white), eta, None, site), site.read(closure.color)


def _interface(
    closure: Glass | Refraction,
    interface: Interface,
    eta: np.ndarray,
    stretch: tuple[np.ndarray, np.ndarray] | None,
    site: Site,
) -> Lobe:
    """A smooth or rough interface, its alpha stretched by two factors."""
    alpha_x, alpha_y = _alphas(closure, stretch, site)
    if np.all(alpha_x * alpha_y <= MIRROR_ALPHA_PRODUCT) or np.all(np.abs(eta - 1.0) < _LEAST_CONTRAST):
        if interface.is_plain:
            return SmoothDielectric(site.wo, eta, interface.fresnel is not None)
        return SmoothInterface(site.wo, eta, interface)
    eta = np.where(np.abs(eta - 1.0) < _LEAST_CONTRAST, 1.0 + _LEAST_CONTRAST, eta)
    alpha_x, alpha_y = np.maximum(alpha_x, _FLOOR), np.maximum(alpha_y, _FLOOR)
    backs = "refraction from behind" in site.options.departures
    distribution = _distribution(closure, site.options)

    def make(wo: np.ndarray) -> Lobe:
        lobe = RoughDielectric(wo, alpha_x, alpha_y, eta, distribution, interface, _masking(site.options), backs)
        return with_stated_density(lobe, distribution, wo, alpha_x, alpha_y, site.options.departures)

    return _turned(closure, stretch, site, make)


def _glass_scattering(closure: Glass, site: Site, alpha: np.ndarray, color: np.ndarray) -> np.ndarray:
    """Return `multiple_scattering` with the albedo of the whole interface, (3, n).

    The albedo is that from either side of the interface.

    Where the index depends on the wavelength, it is quadratic in the index through three that span the spectrum
    (Chebyshev's): to 1e-4 for Abbe numbers from 20 on.
    """
    ior, dispersion, wavelength = _number(closure.ior), _number(closure.dispersion), site.points.wavelength
    if wavelength is None or not dispersion:
        return _scattering_of_index(site, alpha, ior, color)
    first, last = cauchy_index(ior, dispersion, NODES[[-1, 0]])
    nodes = 0.5 * (first + last) + 0.5 * (last - first) * np.cos(np.pi * np.array([1.0, 3.0, 5.0]) / 6.0)
    index = cauchy_index(ior, dispersion, wavelength)
    factor = np.zeros((3, site.points.size))
    for node in nodes if first != last else nodes[:1]:  # an index of 1 stays 1
        basis = [(index - other) / (node - other) for other in nodes if other != node]
        factor += np.prod(basis, axis=0) * _scattering_of_index(site, alpha, node, color)
    return factor


def _number(socket: Expression) -> float:
    """Return the number of a socket that the exporter keeps constant.

    It does so where lost light is given back. Raises TypeError for a socket that is not constant.
    """
    if not is_constant(socket):
        raise TypeError(f"{socket} is not constant")
    return socket.number


def _scattering_of_index(site: Site, alpha: np.ndarray, ior: float, color: np.ndarray) -> np.ndarray:
    """The factor of an interface of one index, (3, n)."""
    directional, mean = glass_albedo, average_glass_albedo
    if site.tables is not None:
        directional = partial(glass_albedo_cycles, tables=site.tables)
        mean = partial(average_glass_albedo_cycles, tables=site.tables)
    factor = np.ones((3, site.points.size))
    outside = float(max(ior, 1e-5))
    for side, eta in ((~site.points.backfacing, outside), (site.points.backfacing, 1.0 / outside)):
        index = np.flatnonzero(side)
        if index.size:
            rough = np.take(np.broadcast_to(alpha, side.shape), index)
            lost = 1.0 / directional(site.wo[2, index], rough, eta) - 1.0
            average = mean(rough, eta)
            tone = color if color.shape[1] == 1 else np.take(color, index, axis=1)
            factor[:, index] += tone * average / (1.0 - tone * (1.0 - average)) * lost
    return factor


def _shallow(closure: Subsurface, site: Site) -> tuple[Lobe, np.ndarray]:
    """What the channels whose radius is too small to enter do."""
    return Lambert(), site.read(closure.color) * (site.read(closure.radius) < LEAST_RADIUS)


def _toon(closure: Toon, site: Site) -> tuple[Lobe, np.ndarray]:
    size, smooth = site.read(closure.size), site.read(closure.smooth)
    return ToonLobe(site.wo, size, smooth, isinstance(closure, GlossyToon)), site.read(closure.color)


def _masking(options: Options) -> str:
    """The form of masking, by departure or by choice."""
    return "correlated" if "correlated masking" in options.departures else options.masking


def _distribution(closure: Anisotropic | Refraction, options: Options) -> Distribution:
    """The distribution of a closure's normals, as it departs."""
    return distribution_form(distribution_of(closure.distribution), options.departures)


def glossy_stretch(anisotropy: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the factors on alpha along x and y for an anisotropy in (-1, 1).

    They are those of Blender's Glossy and Glass BSDF (Cycles, svm/closure.h).
    """
    stretch = np.where(anisotropy < 0.0, 1.0 / (1.0 + anisotropy), 1.0 - anisotropy)
    return stretch, 1.0 / stretch


_BUILDERS: dict[type[Closure], Callable[..., tuple[Lobe, np.ndarray]]] = {
    Diffuse: _diffuse,
    Glossy: _glossy,
    Metallic: _metallic,
    Specular: _specular,
    Translucent: lambda closure, site: (LambertTransmission(), site.read(closure.color)),
    Glass: _glass,
    Refraction: _refraction,
    Subsurface: _shallow,
    Sheen: lambda closure, site: (SheenLobe(site.wo, site.read(closure.roughness)), site.read(closure.color)),
    Velvet: lambda closure, site: (VelvetLobe(site.wo, site.read(closure.sigma)), site.read(closure.color)),
    Toon: _toon,
    GlossyToon: _toon,
}
