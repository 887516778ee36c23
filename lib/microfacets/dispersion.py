# SPDX-License-Identifier: GPL-3.0-or-later
"""How the index of refraction depends on the wavelength."""

from __future__ import annotations

import numpy as np

# Fraunhofer's lines F, d and C, in nanometres, between which the Abbe number is defined.
LINE_F, LINE_D, LINE_C = 486.13, 587.56, 656.27


def cauchy_index(ior: np.ndarray | float, dispersion: np.ndarray | float, wavelength: np.ndarray) -> np.ndarray:
    """Cauchy's n(lambda) = A + B / lambda^2 through `ior` at line d, (n,).

    `dispersion` is the reciprocal of the Abbe number V = (n_d - 1) / (n_F - n_C), so that B = (n_d - 1) / V / (F^-2 - C^-2) and
    A = n_d - B d^-2 (Born and Wolf 1999, section 2.3.4; OpenPBR 1.1, section "Dispersion"). `ior` and `dispersion` () or (n,); `wavelength`
    (n,) in nanometres.
    """
    steps = (wavelength**-2.0 - LINE_D**-2.0) / (LINE_F**-2.0 - LINE_C**-2.0)
    return ior + (ior - 1.0) * dispersion * steps
