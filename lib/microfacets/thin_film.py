# SPDX-License-Identifier: GPL-3.0-or-later
"""Reflectance of a surface under a film of the thickness of a wavelength, in colours.

A film of index n and thickness d over a substrate reflects, at the wavelength l, |r12 + r23 e^(i p)|^2 / |1 + r12 r23 e^(i p)|^2 with the
phase p = 2 pi D / l and the path difference D = 2 n d cos(theta_2) (Born and Wolf, sec. 1.6.4). As a Fourier series in p its integral over
a colour is a sum over the transform of that colour (Belcour and Barla 2017, "A practical extension to microfacet theory for the
modeling of varying iridescence", eq. 10). Colours are linear Rec. 709 of the CIE 1931 observer, each normalised for light of equal energy at
all wavelengths, as in Cycles: a mirror is white. Indices do not depend on the wavelength within a colour.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy

LEAST_THICKNESS = 0.1
"""Nanometres from which on there is a film, as in Cycles."""

# Linear Rec. 709 from XYZ (ITU-R BT.709: primaries and white point).
_REC709 = np.array(
    [
        [3.2409699419, -1.5373831776, -0.4986107603],
        [-0.9692436363, 1.8759675015, 0.0415550574],
        [0.0556300797, -0.2039769589, 1.0569715142],
    ]
)
_FFT = 1 << 20  # wavenumbers of the transform
_FARTHEST = 1 << 16  # nm
_ENOUGH = 1e-6
_GRAZING = 1e-60  # stands for a cosine of zero
_MOST_ORDERS = 400
_CYCLES_NODES, _CYCLES_END = 512, 60.0


@dataclass(frozen=True)
class Sensitivity:
    """Fourier transform of the three colours over the path difference.

    `table` (3, k) is complex, with one entry every `step` nm.
    Beyond the table it is its last entry. `orders`: where the series ends; None when it has converged.
    """

    table: np.ndarray
    step: float
    orders: int | None = None

    def __call__(self, difference: np.ndarray) -> np.ndarray:
        """The integral of colour times e^(2 pi i D / l), (3, n), linear between the entries.

        `difference` (n,) is at least 0.
        """
        last = self.table.shape[1] - 1
        at = np.minimum(difference / self.step, last)
        first = np.minimum(at.astype(np.intp), last - 1)
        low = np.take(self.table, first, axis=1)
        return low + (np.take(self.table, first + 1, axis=1) - low) * (at - first)


@functools.cache
def exact_sensitivity() -> Sensitivity:
    """The transform every nanometre, to 3e-5 between entries.

    It is that of the observer's splines over the wavenumber.
    """
    observer = _observer()
    wavenumber = np.arange(_FFT // 256) / _FFT  # per nm, at most 1 / 256 nm
    inside = (wavenumber > 1.0 / observer[-1, 0]) & (wavenumber < 1.0 / observer[0, 0])
    wavelength = 1.0 / wavenumber[inside]
    colors = np.zeros((3, _FFT))
    colors[:, np.flatnonzero(inside)] = _REC709 @ (
        scipy.interpolate.CubicSpline(observer[:, 0], observer[:, 1:])(wavelength).T * wavelength**2
    )
    colors /= colors.sum(axis=1, keepdims=True)
    table = np.fft.ifft(colors, axis=1, norm="forward")[:, :_FARTHEST]
    return Sensitivity(_frozen(np.ascontiguousarray(table)), 1.0)


@functools.cache
def cycles_sensitivity() -> Sensitivity:
    """The transform that Cycles reads from 5.0 on, to the third order.

    512 entries every 18.7 nm (doc/precompute/thin_film_table.py).
    """
    observer = _observer()
    frequency = np.linspace(0.0, np.pi * (2 * _CYCLES_NODES - 3) / _CYCLES_END, 2 * _CYCLES_NODES - 2)
    frequency[0] = 1e-40
    padded = np.concatenate([[[359.0, 0.0, 0.0, 0.0]], observer, [[831.0, 0.0, 0.0, 0.0]]])
    spline = scipy.interpolate.CubicSpline(padded[:, 0], padded[:, 1:], extrapolate=False)
    resampled = np.nan_to_num(spline(1000.0 / frequency) / np.square(frequency)[:, None])
    table = (_REC709 @ np.fft.rfft(resampled, axis=0).T).conj()
    table /= table[:, :1].real
    return Sensitivity(_frozen(table), 1000.0 * _CYCLES_END / (2.0 * np.pi * (_CYCLES_NODES - 1)), 3)


def film_index(index: np.ndarray, thickness: np.ndarray) -> np.ndarray:
    """The film's index relative to the medium outside.

    Below 1 nm it fades to 1, as in Blender, where no film is so thin.
    """
    t = np.clip(thickness, 0.0, 1.0)
    return 1.0 + (index - 1.0) * t * t * (3.0 - 2.0 * t)


def cosine_in_film(cos: np.ndarray, index: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The cosine beyond Snell's law, (n,), and where there is none since all is reflected."""
    square = 1.0 - (1.0 - cos) * (1.0 + cos) / np.square(index)
    return np.sqrt(np.maximum(square, 0.0)), square <= 0.0


def amplitudes(near: np.ndarray, far: np.ndarray, index: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Reflected amplitudes r_s and r_p for cosines on either side of an interface.

    `index` is that beyond over that before, and may be complex.
    Born and Wolf, sec. 1.5.2, eq. 21a; r_p has the sign with which both are equal at grazing.
    """
    near = np.maximum(near, _GRAZING)
    return (near - index * far) / (near + index * far), (index * near - far) / (index * near + far)


def film_color(
    first: np.ndarray, power: np.ndarray, phase: np.ndarray, difference: np.ndarray, to: Sensitivity
) -> np.ndarray:
    """The colour (3, n) that one polarisation reflects: Belcour and Barla 2017, eq. 10.

    `first` (n,): amplitude of the outer interface, real; `power` and `phase`, (n,) or (3, n): squared amplitude and unit complex number of
    the phase at the inner one; `difference` (n,) the path difference in nm.
    """
    outer = first * first
    through = 1.0 - outer
    both = outer * power
    root = np.sqrt(both)
    steady = through * through * power / np.maximum(1.0 - both, 1e-300)
    turn = phase * np.where(first > 0.0, -1.0, 1.0)
    shape = (3, difference.size)
    color = np.broadcast_to(outer + steady, shape).copy()
    weight, root, turn = (np.broadcast_to(v, shape) for v in (steady - through, root, turn))
    phasor, open_ = np.ones_like(turn), np.arange(difference.size)
    for order in range(1, (to.orders or _MOST_ORDERS) + 1):
        weight, phasor = weight * root, phasor * turn
        if to.orders is None:
            going = (np.abs(weight) > _ENOUGH).any(axis=0)
            if not going.all():
                weight, root, turn, phasor = (v[:, going] for v in (weight, root, turn, phasor))
                open_ = open_[going]
        if not open_.size:
            break
        color[:, open_] += 2.0 * weight * (phasor * to(order * difference[open_])).real
    return color


def _observer() -> np.ndarray:
    """Wavelength in nm, x, y and z, (471, 4)."""
    return np.loadtxt(Path(__file__).with_name("observer.txt"))


def _frozen(table: np.ndarray) -> np.ndarray:
    table.flags.writeable = False
    return table
