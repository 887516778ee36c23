# SPDX-License-Identifier: GPL-3.0-or-later
"""Kinds of rays, and masks of them: which rays meet an object, a light or the world.

A mask is a sum of bits. Rays that a surface scatters are of one kind each, by the lobe that scattered them and the side on which they
leave; the kind says which bits of a mask let the ray meet a thing (Cycles' `path_state_ray_visibility` for objects,
`is_light_shader_visible_to_path` for lights and the world).
"""

from __future__ import annotations

from enum import IntEnum

CAMERA, DIFFUSE, GLOSSY, TRANSMISSION, SHADOW = 1, 2, 4, 8, 16
SCATTERED = DIFFUSE | GLOSSY | TRANSMISSION
"""All rays that surfaces scatter: what lights are lit for unless they say otherwise."""
SEEN = CAMERA | SCATTERED
EVERY = SEEN | SHADOW

RAY_NAMES = {"camera": CAMERA, "diffuse": DIFFUSE, "glossy": GLOSSY, "transmission": TRANSMISSION, "shadow": SHADOW}
"""The bits by the names that Blender gives them."""


class Kind(IntEnum):
    """The kind of a ray of a path.

    It comes from the camera, or is reflected or transmitted by a diffuse or another lobe.
    """

    CAMERA = 0
    DIFFUSE = 1
    GLOSSY = 2
    TRANSMISSION = 3
    TRANSLUCENCE = 4


OBJECT_BITS = (CAMERA, DIFFUSE, GLOSSY, TRANSMISSION, TRANSMISSION)
"""By kind: the bits that an object's mask must have for the ray to meet it."""
LIGHT_BITS = (CAMERA, DIFFUSE, GLOSSY, TRANSMISSION, TRANSMISSION | DIFFUSE)
"""By kind: the bits that the mask of a light or of the world must have for the ray to meet it."""

_REFLECTED, _SINGULAR = 32, 64
FLAGS = {
    "CAMERA": 1,
    "SHADOW": 2,
    "DIFFUSE": 4,
    "GLOSSY": 8,
    "TRANSMISSION": 16,
    "REFLECTION": _REFLECTED,
    "SINGULAR": _SINGULAR,
}
"""What shaders can ask of the ray that meets a point (Blender's Light Path node), as bits. Light samples have none of them."""
STEADY_FLAGS = ("CAMERA", "SHADOW")
"""Flags that light samples and the rays that lobes choose agree on."""
FLAGS_BY_KIND = (1, 4 | _REFLECTED, 8 | _REFLECTED, 8 | 16, 4 | 16)
"""By kind: its flags. What a rough interface transmits is glossy and transmitted, as in Cycles (`path_state_next`)."""

COUNTS = ("RAY_DEPTH", "DIFFUSE_DEPTH", "GLOSSY_DEPTH", "TRANSMISSION_DEPTH", "TRANSPARENT_DEPTH", "RAY_LENGTH")
"""What shaders can ask of the path that ends in the ray which meets a point (Blender's Light Path node), in the order of a tally.

How often it has scattered in all, by reflection from a diffuse or another lobe, and by transmission; how many transparent
faces it has passed; and the metres since it last scattered.
"""
COUNTS_OF_ALL_RAYS = ("RAY_DEPTH", "TRANSPARENT_DEPTH", "RAY_LENGTH")
"""Counts that shadow rays and the rays that lobes choose agree on: a shadow ray is one scattering further than what sends it
(Cycles' `svm_node_light_path`). It adds to no depth of its kind."""
COUNTS_OF_EMISSION = ("RAY_LENGTH",)
"""Counts that light samples of faces and the rays that meet these agree on, whatever lies between."""
DEPTH_OF_KIND = (-1, 0, 1, 2, 2)
"""By kind: which of the diffuse, glossy and transmission depths such a ray adds to (Cycles' `path_state_next`)."""


def has_bits(mask: int, bits: int) -> bool:
    """Whether a mask has all of the bits."""
    return mask & bits == bits


def tells_shadows_apart(mask: int) -> bool:
    """Whether shadow rays and some scattered rays differ in meeting an object of that mask."""
    return mask & (SCATTERED | SHADOW) not in (0, SCATTERED | SHADOW)


def list_rays(mask: int) -> str:
    """The names of the rays in a mask, after each other."""
    return ", ".join(name for name, bit in RAY_NAMES.items() if mask & bit)
