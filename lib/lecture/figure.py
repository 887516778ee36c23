# SPDX-License-Identifier: GPL-3.0-or-later
"""One figure of the page.

It has texts in two languages, a drawing, its numbers, and what proves them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from markupsafe import Markup


@dataclass(frozen=True)
class Words:
    """A text in both languages of the page."""

    english: str
    french: str


def show_words(words: Words) -> Markup:
    """Both texts as spans, of which the page shows one."""
    return Markup('<span lang="en">{}</span><span lang="fr">{}</span>').format(words.english, words.french)


@dataclass(frozen=True)
class Caption:
    """The texts around a figure.

    They are the lecture's slide, a title, an explanation, and the test that proves the numbers.
    """

    slide: str
    title: Words
    text: Words
    test: str


@dataclass(frozen=True)
class Figure:
    """A drawing (SVG or a table, as HTML that is safe), and its data.

    `numbers` are plain data from which it was drawn.
    """

    drawing: Markup
    numbers: dict[str, Any]
