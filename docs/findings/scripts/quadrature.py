# SPDX-License-Identifier: GPL-3.0-or-later
"""Expected values for rough surfaces, by quadrature over the facets that the viewer sees.

The surface is isotropic GGX with Smith's height-correlated masking. Visible facets are parametrised by the unit square
(Heitz, Sampling the GGX Distribution of Visible Normals, JCGT 2018), which is filled with a regular grid of midpoints.
A mean over the grid is an integral over the facets, weighted by their visible projected area.
"""

import numpy as np


def visible_facets(cos, alpha, nodes=500):
    """Direction to the viewer (3,) and facet normals (3, n) at equal weight.

    The viewer is at `cos` to the normal.
    """
    u = (np.arange(nodes) + 0.5) / nodes
    u1, u2 = (x.ravel() for x in np.meshgrid(u, u))
    view = np.array([np.sqrt(1 - cos * cos), 0.0, cos])
    stretched = view * np.array([alpha, alpha, 1.0])
    stretched /= np.linalg.norm(stretched)
    first = np.array([0.0, 1.0, 0.0])
    second = np.cross(stretched, first)
    r, phi = np.sqrt(u1), 2 * np.pi * u2
    t1, t2 = r * np.cos(phi), r * np.sin(phi)
    s = 0.5 * (1 + stretched[2])
    t2 = (1 - s) * np.sqrt(1 - t1 * t1) + s * t2
    t3 = np.sqrt(np.maximum(0.0, 1 - t1 * t1 - t2 * t2))
    facet = first[:, None] * t1 + second[:, None] * t2 + stretched[:, None] * t3
    facet = np.stack([alpha * facet[0], alpha * facet[1], np.maximum(facet[2], 1e-12)])
    return view, facet / np.linalg.norm(facet, axis=0)


def smith_lambda(cos, alpha):
    """Smith's Lambda of isotropic GGX."""
    return 0.5 * (np.sqrt(1 + alpha**2 * (1 / cos**2 - 1)) - 1)


def fresnel(cos, eta):
    """Unpolarised reflectance of a dielectric of relative index `eta`.

    1 under total internal reflection.
    """
    inside = 1 - (1 - cos * cos) / eta**2
    t = np.sqrt(np.maximum(inside, 0.0))
    s_wave, p_wave = (cos - eta * t) / (cos + eta * t), (eta * cos - t) / (eta * cos + t)
    return np.where(inside <= 0, 1.0, 0.5 * (s_wave**2 + p_wave**2))


def reflected(cos, alpha, reflectance=lambda c: 1.0):
    """Albedo of single reflection towards a viewer at `cos`.

    Mean of F(facet) G2 / G1 over the visible facets.
    """
    view, facet = visible_facets(cos, alpha)
    c = view @ facet
    out = np.maximum(2 * c * facet[2] - cos, 0.0)
    seen = smith_lambda(cos, alpha)
    passed = np.where(out > 0, (1 + seen) / (1 + seen + smith_lambda(np.maximum(out, 1e-9), alpha)), 0.0)
    return float(np.mean(reflectance(c) * passed))


def average_albedo(alpha, nodes=12):
    """Eavg = integral of 2 mu E(mu)."""
    x, w = np.polynomial.legendre.leggauss(nodes)
    return sum(0.5 * wk * (1 + xk) * reflected(0.5 * (1 + xk), alpha) for xk, wk in zip(x, w, strict=True))


def average_fresnel(eta):
    """Fss = integral of 2 mu F(mu)."""
    x, w = np.polynomial.legendre.leggauss(400)
    mu = 0.5 * (1 + x)
    return float(np.sum(w * mu * fresnel(mu, eta)))


def compensated(cos, alpha, eta):
    """Albedo of a dielectric layer with multiple scattering, as Cycles has it.

    The scattering is that of Kulla and Conty (2017). It is the single-scattering albedo times 1 + Fms (1 - E) / E, with
    Fms = Fss Eavg / (1 - Fss (1 - Eavg)). Returns that albedo and E + Fms (1 - E).
    """
    white, eavg, fss = reflected(cos, alpha), average_albedo(alpha), average_fresnel(eta)
    fms = fss * eavg / (1 - fss * (1 - eavg))
    single = reflected(cos, alpha, lambda c: fresnel(c, eta))
    return single * (1 + fms * (1 - white) / white), white + fms * (1 - white)
