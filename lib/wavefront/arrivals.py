# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of each light arrives at what the camera sees, and at what lies around that.

It only steers which light is chosen: a bright lamp behind a wall, or the sun outside a closed room, is worth few samples.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..lights.light import LightSampler, luminance
from ..sampling.warps import cosine_hemisphere
from ..scene.camera import Camera
from ..vectors import dot, orthonormal_basis, to_world
from .camera_rays import camera_rays
from .raycaster import Raycaster

# Camera rays, and lights that are worth asking for.
RAYS, MOST = 2048, 64
# No point counts for more than so many times the twentieth that receives most: what stands beside a lamp says little of the rest.
_BRIGHTEST = 4.0
# Clear faces that light may pass, and how far behind one a ray goes on, as a part of its way and of the scene's radius.
_PANES, _PAST = 8, 1e-5
# The root of x^7 = x + 1, whose powers are spread evenly in six dimensions (Roberts 2018, "The unreasonable effectiveness of quasirandom
# sequences").
_SPREAD = 1.1127756842787055


def arriving_shares(
    lights: Sequence[LightSampler], caster: Raycaster, camera: Camera, clear: np.ndarray | None = None
) -> np.ndarray:
    """Return the part (k,) of the light of each of `lights` that no face hides from what the camera sees.

    It is the mean over the points that camera rays meet, and those that rays scattered there meet, weighted by what each would receive.
    1 where no point would receive anything. Faces that are `clear` (t,) bool hide nothing; by default there are none.
    """
    u = [np.modf(0.5 + np.arange(RAYS) * _SPREAD ** -(k + 1.0))[0] for k in range(6)]
    rays = camera_rays(camera, u[0] * camera.width, u[1] * camera.height, None)
    u = u if rays.index is None else [one[rays.index] for one in u]
    origin, direction, reach = rays.origin, rays.direction, rays.reach
    arrives, sent = np.zeros((2, len(lights)))
    for _ in range(2):
        hits = caster.closest(origin, direction, reach)
        met = np.flatnonzero(hits.triangle >= 0)
        if met.size == 0:
            break
        direction = np.take(direction, met, axis=1)
        point = np.take(origin, met, axis=1) + direction * hits.distance[met]
        point, normal, offset = caster.on_plane(hits.triangle[met], point)
        normal *= -np.copysign(1.0, dot(normal, direction))
        origin = point + normal * offset
        for k, light in enumerate(lights):
            found = light.sample(point, u[2][met], u[3][met])
            received = luminance(np.abs(found.radiance)) * np.maximum(dot(found.wi, normal), 0.0) / found.pdf
            received = np.where(np.isfinite(received), received, 0.0)
            received = np.minimum(received, _BRIGHTEST * np.quantile(received, 0.95))
            sent[k] += received.sum()
            arrives[k] += received[~_hidden(caster, clear, origin, found.wi, found.distance)].sum()
        direction = to_world(cosine_hemisphere(u[4][met], u[5][met]), *orthonormal_basis(normal), normal)
        u, reach = [one[met] for one in u], None
    return np.divide(arrives, sent, out=np.ones(len(lights)), where=sent > 0.0)


def _hidden(
    caster: Raycaster, clear: np.ndarray | None, origin: np.ndarray, direction: np.ndarray, reach: np.ndarray
) -> np.ndarray:
    """Whether a face that is not `clear` stands before the distance `reach` (n,), bool; or more than _PANES that are."""
    if clear is None:
        return caster.occluded(origin, direction, reach)
    hidden, left = np.ones(reach.size, bool), np.arange(reach.size)
    for _ in range(_PANES + 1):
        hits = caster.closest(origin, direction, np.minimum(reach, 1e30))
        is_met = hits.triangle >= 0
        hidden[left[~is_met]] = False
        on = np.flatnonzero(is_met & clear[hits.triangle])
        if on.size == 0:
            break
        step = hits.distance[on] * (1.0 + _PAST) + _PAST * caster.radius
        left, direction, reach = left[on], direction[:, on], reach[on] - step
        origin = origin[:, on] + direction * step
    return hidden
