# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors in the language of the interface.

Errors are made where no interface is known, so this module recognises them by their templates.
"""

from __future__ import annotations

import re

from .french_errors import ERRORS
from .french_refusals import REMEDIES, WHATS
from .panel_words import IN_PANEL, name_properties
from .text import translate

REFUSAL = "{owner}: {what} is not simulated; {remedy}"
NODE = "node '{name}' ({label})"
IN_GROUP = "group '{group}', {node}"
OWNER = "{kind} '{name}'"
TEMPLATES = (REFUSAL, NODE, IN_GROUP, OWNER)
# What owns something that is not simulated, with a name or without one, and what else is a value of a template.
KINDS = ("material", "object", "light", "world", "scene", "collection", "mesh", "view layer")
VALUES = ("the scene", "the file", "the camera", "the second Blender")
_OWNER = re.compile(f"({'|'.join(KINDS)}) '(.*)'", re.DOTALL)
_NODE = re.compile(r"(?:group '(?P<group>.*?)', )?node '(?P<name>.*?)' \((?P<label>[^()]*)\)(?P<rest>.*)", re.DOTALL)


def pattern_of(template: str) -> re.Pattern[str]:
    """A pattern that finds the values of `template` in a text that was made from it."""
    parts = re.split(r"\{(\w+)\}", template)
    return re.compile("".join(f"(?P<{p}>.+)" if n % 2 else re.escape(p) for n, p in enumerate(parts)), re.DOTALL)


def _patterns_of(texts: dict[str, str]) -> dict[str, re.Pattern[str]]:
    """The patterns of templates, those with most words of their own first."""
    longest = sorted(texts, key=lambda one: -len(re.sub(r"\{\w+\}", "", one)))
    return {template: pattern_of(template) for template in longest}


_REFUSAL = pattern_of(REFUSAL)
_ERRORS, _WHATS, _REMEDIES = (_patterns_of(texts) for texts in (ERRORS, WHATS, REMEDIES))


def translate_error(text: str) -> str:
    """The message of an error in the language of the interface.

    It names the panel's properties, not options of the command line. Where no template fits, it is English.
    """
    refusal = _REFUSAL.fullmatch(text)
    if refusal:
        values = {
            "owner": _translate_value("owner", refusal["owner"]),
            "what": _translate_what(refusal["what"]),
            "remedy": _fit_all(refusal["remedy"], _REMEDIES),
        }
        return translate(REFUSAL, **values)
    return _fit_all(text, _ERRORS)


def _fit_all(text: str, patterns: dict[str, re.Pattern[str]]) -> str:
    """`text` by the first template that fits it, or as it is but for the names of options."""
    fitting = _fit(text, patterns)
    return name_properties(text) if fitting == text else fitting


def _fit(text: str, patterns: dict[str, re.Pattern[str]]) -> str:
    """`text` by the first template that fits it; as it is where none does."""
    for template, pattern in patterns.items():
        found = pattern.fullmatch(text)
        if found:
            values = {name: _translate_value(name, value) for name, value in found.groupdict().items()}
            return translate(IN_PANEL.get(template, template), **values)
    return text


def _translate_what(text: str) -> str:
    """What is not simulated: a node with what of it, or a thing by itself."""
    found = _NODE.fullmatch(text)
    if found is None:
        return _fit(text, _WHATS)
    node = translate(NODE, name=found["name"], label=found["label"]) + _fit(found["rest"], _WHATS)
    return node if found["group"] is None else translate(IN_GROUP, group=found["group"], node=node)


def _translate_value(name: str, value: str) -> str:
    """The value called `name` of a template, where that consists of words of Étalon's own."""
    owner = _OWNER.fullmatch(value)
    if owner:
        return translate(OWNER, kind=translate(owner[1]), name=owner[2])
    if value in VALUES or value in KINDS:
        return translate(value)
    patterns = {"what": _WHATS, "fault": _WHATS, "place": _WHATS, "remedy": _REMEDIES}.get(name)
    return value if patterns is None else _fit(value, patterns)
