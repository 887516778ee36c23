# SPDX-License-Identifier: GPL-3.0-or-later
"""The releases of Blender that Étalon works with, and ranges of releases.

Ranges serve facts that hold in some releases only.
"""

from __future__ import annotations

from dataclasses import dataclass

Release = tuple[int, int]
"""Major and minor version: (5, 2) for every 5.2.x."""

OLDEST: Release = (4, 2)
"""The oldest release that Étalon runs in."""

NEWEST_CHECKED: Release = (5, 3)
"""The newest release whose Cycles was checked. pyproject.toml caps bpy below the next one; a test binds the two."""


@dataclass(frozen=True)
class Versions:
    """A range of Blender releases, both ends included; None leaves an end open.

    `Versions("5.0", "5.2")` holds 5.0.0 to 5.2.9, `Versions("5.3")` 5.3 and later, `Versions()` every release.

    >>> (5, 2) in Versions("5.0", "5.2"), (5, 3) in Versions("5.0", "5.2"), (5, 3, 1) in Versions("5.3")
    (True, False, True)
    >>> str(Versions("5.3")), str(Versions(None, "5.2")), str(Versions("5.0", "5.2"))
    ('5.3 and later', 'up to 5.2', '5.0 to 5.2')
    """

    first: str | None = None
    last: str | None = None

    def __contains__(self, version: tuple[int, ...]) -> bool:
        """Whether a release (its first two numbers) lies in the range."""
        release = tuple(version[:2])
        return (self.first is None or release >= parse_release(self.first)) and (
            self.last is None or release <= parse_release(self.last)
        )

    def __str__(self) -> str:
        """The range in words."""
        if self.first is None:
            return "all versions" if self.last is None else f"up to {self.last}"
        if self.last is None:
            return f"{self.first} and later"
        return self.first if self.first == self.last else f"{self.first} to {self.last}"


def parse_release(text: str) -> Release:
    """The release that '5.2' or '5.2.3' names."""
    major, minor = text.split(".")[:2]
    return int(major), int(minor)


def format_release(release: tuple[int, ...]) -> str:
    """'5.2' for (5, 2) or (5, 2, 3)."""
    return ".".join(map(str, release[:2]))


def describe_unchecked(release: Release | None) -> str:
    """A warning where `release` is newer than the newest checked; '' elsewhere.

    >>> describe_unchecked((5, 3)), describe_unchecked(None)
    ('', '')
    """
    if release is None or tuple(release) <= NEWEST_CHECKED:
        return ""
    return (
        f"Blender {format_release(release)} is newer than {format_release(NEWEST_CHECKED)}, the newest release that Étalon was "
        "checked with. A difference may be a change in Cycles that Étalon does not know yet."
    )
