# SPDX-License-Identifier: GPL-3.0-or-later
"""Findings about a scene: likely mistakes, and what was left out of the comparison."""

from __future__ import annotations

from dataclasses import dataclass

from ..plural import plural

OVERLAPPING_FACES = "overlapping faces"
"""The check that departures and the scene check name."""
OVERLAPPING_LIGHTS = "overlapping lights"
"""The check of area lights in one plane."""

_MOST_NAMES = 3


@dataclass(frozen=True)
class Finding:
    """One finding, for a user to read.

    `check` names the kind of finding, `what` says what was found and where, `effect` what it does to the comparison, `remedy` what to do.
    """

    check: str
    what: str
    effect: str
    remedy: str

    def __str__(self) -> str:
        return f"{self.check}: {self.what} {self.effect} {self.remedy}"


def list_names(names: list[str]) -> str:
    """At most three names in quotes, and how many more there are.

    >>> list_names(["a", "b", "c", "d", "e"])
    "'a', 'b', 'c' and 2 more"
    """
    shown = [f"'{name}'" for name in names[:_MOST_NAMES]]
    if len(names) > _MOST_NAMES:
        return f"{', '.join(shown)} and {len(names) - _MOST_NAMES} more"
    return " and ".join([", ".join(shown[:-1]), shown[-1]]) if len(shown) > 1 else shown[0]


def list_areas(areas: list[tuple[str, float]], noun: str, several: str) -> str:
    """At most three areas in square metres after what they are of, the largest first, and how many more there are.

    `noun` and `several` are what one and several of them are called.

    >>> list_areas([("'a' and 'b'", 0.5), ("'a' and 'c'", 2.0)], "pair", "pairs")
    "'a' and 'c' (2 m²); 'a' and 'b' (0.5 m²)"
    """
    largest = sorted(areas, key=lambda one: -one[1])
    shown = "; ".join(f"{of} ({area:.3g} m²)" for of, area in largest[:_MOST_NAMES])
    rest = len(largest) - _MOST_NAMES
    return f"{shown}; and {plural(rest, f'more {noun}', f'more {several}')}" if rest > 0 else shown
