# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals that nodes turn: Blender's Normal Map, Bump and Bevel.

Results are unit vectors of the world on the viewer's side.
"""

from __future__ import annotations

import numpy as np

from ..scene.expressions import Bevel, Bump, NormalMap
from ..vectors import cross, dot, normalize, orthonormal_basis
from .context import InputEvaluator


def normal_map(node: NormalMap, read: InputEvaluator) -> np.ndarray:
    """The Normal Map node, (3, n)."""
    context = read.context
    strength = read(node.strength)
    color = 2.0 * read(node.color) - 1.0
    if node.invert_green:
        color = color * np.array([[1.0], [-1.0], [1.0]])
    side = np.where(context.backfacing, -1.0, 1.0)
    if node.space == "TANGENT":
        tangent, sign, normal = context.tangent_frame(node.uv_map)
        bent = tangent * (color[0] * strength) + (sign * cross(normal, tangent)) * (color[1] * strength)
        bent = bent + normal * (1.0 + (color[2] - 1.0) * np.clip(strength, 0.0, 1.0))
        n = context.normal_to_world(bent) * side
    else:
        if node.space.startswith("BLENDER"):
            color = color * np.array([[1.0], [-1.0], [-1.0]])
        color = np.broadcast_to(color, context.n.shape)
        n = (context.normal_to_world(color) if node.space.endswith("OBJECT") else normalize(color)) * side
        n = normalize(context.n + (n - context.n) * np.maximum(strength, 0.0))
    return np.where(dot(n, n) > 0.0, n, context.n)


def bump(node: Bump, read: InputEvaluator) -> np.ndarray:
    """The Bump node, (3, n): the normal of the surface raised by `height` times `distance`.

    Mikkelsen 2010, "Bump mapping unparametrized surfaces on the GPU". The slopes are those at the point itself; Cycles takes
    differences over the footprint of the pixel.
    """
    context = read.context
    n = context.n if node.normal is None else read(node.normal)
    x, y = orthonormal_basis(context.ng)
    here = read(node.height)
    slope = [read.moved(context.moved(axis, context.step))(node.height) - here for axis in (x, y)]
    across = [cross(y, n), cross(n, x)]
    gradient = (across[0] * slope[0] + across[1] * slope[1]) / context.step
    det = dot(x, across[0])
    scale = read(node.distance) * (-1.0 if node.invert else 1.0)
    strength = np.maximum(read(node.strength), 0.0)
    bent = normalize(np.abs(det) * n - scale * np.sign(det) * gradient)
    return np.where(dot(bent, bent) > 0.0, normalize(strength * bent + (1.0 - strength) * n), n)


def bevel(node: Bevel, read: InputEvaluator) -> np.ndarray:
    """The Bevel node, (3, n)."""
    context = read.context
    mean = context.averaged_normal(read(node.radius), node.samples)
    return mean if node.normal is None else normalize(read(node.normal) + (mean - context.n))
