# SPDX-License-Identifier: GPL-3.0-or-later
"""The names of the light passes.

They are parts of an image by what scattered the light first, and how often it was scattered.
"""

from __future__ import annotations

from enum import StrEnum


class Family(StrEnum):
    """What scatters light, a kind of lobe or a volume, as Cycles counts it.

    Translucent lobes are diffuse, and glass is glossy on the viewer's side.

    Volumes come last: they have what the lobes leave.
    """

    DIFFUSE = "diffuse"
    GLOSSY = "glossy"
    TRANSMISSION = "transmission"
    VOLUME = "volume"


class LightPass(StrEnum):
    """A part of the light that reaches the camera; together they are the whole image.

    Light that scattered once is direct, and indirect if it scattered more often; the first scattering that the camera sees names the
    family. Emission is seen without any scattering, in faces and light objects, and the environment where there is no face.
    """

    DIFFUSE_DIRECT = "diffuse direct"
    DIFFUSE_INDIRECT = "diffuse indirect"
    GLOSSY_DIRECT = "glossy direct"
    GLOSSY_INDIRECT = "glossy indirect"
    TRANSMISSION_DIRECT = "transmission direct"
    TRANSMISSION_INDIRECT = "transmission indirect"
    VOLUME_DIRECT = "volume direct"
    VOLUME_INDIRECT = "volume indirect"
    EMISSION = "emission"
    ENVIRONMENT = "environment"


def direct(family: Family) -> LightPass:
    """The pass of what a family scatters once."""
    return LightPass(f"{family} direct")


def indirect(family: Family) -> LightPass:
    """The pass of what scatters again before a family scatters it to the camera."""
    return LightPass(f"{family} indirect")


INDIRECT = frozenset(map(indirect, Family))


def is_asked(name: LightPass, passes: str) -> bool:
    """Return whether the option `passes` asks for a pass.

    It does by 'all', by the pass's own name or by that of its family.
    """
    return passes == "all" or name.split()[0] == passes
