# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves while the shutter is open.

The shutter time runs from 0, where it opens, to 1, where it closes. Keys are equally spaced over it, the first at 0
and the last at 1; interpolation.py says what lies between them.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Motion:
    """Keys of a scene's objects and camera, and the shutter's curve.

    There are at least two keys of each. Something moves.

    objects: index of the object -> (k, 3, 4) `world_from_object`. positions: index of the object -> (k, 3, v) vertices
    in object space, for meshes that deform, those that faces use, in the order in which the scene's mesh has them.
    normals: index of the object -> (k, 3 corners, 3, t) unit normals of the corners of its faces, for meshes that deform
    and have smooth faces; in object space where `objects` has the object, else in world space, where they are mixed.
    camera: (k, 3, 4) `world_from_camera`, rigid; None where it stands still. shutter: (n,) how far it is open at
    equally spaced times, linear between; None where it opens and closes at once.
    """

    objects: dict[int, np.ndarray] = field(default_factory=dict)
    positions: dict[int, np.ndarray] = field(default_factory=dict)
    normals: dict[int, np.ndarray] = field(default_factory=dict)
    camera: np.ndarray | None = None
    shutter: np.ndarray | None = None
