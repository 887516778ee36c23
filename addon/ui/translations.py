# SPDX-License-Identifier: GPL-3.0-or-later
"""Translations, in the form in which Blender takes them."""

from __future__ import annotations

import bpy

from .french import FRENCH
from .french_errors import ERRORS
from .french_refusals import REMEDIES, WHATS
from .panel_words import in_panel

# What Blender calls the language before and since it dropped the country.
_LOCALES = ("fr_FR", "fr")
_CONTEXTS = ("*", "Operator")


def contexts(texts: dict[str, str]) -> dict[str, dict[tuple[str, str], str]]:
    """A dictionary for Blender: labels of buttons are looked up in a context of their own."""
    found = {(context, text): said for text, said in texts.items() for context in _CONTEXTS}
    return dict.fromkeys(_LOCALES, found)


def add_translations() -> None:
    """Have Blender know them."""
    bpy.app.translations.register(__name__, contexts(in_panel(FRENCH | ERRORS | WHATS | REMEDIES)))


def remove_translations() -> None:
    """Take them back."""
    bpy.app.translations.unregister(__name__)
