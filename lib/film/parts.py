# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of an image that are compared beside it.

They are light passes, limits of bounces, and the light of one emitter.
"""

from __future__ import annotations

from dataclasses import dataclass

from .light_passes import LightPass

_BOUNCES, _EMITTER = "bounces:", "emitter:"


@dataclass(frozen=True)
class BounceLimit:
    """The image with at most a given number of `bounces`.

    It is in Cycles' count: 0 is light that scatters once.
    """

    bounces: int

    def __str__(self) -> str:
        return f"up to {self.bounces} bounce{'' if self.bounces == 1 else 's'}"


@dataclass(frozen=True)
class EmitterLight:
    """The light of one emitter.

    It is a lamp or an object that emits, by its `name`, or the world, whose name is empty.
    """

    name: str

    def __str__(self) -> str:
        return f"light of '{self.name}'" if self.name else "light of the world"


WORLD = EmitterLight("")
Part = LightPass | BounceLimit | EmitterLight


def encode_part(part: Part) -> str:
    """A part as text, for another process and for names of arrays.

    >>> encode_part(BounceLimit(2)), encode_part(EmitterLight("Key")), encode_part(LightPass.EMISSION)
    ('bounces:2', 'emitter:Key', 'emission')
    """
    if isinstance(part, BounceLimit):
        return f"{_BOUNCES}{part.bounces}"
    return f"{_EMITTER}{part.name}" if isinstance(part, EmitterLight) else str(part)


def decode_part(text: str) -> Part:
    """The part that `encode_part` wrote.

    >>> decode_part("emitter:Key")
    EmitterLight(name='Key')
    """
    if text.startswith(_BOUNCES):
        return BounceLimit(int(text[len(_BOUNCES) :]))
    return EmitterLight(text[len(_EMITTER) :]) if text.startswith(_EMITTER) else LightPass(text)
