# SPDX-License-Identifier: GPL-3.0-or-later
"""How the tables of properties are made.

Each property is read, set neutral, or unable to change the image, for a reason.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import cached_property

from ....lib.blender_versions import Versions

EVERY_RELEASE = Versions()


@dataclass(frozen=True)
class Group:
    """The known properties of one kind of struct; names are separated by blanks.

    `read`: properties that the export or the renderer reads, sets per render, or refuses itself. `values`: enums that are read,
    with the values that are read or refused by name; any other value is refused. `neutral`: properties that cannot change the
    image of a still on the CPU, by reason; a name may end in `*`. `held`: properties that `cycles.neutral` sets.
    `versions`: names that not every release has, by the releases that have them.
    """

    read: str = ""
    values: Mapping[str, str] = field(default_factory=dict)
    neutral: Mapping[str, str] = field(default_factory=dict)
    held: Iterable[str] = ()
    versions: Mapping[Versions, str] = field(default_factory=dict)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """All names in the tables, patterns among them."""
        neutral = (name for names in self.neutral.values() for name in names.split())
        return (*self.read.split(), *self.values, *neutral, *self.held)

    def releases_of(self, name: str) -> Versions:
        """The releases that have the property `name` of a table."""
        return next((span for span, names in self.versions.items() if name in names.split()), EVERY_RELEASE)

    def knows(self, name: str, release: tuple[int, ...]) -> bool:
        """Whether a table has the property `name` of a release."""
        return any(
            (known == name or ("*" in known and fnmatchcase(name, known))) and release in self.releases_of(known)
            for known in self.names
        )
