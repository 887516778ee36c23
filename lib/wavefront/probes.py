# SPDX-License-Identifier: GPL-3.0-or-later
"""Probes about points of a surface: rays along three axes that meet all faces of the point's object within a ball.

King et al. 2013, "BSSRDF importance sampling": a disk across an axis is sampled, and what its ray meets is weighed against
the disks across the other two axes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from ..scene.expressions import Expression
from ..scene.materials import Material
from ..scene.scene import Scene
from ..textures.fold import walk
from ..vectors import basis_across, dot
from .casters import Casters


@dataclass(frozen=True)
class Axes:
    """The axis (3, n) of each probe, two unit vectors across it, and the chance with which it was chosen, (n,).

    One of the three vectors is the `ng` (3, n) of the point that the probe is about.
    """

    axis: np.ndarray
    across: np.ndarray
    beside: np.ndarray
    chance: np.ndarray
    ng: np.ndarray

    def weight(self, probe: np.ndarray, ng: np.ndarray) -> np.ndarray:
        """Return the weight (k,) of faces with unit normals `ng` (3, k) that the probes (k,) meet.

        It is that of the power heuristic over the density with which the disk finds the face's points, p / sum q^2 for
        p, q = chance |axis.ng|. The sum over the three axes follows from the cosine with the point's own normal.
        """
        own = dot(np.take(self.ng, probe, axis=1), ng)
        across = np.abs(dot(np.take(self.axis, probe, axis=1), ng))
        return np.take(self.chance, probe) * across / (_ACROSS**2 + (_ALONG**2 - _ACROSS**2) * own * own)


# The chances of the axis along the normal, and of each of the two across it.
_ALONG, _ACROSS = 0.5, 0.25


def choose_axes(ng: np.ndarray, u: np.ndarray) -> tuple[Axes, np.ndarray]:
    """Choose an axis for each probe by `u` (n,); return it with what is left of the uniform, (n,).

    Half of the probes go along the normal `ng` (3, n), a quarter along each of two axes across it.
    """
    t, s = basis_across(ng)
    first, last = (u >= _ALONG) & (u < 1.0 - _ACROSS), u >= 1.0 - _ACROSS
    axes = Axes(
        np.where(first, t, np.where(last, s, ng)),
        np.where(first, ng, t),
        np.where(last, ng, s),
        np.where(first | last, _ACROSS, _ALONG),
        ng,
    )
    begin = np.where(first, _ALONG, np.where(last, 1.0 - _ACROSS, 0.0))
    return axes, (u - begin) / axes.chance


@dataclass(frozen=True)
class ProbeHits:
    """All faces that probes meet, (k,) each: the probe's number, the triangle and Embree's barycentrics.

    position (3, k), on the face, and ng (3, k), the face's unit normal by the order of its corners.
    """

    probe: np.ndarray
    triangle: np.ndarray
    u: np.ndarray
    v: np.ndarray
    position: np.ndarray
    ng: np.ndarray


class Probes:
    """Rays that meet all faces of one object, not the nearest alone; it casts those of many objects together."""

    def __init__(self, object_index: np.ndarray, casters: Casters, objects: Iterable[int]) -> None:
        """`object_index` (t,) of the triangles; `objects` whose faces are probed."""
        self._object_index, self._whole = object_index, casters.whole
        self._own = {number: casters.for_object(number) for number in objects}

    def cast(
        self, start: np.ndarray, center: np.ndarray, ng: np.ndarray, u: np.ndarray, off: np.ndarray, reach: np.ndarray
    ) -> tuple[Axes, ProbeHits]:
        """Cast a probe about each point `center` (3, n) of the triangles `start` (n,), whose unit normals are `ng`.

        `u` (n,) chooses the axis and the angle, `off` (n,) is the distance in the disk across it, and `reach` (n,) the radius
        of the ball that the probe stays in; both are in metres.
        """
        axes, turn = choose_axes(ng, u)
        height = np.sqrt(np.maximum(reach * reach - off * off, 0.0))
        angle = 2.0 * np.pi * turn
        disk = center + axes.across * (off * np.cos(angle)) + axes.beside * (off * np.sin(angle))
        return axes, self.all_hits(start, disk + axes.axis * height, -axes.axis, 2.0 * height)

    def all_hits(self, start: np.ndarray, origin: np.ndarray, direction: np.ndarray, reach: np.ndarray) -> ProbeHits:
        """Return all that rays meet within `reach` (n,) metres on the objects of the triangles `start` (n,)."""
        owner = np.take(self._object_index, start)
        parts = []
        for number in np.unique(owner).tolist():
            index = np.flatnonzero(owner == number)
            here, along, left = np.take(origin, index, axis=1), np.take(direction, index, axis=1), reach[index]
            while index.size:
                hits = self._own[number].closest(here, along, left)
                met = np.flatnonzero(hits.triangle >= 0)
                index, along, hits = index[met], np.take(along, met, axis=1), hits.at(met)
                point = np.take(here, met, axis=1) + along * hits.distance
                placed, ng, offset = self._whole.on_plane(hits.triangle, point)
                parts.append(ProbeHits(index, hits.triangle, hits.u, hits.v, placed, ng))
                left = left[met] - hits.distance - offset
                going = np.flatnonzero(left > 0.0)
                here = np.take(placed + ng * np.copysign(offset, dot(ng, along)), going, axis=1)
                index, along, left = index[going], np.take(along, going, axis=1), left[going]
        if not parts:
            return ProbeHits(*(np.empty(0, np.intp),) * 2, *(np.empty(0),) * 2, *(np.empty((3, 0)),) * 2)
        names = vars(parts[0])
        return ProbeHits(*(np.concatenate([vars(part)[name] for part in parts], axis=-1) for name in names))


def objects_asking(scene: Scene, asks: Callable[[Expression], bool]) -> list[int]:
    """The objects with a face whose material has a node that `asks`."""

    def reads(material: Material) -> bool:
        sockets = [v for lobe in material.lobes for v in (lobe.weight, *vars(lobe.closure).values())]
        return any(asks(node) for socket in sockets if isinstance(socket, Expression) for node in walk(socket))

    asking = np.array([reads(material) for material in scene.materials], bool)
    return np.unique(scene.mesh.object_index[np.take(asking, scene.mesh.material_index)]).tolist()
