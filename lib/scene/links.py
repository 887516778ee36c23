# SPDX-License-Identifier: GPL-3.0-or-later
"""Light linking: which objects an emitter lights, and which of them hide it from others.

Objects that are linked alike make a set with a number; 0 is the set of those that no emitter names. An emitter has a sum of bits, one for
each set (Cycles' `light_set_membership` and `shadow_set_membership`).
"""

from __future__ import annotations

from dataclasses import dataclass

EVERY_SET = -1
"""The bits of all sets, however many there are."""


@dataclass(frozen=True)
class Links:
    """What an emitter lights, and what casts its shadows.

    `receivers` are the sets of objects that its light reaches, `blockers` those that cast its shadows.
    """

    receivers: int = EVERY_SET
    blockers: int = EVERY_SET


UNLINKED = Links()


def has_set(sets: int, number: int) -> bool:
    """Whether set `number` is among the `sets`."""
    return bool(sets >> number & 1)
