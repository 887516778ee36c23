# SPDX-License-Identifier: GPL-3.0-or-later
"""The catalogue of inversions, component by component.

Inversions go from uniforms to directions and places.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..lights.cone import uniform_cone
from ..lights.rectangle import SMALLEST_SOLID_ANGLE
from ..lights.spherical_rectangle import SphericalRectangle
from ..microfacets.beckmann import Beckmann
from ..microfacets.ggx import GGX
from ..microfacets.student_t import StudentT
from ..sampling.warps import cosine_hemisphere, uniform_hemisphere
from . import cycles_inversions, domain, exact_inversions, single
from .closed_forms import STUDENT_SHAPES
from .measure import Function, Single

BOUND = 32.0
FAMILY = "inversion"
_ALPHAS = ("alpha_x", "alpha_y")
_UNIFORMS = ("u1", "u2")
_WO = ("wo.x", "wo.y", "wo.z")


def _squares(rng: np.random.Generator, count: int) -> np.ndarray:
    return domain.uniforms(rng, count, 2)


def _lobes(rng: np.random.Generator, count: int) -> np.ndarray:
    return np.concatenate([domain.alphas(rng, count), _squares(rng, count)])


def _isotropic(rng: np.random.Generator, count: int) -> np.ndarray:
    alpha = domain.alphas(rng, count)[:1]
    return np.concatenate([alpha, alpha, _squares(rng, count)])


def _seen_lobes(rng: np.random.Generator, count: int) -> np.ndarray:
    return np.concatenate([domain.directions(rng, count), _lobes(rng, count)])


def _cones(rng: np.random.Generator, count: int) -> np.ndarray:
    """Axes all round the sphere; 1 - cos from 1e-18 to a half space."""
    axis = domain.directions(rng, count)
    axis[2] *= rng.choice([-1.0, 1.0], count)
    one_minus_cos = 10.0 ** rng.uniform(-18.0, 0.0, (1, count))
    return np.concatenate([axis, one_minus_cos, _squares(rng, count)])


def _rectangles(rng: np.random.Generator, count: int) -> np.ndarray:
    """Rectangles that are sampled by solid angle, from the smallest to a half space."""
    found = np.empty((7, 0))
    while found.shape[1] < count:
        size, height = 10.0 ** rng.uniform(-3.0, 2.0, (2, count)), 10.0 ** rng.uniform(-4.0, 2.0, count)
        offset = rng.choice([-1.0, 0.0, 1.0], (2, count)) * 10.0 ** rng.uniform(-2.0, 2.0, (2, count))
        low = offset - size * rng.random((2, count))
        high = low + size
        bounds = np.stack([low[0], high[0], low[1], high[1], height])
        seen = SphericalRectangle(*bounds).solid_angle >= SMALLEST_SOLID_ANGLE
        found = np.concatenate([found, np.concatenate([bounds, _squares(rng, count)])[:, seen]], axis=1)
    return found[:, :count]


def _uniform_of_one(a: np.ndarray) -> np.ndarray:
    """u1 counts to the last place of 1: 1 - u1 is what is inverted."""
    sizes = np.abs(a)
    sizes[5] = 1.0
    return sizes


def _end_of_cap(a: np.ndarray) -> np.ndarray:
    """The digits that are lost where u2 nears 1.

    The cap's point nears -wo there: their sum keeps 1 / (q max(z, q)) fewer digits, q = (1 - u2) (1 + z).
    """
    x, y, z, alpha_x, alpha_y, _, u2 = a
    z = z / np.sqrt((x * alpha_x) ** 2 + (y * alpha_y) ** 2 + z * z)
    q = (1.0 - u2) * (1.0 + z)
    return 2.0 / (q * np.maximum(z, q))


def _uniform_of_circle(a: np.ndarray) -> np.ndarray:
    """u1 counts to the last place of an angle of order 1, of which the solid angle is a part."""
    sizes = np.abs(a)
    sizes[5] = 2.0 * np.pi / SphericalRectangle(*a[:5]).solid_angle
    return sizes


def _cone(a: np.ndarray) -> np.ndarray:
    return uniform_cone(a[:3], a[3], a[4], a[5])[0]


def _place(a: np.ndarray) -> np.ndarray:
    return np.stack(SphericalRectangle(*a[:5]).place(a[5], a[6]))


def _entry(
    title: str,
    names: tuple[str, ...],
    draw: Callable,
    kernel: Callable,
    form: str,
    printed: bool = False,
    sizes: Callable[[np.ndarray], np.ndarray] | None = None,
    slack: Callable[[np.ndarray], np.ndarray] | None = None,
    excuse: str = "",
) -> Function:
    written = Single(getattr(single, form)) if printed else None
    theirs = getattr(cycles_inversions, form, None)
    cycles = Single(theirs, getattr(cycles_inversions, f"{form}_truth")) if theirs else None
    truth = getattr(exact_inversions, form)
    return Function(FAMILY, title, names, draw, kernel, truth, BOUND, written, cycles, sizes, slack, excuse)


def inversions() -> list[Function]:
    """All of them, subject by subject."""
    return [*_warps(), *_normals(), *_lights()]


def _warps() -> list[Function]:
    square = _UNIFORMS
    return [
        _entry("Lambert, cosine", square, _squares, lambda a: cosine_hemisphere(*a), "cosine_hemisphere", True),
        _entry("uniform hemisphere", square, _squares, lambda a: uniform_hemisphere(*a), "uniform_hemisphere", True),
    ]


def _normals() -> list[Function]:
    """Normals of the microfacet distributions."""
    lobe = (*_ALPHAS, *_UNIFORMS)
    seen = (*_WO, *lobe)
    return [
        _entry("Beckmann D cos", lobe, _isotropic, lambda a: Beckmann().sample_d_cos(*a), "beckmann_d_cos", True),
        _entry("GGX D cos", lobe, _isotropic, lambda a: GGX().sample_d_cos(*a), "ggx_d_cos", True),
        _entry("Beckmann D cos, anisotropic", lobe, _lobes, lambda a: Beckmann().sample_d_cos(*a), "beckmann_d_cos"),
        _entry("GGX D cos, anisotropic", lobe, _lobes, lambda a: GGX().sample_d_cos(*a), "ggx_d_cos"),
        *(
            Function(
                FAMILY,
                f"Student-t D cos, g = {g:g}",
                lobe,
                _lobes,
                lambda a, g=g: StudentT(g).sample_d_cos(*a),
                exact_inversions.student_d_cos(g),
                BOUND,
            )
            for g in STUDENT_SHAPES
        ),
        _entry(
            "GGX visible normals",
            seen,
            _seen_lobes,
            lambda a: GGX().sample_visible(a[:3], *a[3:]),
            "ggx_visible",
            slack=_end_of_cap,
            excuse="the cap's point is added to wo, which it all but cancels as u2 nears 1; without that difference a sample takes "
            "13 ns more, a third, for the few normals that gain",
        ),
        _entry(
            "GGX bounded visible normals",
            seen,
            _seen_lobes,
            lambda a: GGX().sample_bounded(a[:3], *a[3:]),
            "ggx_bounded",
            slack=_end_of_cap,
            excuse="as for GGX visible normals, where the bound is loose",
        ),
        _entry(
            "Beckmann visible normals",
            seen,
            _seen_lobes,
            lambda a: Beckmann().sample_visible(a[:3], *a[3:]),
            "beckmann_visible",
            sizes=_uniform_of_one,
            excuse="the mass above a slope, 1 - u1, is what is inverted: u1 counts to the last place of 1, not to its own",
        ),
    ]


def _lights() -> list[Function]:
    rectangle = ("x0", "x1", "y0", "y1", "height", *_UNIFORMS)
    return [
        _entry("cone about a light", ("x", "y", "z", "1 - cos", *_UNIFORMS), _cones, _cone, "uniform_cone"),
        _entry(
            "place on a rectangle light",
            rectangle,
            _rectangles,
            _place,
            "rectangle_place",
            sizes=_uniform_of_circle,
            excuse="a difference of angles of order 1 is inverted: u1 counts to the last place of 1 / solid angle; a second step, "
            "60 ns a sample, would move no place by more than 1e-9 of the light",
        ),
    ]
