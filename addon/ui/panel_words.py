# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors that advise options of the command line, in the words of the panel.

Most errors read alike in both. Here are the templates that do not: each with what the panel says, in English.
"""

from __future__ import annotations

import re

from .properties import SHOWN

_NO_PASSES = "set Light passes to None"
_NO_LIGHTS = "switch Lights off"
IN_PANEL: dict[str, str] = {
    "--partial does not know motion blur; leave --partial or --motion-blur out": (
        "Partial does not know motion blur; switch Partial or Motion blur off"
    ),
    "{name} has no light passes; leave out --passes, or use a strategy of path tracing": (
        f"{{name}} has no light passes; {_NO_PASSES}, or choose another Strategy"
    ),
    "{name}: light passes cannot be compared beside unsupported materials; leave out --passes": (
        f"{{name}}: light passes cannot be compared beside unsupported materials; {_NO_PASSES}"
    ),
    "Cycles wrote no pass '{name}'; compare without --passes and --lights": (
        f"Cycles wrote no pass '{{name}}'; {_NO_PASSES}, and {_NO_LIGHTS}"
    ),
    "{name}: no object has this name, so its light cannot be told apart; leave --lights out (probe: --no-lights)": (
        f"{{name}}: no object has this name, so its light cannot be told apart; {_NO_LIGHTS}"
    ),
    "{name}: it is linked from another file and takes no light group; leave --lights out (probe: --no-lights)": (
        f"{{name}}: it is linked from another file and takes no light group; {_NO_LIGHTS}"
    ),
    "{count} lamps and emitting objects cannot be told apart, {most} can; leave --lights out (probe: --no-lights)": (
        f"{{count}} lamps and emitting objects cannot be told apart, {{most}} can; {_NO_LIGHTS}"
    ),
    "light that volumes emit is no lamp's and no object's; leave --lights out (probe: --no-lights)": (
        f"light that volumes emit is no lamp's and no object's; {_NO_LIGHTS}"
    ),
    "--{option} {value} is for distributions of microfacets, and '{model}' has none; leave one of them out": (
        "{option} {value} is for distributions of microfacets, and '{model}' has none; change one of them"
    ),
    "keep them constant, or leave --motion-blur out": "keep them constant, or switch Motion blur off",
    "leave --motion-blur out": "switch Motion blur off",
}
_LABELS = {declared.flag: declared.panel.label for declared in SHOWN}
_OPTION = re.compile(r"(?<![\w-])--([a-z][a-z-]*)")


def in_panel(texts: dict[str, str]) -> dict[str, str]:
    """A table of translations by what the panel says in English."""
    return {IN_PANEL.get(text, text): said for text, said in texts.items()}


def name_properties(text: str) -> str:
    """`text` with the panel's names in place of options.

    An option that the panel does not have loses its dashes.
    """
    return _OPTION.sub(lambda found: _LABELS.get(found[1], found[1]), text)
