# SPDX-License-Identifier: GPL-3.0-or-later
"""The input of a node's function.

It has the shading points, and a way to evaluate the node's inputs there.
"""

from __future__ import annotations

from typing import NoReturn, Protocol

import numpy as np

from ..scene.expressions import Expression
from .images import ImageSet


class Context(Protocol):
    """What a shading point tells its expressions; asked only for what they need."""

    size: int
    cos_wo: np.ndarray
    backfacing: np.ndarray
    flags: np.ndarray | int
    tally: np.ndarray | None
    n: np.ndarray
    ng: np.ndarray
    wo: np.ndarray
    step: float
    normal_scale: np.ndarray

    def coordinates(self, kind: str, uv_map: str) -> np.ndarray:
        """Coordinates (3, n) of a kind named in lib.scene.expressions.Coordinates."""
        ...

    def attribute(self, name: str) -> np.ndarray:
        """Red, green, blue, alpha, factor and presence of an attribute of the mesh, (6, n)."""
        ...

    def object_info(self) -> np.ndarray:
        """Location (3), colour (3), alpha, index and random number of the object, (9, n)."""
        ...

    def edge_distance(self) -> np.ndarray:
        """Return the distance (n,) from the nearest line through two corners of the triangle.

        It is in metres. The triangle is that of the point.
        """
        ...

    def pixel_width(self) -> np.ndarray:
        """Return how wide a pixel is across the view, (n,), in metres."""
        ...

    def open_share(self, normal: np.ndarray, distance: np.ndarray, only_local: bool, samples: int) -> np.ndarray:
        """Return an unbiased estimate (n,) of ambient occlusion by so many samples, 1 where nothing is near.

        It is about unit normals (3, n), by faces of the same object or of all within `distance` metres, () or (n,).
        """
        ...

    def averaged_normal(self, radius: np.ndarray, samples: int) -> np.ndarray:
        """Return an estimate (3, n) of the mean normal within `radius` metres, () or (n,), by so many samples."""
        ...

    def tangent_frame(self, uv_map: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the tangent (3, n), the bitangent's sign (n,) and the normal (3, n).

        They are for normal maps, in object space, on the front side.
        """
        ...

    def normal_to_world(self, normal: np.ndarray) -> np.ndarray:
        """Unit normals (3, n) of the world for those of the object's space."""
        ...

    def moved(self, direction: np.ndarray, step: float) -> Context:
        """The points `step` further along unit vectors (3, n) in the plane of their triangles."""
        ...

    def undisplaced(self) -> Context:
        """The points as they were before their vertices were displaced."""
        ...


class WithoutSurface(Context):
    """Base of contexts that are not points of a surface, as directions of the world.

    What only surfaces have raises TypeError.
    """

    @property
    def n(self) -> NoReturn:
        """No normal."""
        _refuse("shading normal")

    @property
    def ng(self) -> NoReturn:
        """No face."""
        _refuse("face")

    @property
    def wo(self) -> NoReturn:
        """No viewer of a surface."""
        _refuse("direction to the viewer")

    @property
    def step(self) -> NoReturn:
        """No step along a surface."""
        _refuse("step along a surface")

    @property
    def normal_scale(self) -> NoReturn:
        """No normal."""
        _refuse("shading normal")

    def attribute(self, name: str) -> NoReturn:
        """No mesh."""
        _refuse(f"attribute '{name}'")

    def object_info(self) -> NoReturn:
        """No object."""
        _refuse("object")

    def edge_distance(self) -> NoReturn:
        """No triangle."""
        _refuse("edge")

    def pixel_width(self) -> NoReturn:
        """No point that a pixel could be seen at."""
        _refuse("width of pixels")

    def open_share(self, normal: np.ndarray, distance: np.ndarray, only_local: bool, samples: int) -> NoReturn:
        """No point that faces could be near."""
        _refuse("occlusion")

    def averaged_normal(self, radius: np.ndarray, samples: int) -> NoReturn:
        """No faces to take the mean of."""
        _refuse("mean normal")

    def tangent_frame(self, uv_map: str) -> NoReturn:
        """No UV map."""
        _refuse(f"UV map '{uv_map}'")

    def normal_to_world(self, normal: np.ndarray) -> NoReturn:
        """No object."""
        _refuse("object")

    def moved(self, direction: np.ndarray, step: float) -> NoReturn:
        """No triangle."""
        _refuse("triangle")

    def undisplaced(self) -> NoReturn:
        """No vertices."""
        _refuse("vertex")


def _refuse(what: str) -> NoReturn:
    raise TypeError(f"there is no {what} without a surface")


class InputEvaluator(Protocol):
    """Evaluates the inputs of a node at the points of `context`.

    `evaluate.Evaluator` implements it.
    """

    context: Context
    images: ImageSet

    def __call__(self, expression: Expression) -> np.ndarray:
        """Return a value as () or (n,), a colour as (3, 1) or (3, n).

        The result is shared with others: never write into it.
        """
        ...

    def moved(self, context: Context) -> InputEvaluator:
        """An evaluator of the same images at other points."""
        ...
