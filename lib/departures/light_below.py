# SPDX-License-Identifier: GPL-3.0-or-later
"""A departure: light sampling reaches below faces whose shading normal leans, BSDF sampling does not."""

from __future__ import annotations

import numpy as np

from ..bsdfs.lobe import Lobe
from ..bsdfs.tilted import Tilted
from ..scene.materials import Closure, Diffuse, Sheen, Subsurface, Toon
from ..vectors import dot

LIGHT_BELOW = "light below the face"
"""The departure that lets light sampling reach below faces whose shading normal leans."""
# What Cycles takes for diffuse as it samples (CLOSURE_IS_BSDF_DIFFUSE in kernel/svm/types.h), but for what lets light through.
_DIFFUSE_REFLECTION = (Diffuse, Subsurface, Sheen, Toon)


class HeldAgainstFace(Tilted):
    """A lobe about a normal of its own whose samples are held against the `face` (3, n), a normal in the common local frame.

    They are rejected where the two do not see them on the same side. Only those of a `diffuse_reflection` are also held against the
    common normal, by which they have no weight. Evaluation asks the common normal alone.
    """

    def __init__(self, lobe: Lobe, rows: np.ndarray, face: np.ndarray, diffuse_reflection: bool) -> None:
        super().__init__(lobe, rows)
        self._face, self._diffuse_reflection = face, diffuse_reflection

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The lobe's direction, turned back, its weight and density."""
        own, weight, pdf = self._lobe.sample(u1, u2)
        wi = (self._rows * own[:, None]).sum(axis=0)
        above = own[2] * dot(self._face, wi) > 0.0
        counts = above & self._counts(own[2], wi[2]) if self._diffuse_reflection else above
        return wi, weight * counts, pdf if self.delta else pdf * above

    def part(self, index: np.ndarray) -> HeldAgainstFace:
        """The same lobe at fewer points."""
        rows, face = np.take(self._rows, index, axis=2), np.take(self._face, index, axis=1)
        return HeldAgainstFace(self._lobe.part(index), rows, face, self._diffuse_reflection)


def hold_against_face(lobe: Lobe, rows: np.ndarray, face: np.ndarray, closure: Closure) -> HeldAgainstFace:
    """The lobe of `closure` about a normal of its own, as Cycles samples it."""
    return HeldAgainstFace(lobe, rows, face, type(closure) in _DIFFUSE_REFLECTION)
