# SPDX-License-Identifier: GPL-3.0-or-later
"""Wavelengths of light and their colours, in linear Rec. 709.

The colours are those of the CIE 1931 observer under D65.

A path that carries the colour (r, g, b) stands for light of D65's spectrum, weighed by r, g and b. Where what happens
to it depends on the wavelength, its colour is the integral of color_weight(wavelength) times what happens there: all
of it where nothing does.
"""

from __future__ import annotations

import numpy as np

from .tables import Distribution1D

_STEP = 5.0

# CIE 15:2004, table T.4: x, y and z, times 10^4, every 5 nm from 380 to 780.
_OBSERVER = (
    """
    14 22 42 76 143 232 435 776 1344 2148 2839 3285 3483 3481 3362 3187 2908 2511 1954 1421
    956 580 320 147 49 24 93 291 633 1096 1655 2257 2904 3597 4334 5121 5945 6784 7621 8425
    9163 9786 10263 10567 10622 10456 10026 9384 8544 7514 6424 5419 4479 3608 2835 2187 1649 1212 874 636
    468 329 227 158 114 81 58 41 29 20 14 10 7 5 3 2 2 1 1 1
    0
""",
    """
    0 1 1 2 4 6 12 22 40 73 116 168 230 298 380 480 600 739 910 1126
    1390 1693 2080 2586 3230 4073 5030 6082 7100 7932 8620 9149 9540 9803 9950 10000 9950 9786 9520 9154
    8700 8163 7570 6949 6310 5668 5030 4412 3810 3210 2650 2170 1750 1382 1070 816 610 446 320 232
    170 119 82 57 41 29 21 15 10 7 5 4 2 2 1 1 1 0 0 0
    0
""",
    """
    65 105 201 362 679 1102 2074 3713 6456 10391 13856 16230 17471 17826 17721 17441 16692 15281 12876 10419
    8130 6162 4652 3533 2720 2123 1582 1117 782 573 422 298 203 134 87 57 39 27 21 18
    17 14 11 10 8 6 3 2 2 1 0 0 0 0 0 0 0 0 0 0
    0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0
    0
""",
)

# CIE 15:2004, table T.1: D65 every 10 nm from 380 to 780; between these it is linear by definition.
_D65 = """
    49.9755 54.6482 82.7549 91.486 93.4318 86.6823 104.865 117.008 117.812 114.861 115.923 108.811 109.354 107.802
    104.79 107.689 104.405 104.046 100 96.3342 95.788 88.6856 90.0062 89.5991 87.6987 83.2886 83.6992 80.0268
    80.2146 82.2778 78.2842 69.7213 71.6091 74.349 61.604 69.8856 75.087 63.5927 46.4182 66.8054 63.3828
"""

# IEC 61966-2-1:1999, annex F: linear Rec. 709 from XYZ.
_REC709 = np.array(
    [
        [3.2404542, -1.5371385, -0.4985314],
        [-0.9692660, 1.8760108, 0.0415560],
        [0.0556434, -0.2040259, 1.0572252],
    ]
)


def _color_table() -> tuple[np.ndarray, np.ndarray]:
    """Return wavelengths (81,) and the density of each colour there, (3, 81) nm^-1.

    The integral of each density is 1.
    """
    observer = np.array([row.split() for row in _OBSERVER], np.float64)
    nodes = 380.0 + _STEP * np.arange(observer.shape[1])
    d65 = np.interp(nodes, nodes[::2], np.array(_D65.split(), np.float64))
    colors = _REC709 @ (observer * d65)
    colors /= _STEP * (colors.sum(axis=1) - 0.5 * (colors[:, 0] + colors[:, -1]))[:, None]
    return nodes, colors


NODES, COLORS = _color_table()
"""Wavelengths in nanometres, (81,), and the densities of red, green and blue there, (3, 81) nm^-1; linear between."""
_LIGHTNESS = np.abs(COLORS).mean(axis=0)
_CHOICE = Distribution1D(_LIGHTNESS[1:] + _LIGHTNESS[:-1])


def sample_wavelength(u: np.ndarray) -> np.ndarray:
    """Return wavelengths in nanometres, (n,), for uniforms `u` in [0, 1).

    Wavelengths that bring more colour are more frequent.
    """
    cell, along = _CHOICE.sample(u)
    return NODES[cell] + _STEP * along


def color_weight(wavelength: np.ndarray) -> np.ndarray:
    """Return the colour of a wavelength over the density of `sample_wavelength`, (3, n).

    Its mean over samples is 1.

    Colours of the spectrum lie outside Rec. 709, so that components are negative there.
    """
    cell = np.minimum(((wavelength - NODES[0]) / _STEP).astype(np.intp), NODES.size - 2)
    along = (wavelength - NODES[cell]) / _STEP
    color = COLORS[:, cell] * (1.0 - along) + COLORS[:, cell + 1] * along
    return color * (_STEP / _CHOICE.probability[cell])
