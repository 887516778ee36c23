# SPDX-License-Identifier: GPL-3.0-or-later
"""Reflectances of surfaces under a thin film (Blender's Thin Film sockets).

See lib/microfacets/thin_film.py.

Called with cosines (n,) they give colours (3, n). `thickness` in nm and the film's `index` are () or (n,).
Where the film is thinner than 0.1 nm there is none.
"""

from __future__ import annotations

import functools
from abc import ABC, abstractmethod
from dataclasses import dataclass, field, fields
from typing import Self

import numpy as np
from scipy.special import roots_legendre

from ..microfacets import fresnel
from ..microfacets.thin_film import (
    LEAST_THICKNESS,
    Sensitivity,
    amplitudes,
    cosine_in_film,
    cycles_sensitivity,
    exact_sensitivity,
    film_color,
    film_index,
)
from .fresnels import F82, Conductor, CyclesFresnel, TintedDielectric, part_of, reflectance_at_normal

LEAST_INDEX = 1e-5
_LARGEST_F0 = 0.999
_NODES = 8193


@dataclass(frozen=True)
class Film:
    """A thin film: its `thickness` and its `index` over the index outside.

    It also holds the transform of colours by which it is summed.

    `outside` is the index there, () or (n,): wavelengths are those of the vacuum.
    """

    thickness: np.ndarray
    index: np.ndarray
    to: Sensitivity
    outside: np.ndarray = field(default_factory=lambda: np.ones(()))

    def part(self, index: np.ndarray) -> Film:
        """The same at fewer points."""
        return Film(part_of(self.thickness, index), part_of(self.index, index), self.to, part_of(self.outside, index))


def make_film(thickness: np.ndarray, index: np.ndarray, by_table: bool) -> Film | None:
    """Make a film; return None where it is nowhere thick enough to be one.

    `by_table` sums it as Cycles does, which is a departure.
    """
    if not np.any(np.asarray(thickness) > LEAST_THICKNESS):
        return None
    thickness, index = np.maximum(thickness, 0.0), np.maximum(index, LEAST_INDEX)
    return Film(thickness, index, cycles_sensitivity() if by_table else exact_sensitivity())


@dataclass(frozen=True)
class _UnderFilm(ABC):
    """A reflectance under a film: with what is below it and without, point by point."""

    film: Film

    @property
    @abstractmethod
    def bare(self) -> CyclesFresnel:
        """The surface without the film."""

    @abstractmethod
    def _covered(self, cos: np.ndarray) -> np.ndarray:
        """Reflectance (3, n) under the film."""

    @abstractmethod
    def _below(self, inside: np.ndarray, index: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """Squared amplitude and phase of both polarisations at the surface below."""

    def __call__(self, cos: np.ndarray) -> np.ndarray:
        """Reflectance, (3, n)."""
        bare = np.broadcast_to(self.bare(cos), (3, cos.size))
        covered = np.broadcast_to(self.film.thickness > LEAST_THICKNESS, cos.shape)
        return np.where(covered, self._covered(cos), bare) if covered.any() else bare

    def _reflected(self, cos: np.ndarray) -> np.ndarray:
        """The mean of both polarisations, 1 beyond the film's critical angle, in [0, 1]."""
        film = self.film
        index = film_index(film.index, film.thickness)
        inside, total = cosine_in_film(cos, index)
        difference = np.broadcast_to(2.0 * film.outside * index * film.thickness * inside, cos.shape)
        color = np.zeros((3, cos.size))
        for first, (power, phase) in zip(amplitudes(cos, inside, index), self._below(inside, index), strict=True):
            color += 0.5 * film_color(first, power, phase, difference, film.to)
        return np.where(total, 1.0, np.clip(color, 0.0, 1.0))

    @property
    def average(self) -> np.ndarray:
        """Integral of 2 c F(c) over c, (3, 1) or (3, n)."""
        node, weight = roots_legendre(24)
        own = (getattr(self, f.name) for f in fields(self) if f.name != "film")
        size = max(np.shape(v)[-1] if np.ndim(v) else 1 for v in (*own, self.film.thickness, self.film.index))
        cosines = 0.5 + 0.5 * node
        terms = (w * c * self(np.full(size, c)) for c, w in zip(cosines, weight, strict=True))
        return sum(terms, start=np.zeros((3, 1)))

    @property
    def average_cycles(self) -> np.ndarray:
        """What Cycles takes for it: that without the film."""
        return self.bare.average_cycles

    def part(self, index: np.ndarray) -> Self:
        """The same at fewer points."""
        own = {f.name: part_of(getattr(self, f.name), index) for f in fields(self) if f.name != "film"}
        return type(self)(film=self.film.part(index), **own)


@dataclass(frozen=True)
class FilmConductor(_UnderFilm):
    """A metal of complex index `eta` + i `k`, (3, 1) or (3, n), under a film."""

    eta: np.ndarray
    k: np.ndarray

    @property
    def bare(self) -> Conductor:
        """The metal without the film."""
        return Conductor(self.eta, self.k)

    def _covered(self, cos: np.ndarray) -> np.ndarray:
        return self._reflected(cos)

    def _below(self, inside: np.ndarray, index: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """Squared amplitude and phase of both polarisations at the metal."""
        return [(np.square(np.abs(r)), _phase(r)) for r in _metal(inside, self.eta, self.k, index)]


@dataclass(frozen=True)
class FilmF82(_UnderFilm):
    """A metal of the F82 curve from `f0` and `tint`, (3, 1) or (3, n), under a film.

    Blender's definition: Gulbrandsen 2014, "Artist friendly metallic Fresnel", eq. 4 to 7, gives an index for f0 and the reflectance at
    the cosine 1/7. The film sees the F82 curve from the reflectance at normal incidence of that index in the film, and the index's phases.
    """

    f0: np.ndarray
    tint: np.ndarray

    @property
    def bare(self) -> F82:
        """The metal without the film."""
        return F82(self.f0, self.tint)

    def _edge(self) -> np.ndarray:
        return self.bare(np.full(1, 1.0 / 7.0))

    def _index(self) -> tuple[np.ndarray, np.ndarray]:
        r, g = np.minimum(self.f0, _LARGEST_F0), self._edge()
        root = np.sqrt(r)
        n = (1.0 - g) * (1.0 + root) / (1.0 - root) + g * (1.0 - r) / (1.0 + r)
        return n, np.sqrt(np.maximum(r * np.square(n + 1.0) - np.square(n - 1.0), 0.0) / (1.0 - r))

    def _covered(self, cos: np.ndarray) -> np.ndarray:
        return self._reflected(cos)

    def _below(self, inside: np.ndarray, index: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """Squared amplitude and phase of both polarisations at the metal."""
        n, k = self._index()
        away, square = n / index, np.square(k / index)
        f0 = (np.square(away - 1.0) + square) / (np.square(away + 1.0) + square)
        tint = self._edge() / fresnel.schlick(np.asarray(1.0 / 7.0), f0)
        power = F82(f0, tint)(inside)
        return [(power, _phase(r)) for r in _metal(inside, n, k, index)]


@dataclass(frozen=True)
class FilmDielectric(_UnderFilm):
    """A dielectric of relative index `eta`, () or (n,), under a film.

    Its reflectance is stretched from its own value at normal incidence to `f0` (3, 1) or (3, n).

    Blender's definition of the stretch: F times 1 + s (f0 / F0 - 1), with s from 0 where F is 1 to 1 where F is at
    most F0.
    """

    eta: np.ndarray
    f0: np.ndarray

    @property
    def bare(self) -> TintedDielectric:
        """The surface without the film."""
        return TintedDielectric(self.eta, self.f0)

    def _covered(self, cos: np.ndarray) -> np.ndarray:
        color, tinted = self.parts(cos)
        return color + (self.tint - 1.0) * tinted

    @property
    def tint(self) -> np.ndarray:
        """f0 / F0; 1 where there is hardly any F0."""
        plain = reflectance_at_normal(self.eta)
        return np.where(plain > 1e-5, self.f0 / np.maximum(plain, 1e-5), 1.0)

    def parts(self, cos: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what is reflected without a tint, and the part that a tint multiplies.

        They are F and s F, (3, n) each.
        """
        color = self._reflected(cos)
        share = np.clip((1.0 - color) / np.maximum(1.0 - reflectance_at_normal(self.eta), 1e-12), 0.0, 1.0)
        return color, share * color

    def _below(self, inside: np.ndarray, index: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return the squared amplitude and the phase of both polarisations at the dielectric.

        Beyond the critical angle all is reflected.
        """
        away = self.eta / index
        beyond, total = cosine_in_film(inside, away)
        return [
            (np.where(total, 1.0, r * r), np.where(r < 0.0, -1.0, 1.0).astype(complex))
            for r in amplitudes(inside, beyond, away)
        ]


@dataclass(frozen=True)
class Tabulated:
    """A reflectance that is the same at all points, read from a table.

    It is linear between its values at even cosines, `table` (3, k); exact to 1e-5.
    """

    table: np.ndarray
    average: np.ndarray
    average_cycles: np.ndarray

    def __call__(self, cos: np.ndarray) -> np.ndarray:
        """Reflectance, (3, n)."""
        last = self.table.shape[1] - 1
        at = cos * last
        first = np.minimum(at.astype(np.intp), last - 1)
        low = np.take(self.table, first, axis=1)
        return low + (np.take(self.table, first + 1, axis=1) - low) * (at - first)

    def part(self, index: np.ndarray) -> Tabulated:
        """Itself: it knows nothing of the points."""
        return self


def under_film(curve: FilmConductor | FilmF82 | FilmDielectric) -> FilmConductor | FilmF82 | FilmDielectric | Tabulated:
    """Return the reflectance of `curve`, from a table where that is possible.

    It has to be the same at all points and smooth; it is not smooth where there is a critical angle.
    """
    film, own = curve.film, [getattr(curve, f.name) for f in fields(curve) if f.name != "film"]
    values = [film.thickness, film.index, *own]
    constant = all(np.ndim(v) == 0 or np.shape(v)[-1] == 1 for v in values)
    if (
        not constant
        or np.any(np.asarray(film.index) < 1.0)
        or (isinstance(curve, FilmDielectric) and np.any(curve.eta < 1.0))
    ):
        return curve
    return _tabulated(type(curve), film.to.orders is None, *(tuple(np.ravel(v).tolist()) for v in values))


@functools.lru_cache(maxsize=256)
def _tabulated(kind: type, exact: bool, thickness: tuple, index: tuple, *own: tuple) -> Tabulated:
    to = exact_sensitivity() if exact else cycles_sensitivity()
    film = Film(np.asarray(thickness[0]), np.asarray(index[0]), to)
    curve = kind(film, *(np.float64(v[0]) if len(v) == 1 else np.array(v)[:, None] for v in own))
    table = curve(np.linspace(0.0, 1.0, _NODES))
    table.flags.writeable = False
    return Tabulated(table, curve.average, curve.average_cycles)


def _metal(inside: np.ndarray, n: np.ndarray, k: np.ndarray, index: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Amplitudes r_s and r_p in the film at a metal of index n + i k over that outside."""
    away = (n + 1j * k) / index
    beyond = np.sqrt(1.0 - (1.0 - inside) * (1.0 + inside) / np.square(away))
    return amplitudes(inside, beyond, away)


def _phase(amplitude: np.ndarray) -> np.ndarray:
    """The amplitude over its size; 1 where there is none."""
    size = np.abs(amplitude)
    return np.where(size > 0.0, amplitude / np.where(size > 0.0, size, 1.0), 1.0)
