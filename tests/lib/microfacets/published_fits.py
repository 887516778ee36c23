# SPDX-License-Identifier: GPL-3.0-or-later
"""Fits to Smith's G1 = 1 / (1 + Lambda) that papers print.

Tests measure how far off they are.
"""

import numpy as np
from scipy.special import gamma


def student_g1(a, g):
    """Ribardiere et al. 2017, eq. 7, 13, 14, 22 and 23.

    At a = cot(theta) / alpha, for 3/2 < g <= 40.
    """
    f21 = (1.066 * a + 2.655 * a**2 + 4.892 * a**3) / (1.038 + 2.969 * a + 4.305 * a**2 + 4.418 * a**3)
    f22 = (14.402 - 27.145 * g + 20.574 * g**2 - 2.745 * g**3) / (-30.612 + 86.567 * g - 84.341 * g**2 + 29.938 * g**3)
    f23 = (-129.404 + 324.987 * g - 299.305 * g**2 + 93.268 * g**3) / (
        -92.609 + 256.006 * g - 245.663 * g**2 + 86.064 * g**3
    )
    f24 = (6.537 + 6.074 * a - 0.623 * a**2 + 5.223 * a**3) / (6.538 + 6.103 * a - 3.218 * a**2 + 6.347 * a**3)
    s1 = (g - 1.0 + a * a) ** (1.5 - g) / a
    s2 = f21 * (f22 + f23 * f24)
    factor = gamma(g - 0.5) / (gamma(g) * np.sqrt(np.pi))
    return 1.0 / (0.5 + factor * ((g - 1.0) ** g / (2.0 * g - 3.0) * s1 + np.sqrt(g - 1.0) * s2))


def phong_g1(cot, n):
    """Walter et al. 2007, eq. 27 and the text after eq. 32.

    It is Beckmann's fit at a = sqrt(n / 2 + 1) cot(theta).
    """
    a = np.sqrt(0.5 * n + 1.0) * cot
    return np.where(a < 1.6, (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a), 1.0)
