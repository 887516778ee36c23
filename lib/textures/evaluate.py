# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluates an expression at many shading points at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..bsdfs.films import make_film
from ..bsdfs.layered import beneath_layer, coat_tint
from ..bsdfs.sheen import beneath_sheen
from ..microfacets.cycles_tables import tables_with
from ..scene import expressions as ex
from ..scene.layers import BeneathLayer, BeneathSheen, CoatTint
from ..scene.rays import COUNTS, FLAGS
from ..scene.sky import Sky
from ..vectors import dot, normalize
from .angles import fresnel_factor, layer_weight_facing, layer_weight_fresnel
from .checker import checker
from .color_spaces import luminance
from .context import Context
from .converters import CONVERTERS, as_value
from .images import ImageSet, equirectangular
from .mapping import mapping
from .math_node import math
from .mix import mix
from .normals import bevel, bump, normal_map
from .patterns import PATTERNS
from .projections import Place, box_faces, box_weights, mirror_ball, sphere, tube
from .ramp import color_ramp
from .sky import sky
from .tiles import lies_in_tile


class Evaluator:
    """Evaluates expressions over one set of points.

    A node object that several expressions share is computed once.

    `evaluator(expression)` gives a value as () or (n,) and a colour as (3, 1) or (3, n). Results are shared: never
    write into them.
    """

    def __init__(self, context: Context, images: ImageSet) -> None:
        self.context = context
        self.images = images
        # The expression is kept beside its result so that its id cannot be reused meanwhile.
        self._results: dict[int, tuple[ex.Expression, np.ndarray]] = {}

    def __call__(self, expression: ex.Expression) -> np.ndarray:
        """The value or colour of `expression`."""
        if isinstance(expression, ex.Constant):
            return _constant(expression)
        found = self._results.get(id(expression))
        if found is None:
            # Overflow is the material's own and comes out as inf or NaN, for the film to count.
            with np.errstate(all="ignore"):
                found = (expression, _NODES[type(expression)](expression, self))
            self._results[id(expression)] = found
        return found[1]

    def moved(self, context: Context) -> Evaluator:
        """An evaluator of the same images at other points."""
        return Evaluator(context, self.images)


def evaluate(expression: ex.Expression, context: Context, images: ImageSet) -> np.ndarray:
    """The value, () or (n,), or colour, (3, 1) or (3, n), of one expression."""
    return Evaluator(context, images)(expression)


def _constant(node: ex.Constant) -> np.ndarray:
    value = np.asarray(node.value, dtype=np.float64)
    return value[:, None] if value.ndim else value


_PROJECTIONS: dict[str, Callable[[np.ndarray], Place]] = {
    "FLAT": lambda point: (point[0], point[1]),
    "SPHERE": sphere,
    "TUBE": tube,
    "EQUIRECTANGULAR": equirectangular,
    "MIRROR_BALL": mirror_ball,
}
_OBJECT = {"LOCATION": slice(3), "COLOR": slice(3, 6), "ALPHA": 6, "INDEX": 7, "RANDOM": 8}
_CHANNELS = {"ALPHA": 3, "FACTOR": 4, "PRESENCE": 5}


def _attribute(node: ex.Attribute, read: Evaluator) -> np.ndarray:
    values = read.context.attribute(node.name)
    return values[:3] if node.output == "COLOR" else values[_CHANNELS[node.output]]


def _sampled(node: ex.ImageTexture, place: Place, read: Evaluator) -> np.ndarray:
    return read.images.sample(node.image, *place, node.interpolation, node.extension, node.association)


def _box(node: ex.ImageTexture, point: np.ndarray, normal: np.ndarray, read: Evaluator) -> np.ndarray:
    """RGBA (4, n) of the faces of a box, each asked only where it counts."""
    point, normal = np.broadcast_arrays(point, normal)
    rgba = np.zeros((4, normal.shape[1]))
    for weight, (u, v) in zip(box_weights(normal, node.blend), box_faces(point, normal), strict=True):
        (seen,) = np.nonzero(weight)
        rgba[:, seen] += weight[seen] * _sampled(node, (u[seen], v[seen]), read)
    return rgba


def _image_texture(node: ex.ImageTexture, read: Evaluator) -> np.ndarray:
    point = read(node.vector)
    if node.projection == "BOX" and node.normal is not None:
        rgba = _box(node, point, read(node.normal), read)
    else:
        rgba = _sampled(node, _PROJECTIONS[node.projection](point), read)
    if node.output == "COLOR":
        return rgba[:3]
    return as_value(rgba[3])


def _environment_texture(node: ex.EnvironmentTexture, read: Evaluator) -> np.ndarray:
    u, v = _PROJECTIONS[node.projection](read(node.vector))
    return read.images.sample(node.image, u, v, node.interpolation, association=node.association)[:3]


def _checker(node: ex.Checker, read: Evaluator) -> np.ndarray:
    first = checker(read(node.vector), read(node.scale))
    if node.output == "FACTOR":
        return first.astype(np.float64)
    return np.where(first, read(node.color1), read(node.color2))


def _mix(node: ex.Mix, read: Evaluator) -> np.ndarray:
    return mix(node.blend, read(node.factor), read(node.a), read(node.b), node.clamp_factor, node.clamp_result)


def _layer_weight(node: ex.LayerWeight, read: Evaluator) -> np.ndarray:
    blend, cos_wo = read(node.blend), _slant(node.normal, read)
    if node.output == "FRESNEL":
        return layer_weight_fresnel(blend, cos_wo, read.context.backfacing)
    return layer_weight_facing(blend, cos_wo)


def _gamma(node: ex.Gamma, read: Evaluator) -> np.ndarray:
    color, gamma = read(node.color), read(node.gamma)
    powers = np.where(color > 0.0, np.where(color > 0.0, color, 1.0) ** gamma, color)
    return np.where(gamma == 0.0, 1.0, powers)  # so in Cycles, below 0 too


def _cos_wo(normal: ex.Expression | None, read: Evaluator) -> np.ndarray:
    """|n.wo| of the shading normal, or what a turned normal sees of wo."""
    return read.context.cos_wo if normal is None else np.maximum(dot(read(normal), read.context.wo), 0.0)


def _slant(normal: ex.Expression | None, read: Evaluator) -> np.ndarray:
    """|n.wo| of the shading normal, or of a turned normal on either side of wo."""
    return read.context.cos_wo if normal is None else np.abs(dot(read(normal), read.context.wo))


def _beneath_layer(node: BeneathLayer, read: Evaluator) -> np.ndarray:
    tint, roughness, weight = read(node.tint), read(node.roughness), read(node.weight)
    cos_wo = _cos_wo(node.normal, read)
    tables, ior = tables_with(node.tables), node.ior.number
    thickness, index = (np.asarray(one.number) for one in (node.film_thickness, node.film_ior))
    film = make_film(thickness, index, node.film_by_table)
    return beneath_layer(node.distribution, ior, tint, roughness, weight, cos_wo, tables, node.lossless, film)


def _value_to_color(node: ex.ValueToColor, read: Evaluator) -> np.ndarray:
    value = np.atleast_1d(read(node.value))
    return np.broadcast_to(value, (3, value.size))


def _vector_to_value(node: ex.VectorToValue, read: Evaluator) -> np.ndarray:
    return as_value(read(node.vector).sum(axis=0) / 3)


def _ray_count(node: ex.RayCount, read: Evaluator) -> np.ndarray:
    """Where no path meets the points, as for a camera ray of length 0."""
    tally = read.context.tally
    return np.zeros(()) if tally is None else tally[COUNTS.index(node.count)]


def _after_diffuse(_: ex.AfterDiffuse, read: Evaluator) -> np.ndarray:
    tally = read.context.tally
    return np.zeros(()) if tally is None else np.asarray(tally[COUNTS.index("DIFFUSE_DEPTH")] > 0.0, np.float64)


def _ambient_occlusion(node: ex.AmbientOcclusion, read: Evaluator) -> np.ndarray:
    n = read.context.n if node.normal is None else np.broadcast_to(normalize(read(node.normal)), read.context.n.shape)
    return read.context.open_share(-n if node.inside else n, read(node.distance), node.only_local, node.samples)


def _undisplaced(node: ex.Undisplaced, read: Evaluator) -> np.ndarray:
    return read.moved(read.context.undisplaced())(node.expression)


_NODES: dict[type[ex.Expression], Callable[[Any, Evaluator], np.ndarray]] = {
    **CONVERTERS,
    **PATTERNS,
    ex.Coordinates: lambda node, read: read.context.coordinates(node.kind, node.uv_map),
    ex.Attribute: _attribute,
    ex.ObjectInfo: lambda node, read: read.context.object_info()[_OBJECT[node.output]],
    ex.NormalMap: normal_map,
    ex.Bump: bump,
    ex.Bevel: bevel,
    ex.Undisplaced: _undisplaced,
    ex.SurfaceNormal: lambda node, read: read(node.normal),
    ex.NormalScale: lambda _, read: read.context.normal_scale,
    ex.Mapping: lambda node, read: mapping(
        node.kind, read(node.vector), read(node.location), read(node.rotation), read(node.scale)
    ),
    ex.ImageTexture: _image_texture,
    ex.Tile: lambda node, read: np.where(
        lies_in_tile(read(node.vector), node.number), read(node.inside), read(node.outside)
    ),
    ex.EnvironmentTexture: _environment_texture,
    Sky: sky,
    ex.Checker: _checker,
    ex.Math: lambda node, read: math(node.operation, read(node.a), read(node.b), read(node.c), node.clamp),
    ex.Mix: _mix,
    ex.ColorRamp: lambda node, read: color_ramp(node, read(node.factor)),
    ex.FresnelFactor: lambda node, read: fresnel_factor(
        read(node.ior), _slant(node.normal, read), read.context.backfacing
    ),
    ex.LayerWeight: _layer_weight,
    ex.Gamma: _gamma,
    BeneathLayer: _beneath_layer,
    BeneathSheen: lambda node, read: beneath_sheen(
        read(node.tint), read(node.roughness), read(node.weight), _cos_wo(node.normal, read)
    ),
    CoatTint: lambda node, read: coat_tint(
        read(node.ior), read(node.tint), read(node.weight), _cos_wo(node.normal, read)
    ),
    ex.Wireframe: lambda node, read: (read.context.edge_distance() < 0.5 * np.abs(read(node.size))).astype(np.float64),
    ex.PixelWidth: lambda _, read: read.context.pixel_width(),
    ex.AmbientOcclusion: _ambient_occlusion,
    ex.Backfacing: lambda _, read: read.context.backfacing.astype(np.float64),
    ex.RayFlag: lambda node, read: np.asarray(np.bitwise_and(read.context.flags, FLAGS[node.flag]) != 0, np.float64),
    ex.RayCount: _ray_count,
    ex.AfterDiffuse: _after_diffuse,
    ex.ColorToValue: lambda node, read: as_value(luminance(read(node.color))),
    ex.VectorToValue: _vector_to_value,
    ex.ValueToColor: _value_to_color,
}
