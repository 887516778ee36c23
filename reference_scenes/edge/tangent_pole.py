# SPDX-License-Identifier: GPL-3.0-or-later
"""Extreme anisotropy about a pole where the radial tangent has no direction.

It is a disc seen from above in a white world. Seen along the normal the directional albedo does not depend on where the
tangent points, so that the whole disc, its pole with it, shows one radiance: the integral of D G / 4 over wi, by
Gauss-Legendre over the stretched tangents.
"""

from __future__ import annotations

import math

import numpy as np

from ...lib.microfacets.ggx import GGX
from .. import building
from .edge_case import EdgeCase, look, start

ALPHA, ANISOTROPY = 0.05, 0.9


def _albedo() -> float:
    """E(n) = integral of D / (1 + Lambda(wi)) (m.z) dm.

    It covers the facets tilted by less than 45 degrees, which reflect upwards.
    """
    alpha_x, alpha_y = ALPHA * (1.0 - ANISOTROPY), min(ALPHA / (1.0 - ANISOTROPY), 1.0)
    node, weight = np.polynomial.legendre.leggauss(400)
    share, weight = 0.5 * (node + 1.0), 0.5 * weight
    total = 0.0
    for phi in (np.arange(720) + 0.5) * (2.0 * math.pi / 720):
        # A direction (cos, sin) in stretched tangents reaches tan = 1 at the radius 1 / |(alpha_x cos, alpha_y sin)|.
        rate = math.hypot(alpha_x * math.cos(phi), alpha_y * math.sin(phi))
        end = math.atan(1.0 / rate)
        r = np.tan(end * share)
        m = np.stack([alpha_x * r * math.cos(phi), alpha_y * r * math.sin(phi), np.ones_like(r)])
        m /= np.sqrt((m * m).sum(axis=0))
        wi = 2.0 * m[2] * m - np.array([[0.0], [0.0], [1.0]])
        value = GGX().density(m, alpha_x, alpha_y) / (1.0 + GGX().smith_lambda(wi, alpha_x, alpha_y)) * m[2]
        dm = alpha_x * alpha_y * r * (1.0 + r * r) * end * m[2] ** 3
        total += (value * dm * weight).sum() * (2.0 * math.pi / 720)
    return float(total)


def _build() -> None:
    start("tangent pole")
    building.world((1.0, 1.0, 1.0))
    material = building.glossy("Brushed", "GGX", ALPHA, (1.0, 1.0, 1.0))
    shader = next(node for node in material.node_tree.nodes if node.bl_idname == "ShaderNodeBsdfAnisotropic")
    shader.inputs["Anisotropy"].default_value = ANISOTROPY
    building.rectangle("Disc", material, (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    look((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 4.0, 0.001)


CASES = (EdgeCase("anisotropy 0.9 about a pole", _build, _albedo(), 2e-3, 1024, "directional albedo by quadrature"),)
