# SPDX-License-Identifier: GPL-3.0-or-later
"""GGX (Trowbridge-Reitz, Walter et al. 2007), isotropic and anisotropic.

alpha_x, alpha_y in (0, 1], () or (n,): the documents' sigma, Blender's roughness squared. Uniforms in [0, 1].
"""

from __future__ import annotations

import numpy as np

from ..sampling.tables import LARGEST_UNIFORM
from ..sampling.warps import circle
from .directions import FLOOR, normal_from_tangents, stretched_sine_squared
from .masking import HIDDEN


def density(m: np.ndarray, alpha_x: float | np.ndarray, alpha_y: float | np.ndarray) -> np.ndarray:
    """D(m) = 1 / (pi alpha_x alpha_y (m.x^2/alpha_x^2 + m.y^2/alpha_y^2 + m.z^2)^2), sr^-1, (n,).

    Walter et al. 2007, eq. 33; Heitz 2014, eq. 85. `m` (3, n) unit, or of any length l, which gives D / l^4; zero where m.z <= 0.
    The sine comes from x and y: from the cosine alone it cancels where alpha is small.
    """
    d = m[0] / alpha_x
    d *= d
    part = m[1] / alpha_y
    part *= part
    d += part
    d += np.multiply(m[2], m[2], out=part)
    d *= d
    d *= np.pi * (alpha_x * alpha_y)
    np.divide(1.0, d, out=d)
    below = m[2] <= 0.0
    if below.any():
        d[below] = 0.0
    return d


def smith_lambda(w: np.ndarray, alpha_x: float | np.ndarray, alpha_y: float | np.ndarray) -> np.ndarray:
    """Smith's Lambda(w) = (sqrt(1 + s) - 1) / 2, s = (alpha_x^2 w.x^2 + alpha_y^2 w.y^2) / w.z^2, (n,).

    Heitz 2014, eq. 72 and 86, as s / (2 (1 + sqrt(1 + s))), which does not cancel. `w` (3, n) unit; HIDDEN where w.z <= 0.
    """
    s = stretched_sine_squared(w, alpha_x, alpha_y)
    z = np.clip(w[2], FLOOR, 1.0)
    root = z * z
    root += s
    np.sqrt(root, out=root)
    root += z
    root *= z
    s /= root
    s *= 0.5
    below = w[2] <= 0.0
    if below.any():
        s[below] = HIDDEN
    return s


def sample_d_cos(
    alpha_x: float | np.ndarray, alpha_y: float | np.ndarray, u1: np.ndarray, u2: np.ndarray
) -> np.ndarray:
    """Microfacet normal with density D(m) (m.n), (3, n): phi = 2 pi u1, theta = atan(alpha sqrt(u2 / (1 - u2))).

    Walter et al. 2007, eq. 35 and 36; the anisotropic lobe is the isotropic one stretched along x and y.
    """
    x, y = circle(u1)
    tangent = np.minimum(u2, LARGEST_UNIFORM)
    tangent /= 1.0 - tangent
    np.sqrt(tangent, out=tangent)
    x *= tangent
    x *= alpha_x
    y *= tangent
    y *= alpha_y
    return normal_from_tangents(x, y)


def sample_visible(
    wo: np.ndarray,
    alpha_x: float | np.ndarray,
    alpha_y: float | np.ndarray,
    u1: np.ndarray,
    u2: np.ndarray,
    lambda_o: np.ndarray | None = None,
) -> np.ndarray:
    """Microfacet normal visible from `wo`, density `densities.pdf_visible`, (3, n), z > 0.

    Dupuy and Benyoub 2023: stretch to the hemisphere, add wo to a point uniform on the spherical cap z > -wo.z, stretch
    back.
    `wo` (3, n) unit with wo.z > 0 (others give some valid normal); `lambda_o` is Lambda(wo) where it is known.
    """
    return _sample_cap(wo, alpha_x, alpha_y, u1, u2, lambda_o, None)


def bound(wo: np.ndarray, alpha_x: float | np.ndarray, alpha_y: float | np.ndarray) -> np.ndarray:
    """By which factor k the cap's lower end can rise without losing a reflection that stays above the horizon, (n,).

    k = (1 - a^2) s^2 / (s^2 + a^2 wo.z^2), a = min(alpha_x, alpha_y), s = 1 + |(wo.x, wo.y)| (Eto and Tokuyoshi 2023,
    "Bounded VNDF sampling for Smith-GGX reflections", eq. 5 and 6).
    """
    a = np.minimum(alpha_x, alpha_y)
    a2 = np.minimum(a * a, 1.0)
    s = np.sqrt(wo[0] * wo[0] + wo[1] * wo[1])
    s += 1.0
    s *= s
    below = wo[2] * wo[2]
    below *= a2
    below += s
    s *= 1.0 - a2
    s /= below
    return s


def sample_bounded(
    wo: np.ndarray,
    alpha_x: float | np.ndarray,
    alpha_y: float | np.ndarray,
    u1: np.ndarray,
    u2: np.ndarray,
    lambda_o: np.ndarray | None = None,
) -> np.ndarray:
    """As `sample_visible`, from the smaller cap z > -k wo.z, k = `bound`: fewer reflections below the horizon.

    Density of the reflected direction, per steradian: D(m) / (2 wo.z (k + 1 + 2 Lambda(o))) (Eto and Tokuyoshi 2023, eq. 7).
    """
    return _sample_cap(wo, alpha_x, alpha_y, u1, u2, lambda_o, bound(wo, alpha_x, alpha_y))


def _sample_cap(
    wo: np.ndarray,
    alpha_x: float | np.ndarray,
    alpha_y: float | np.ndarray,
    u1: np.ndarray,
    u2: np.ndarray,
    lambda_o: np.ndarray | None,
    k: np.ndarray | None,
) -> np.ndarray:
    """Stretch wo, add a point of the cap z > -k wo.z (`k` None: 1) to it, stretch the sum back."""
    if lambda_o is None:
        lambda_o = smith_lambda(wo, alpha_x, alpha_y)
    m = np.empty((3, u1.shape[0]))
    x = np.multiply(wo[0], alpha_x, out=m[0])
    y = np.multiply(wo[1], alpha_y, out=m[1])
    above = np.clip(wo[2], FLOOR, 1.0)
    length = 2.0 * lambda_o  # that of the stretched wo is wo.z (1 + 2 Lambda)
    length += 1.0
    length *= above
    x /= length
    y /= length
    above /= length
    raised = None
    if k is not None:
        raised = above.copy()
        above *= k
        raised -= above
    above += 1.0
    # The cap's z is 1 - drop: its sine and the sum's z come out of drop without cancelling.
    drop = np.multiply(above, u2, out=length)
    sine = 2.0 - drop
    sine *= drop
    np.clip(sine, 0.0, 1.0, out=sine)
    np.sqrt(sine, out=sine)
    cap_x, cap_y = circle(u1)
    cap_x *= sine
    cap_y *= sine
    x += cap_x
    x *= alpha_x
    y += cap_y
    y *= alpha_y
    z = np.minimum(u2, LARGEST_UNIFORM, out=m[2])
    np.subtract(1.0, z, out=z)
    z *= above
    if raised is not None:
        z += raised
    np.multiply(x, x, out=cap_x)
    cap_x += np.multiply(y, y, out=cap_y)
    cap_x += np.multiply(z, z, out=cap_y)
    np.sqrt(cap_x, out=cap_x)
    m /= cap_x
    return m
