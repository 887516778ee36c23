# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors in the language of the interface.

Errors are made where no interface is known, so this module recognises them by their templates.
"""

from __future__ import annotations

import re

from .text import translate

TEMPLATES = (
    "{path}: cannot be written ({reason}); make room or name another folder",
    "{place} cannot be written ({reason}); make room or name another folder",
    "{folder} cannot be written ({reason}); name another folder",
    "{folder} is a file, not a folder; name another folder",
    "{title} ended early ({words}); compare from the command line to see more",
    "etalon {command}: the second Blender ended early",
    "{name}: cancelled before both sides had an image; there is nothing to compare",
    "{name}: light from materials that are not simulated reaches every pixel; simplify them, or lower the bounces",
    "{name}: light passes cannot be compared beside unsupported materials; leave out --passes",
    "{name}: was saved by Blender {needed}, and this is {here}, which loses what is new in it; open it with Blender {newer} or newer",
    "this machine has {size} GB; {remedy}",
    "{kind}: {error}; please report it with the console's text",
    "{owner}: {what} is not simulated; {remedy}",
)
# Values of the templates that are words of Étalon's own, and the kinds of things that own something.
VALUES = (
    "the second Blender",
    "lower the resolution, or give a time and let a smaller image be compared",
    "switch it off",
    "do not render it",
    "set Render As of its particles to Object, or do not render it",
    "unlink it",
    "include it again",
)
KINDS = ("material", "object", "light", "world", "scene", "collection")
_OWNER = re.compile(f"({'|'.join(KINDS)}) '(.*)'", re.DOTALL)


def pattern_of(template: str) -> re.Pattern[str]:
    """A pattern that finds the values of `template` in a text that was made from it."""
    parts = re.split(r"\{(\w+)\}", template)
    return re.compile("".join(f"(?P<{p}>.+)" if n % 2 else re.escape(p) for n, p in enumerate(parts)), re.DOTALL)


_PATTERNS = {template: pattern_of(template) for template in TEMPLATES}


def translate_error(text: str) -> str:
    """The message of an error in the language of the interface.

    It is returned as it is where no template fits.
    """
    for template, pattern in _PATTERNS.items():
        found = pattern.fullmatch(text)
        if found:
            return translate(template, **{name: _translate_value(value) for name, value in found.groupdict().items()})
    return text


def _translate_value(value: str) -> str:
    owner = _OWNER.fullmatch(value)
    if owner:
        return translate("{kind} '{name}'", kind=translate(owner[1]), name=owner[2])
    return translate(value) if value in VALUES else value
