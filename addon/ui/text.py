# SPDX-License-Identifier: GPL-3.0-or-later
"""Text in panels, translated and wrapped.

It is wrapped to the width that there is, so that Blender cuts nothing off.
"""

from __future__ import annotations

from functools import lru_cache

import blf
import bpy

from ...lib.report.headline import Phrase

# What a panel takes of its region's width besides text, in pixels of an interface scale of 1; the tabs of a sidebar; a button of one icon.
MARGIN, TABS, BUTTON = 78, 22, 26

# The values of phrases that are words; all others are numbers and the user's own names, which are nobody's to translate.
_WORDS = ("light", "place")
# What no line may end before or after.
_TIED = {" %": "\u00a0%", "« ": "«\u00a0", " »": "\u00a0»", " :": "\u00a0:", " ;": "\u00a0;"}


def translate(text: str, **values: object) -> str:
    """`text` in the language of the interface, with `values` put into it."""
    translated = bpy.app.translations.pgettext_iface(text)
    return translated.format(**values) if values else translated


def phrase_text(phrase: Phrase) -> str:
    """A phrase in the language of the interface."""
    values = phrase.values | {name: translate(phrase.values[name]) for name in _WORDS if name in phrase.values}
    return translate(phrase.template, **values)


def text_width(context: bpy.types.Context) -> int:
    """The pixels that a line of text has in the region that is drawn."""
    scale = context.preferences.system.ui_scale
    is_sidebar = context.region.type == "UI"
    return max(int(context.region.width - scale * (MARGIN + (TABS if is_sidebar else 0))), int(60 * scale))


def font_size(context: bpy.types.Context) -> float:
    """The size of the interface's font, in points for blf."""
    return context.preferences.ui_styles[0].widget.points * context.preferences.system.ui_scale


def draw_text(
    layout: bpy.types.UILayout,
    context: bpy.types.Context,
    text: str,
    icon: str = "NONE",
    alert: bool = False,
    beside: bool = False,
) -> None:
    """Draw `text` over as many lines as it takes, `icon` in front of the first.

    `beside` leaves room for a button of one icon.
    """
    column = layout.column(align=True)
    column.alert = alert
    width = text_width(context) - (int(BUTTON * context.preferences.system.ui_scale) if beside else 0)
    for number, line in enumerate(wrap(text, width, font_size(context))):
        column.label(text=line, icon=icon if number == 0 or icon == "NONE" else "BLANK1", translate=False)


@lru_cache(maxsize=512)
def wrap(text: str, width: int, points: float) -> tuple[str, ...]:
    """Break `text` into lines of at most `width` pixels in a font of `points`.

    Words that are longer are broken.
    """
    blf.size(0, points)
    for loose, tied in _TIED.items():
        text = text.replace(loose, tied)
    lines, line = [], ""
    for word in text.split(" "):
        joined = f"{line} {word}" if line else word
        if blf.dimensions(0, joined)[0] <= width:
            line = joined
            continue
        if line:
            lines.append(line)
        while blf.dimensions(0, word)[0] > width and len(word) > 1:
            fits = next(n for n in range(len(word) - 1, 0, -1) if n == 1 or blf.dimensions(0, word[:n])[0] <= width)
            lines.append(word[:fits])
            word = word[fits:]
        line = word
    return (*lines, line) if line else tuple(lines)


@lru_cache(maxsize=4096)
def measure(text: str, points: float) -> float:
    """The width of `text` in pixels, in a font of `points`."""
    blf.size(0, points)
    return blf.dimensions(0, text)[0]


@lru_cache(maxsize=4096)
def shorten(text: str, width: int, points: float) -> str:
    """`text`, shortened where it is wider than `width` pixels.

    It is then its two ends with an ellipsis between them.
    """
    blf.size(0, points)
    if blf.dimensions(0, text)[0] <= width:
        return text
    for kept in range(len(text) - 1, 1, -1):
        short = f"{text[: (kept + 1) // 2]}…{text[len(text) - kept // 2 :]}"
        if blf.dimensions(0, short)[0] <= width:
            return short
    return text[:1] + "…"
