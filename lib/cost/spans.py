# SPDX-License-Identifier: GPL-3.0-or-later
"""Forecast spans of seconds in words, the same on the terminal and on the page."""

from __future__ import annotations

from ..pages.formats import format_duration


def middle(span: dict[str, float | None]) -> str:
    """The median of a forecast span of seconds."""
    return "not reached" if span["median"] is None else format_duration(span["median"])


def ends(span: dict[str, float | None]) -> str:
    """The ends of a forecast span; nothing where it is out of reach."""
    if span["low"] is None:
        return ""
    if span["median"] is None:
        return f"at best {format_duration(span['low'])}"
    return f"{format_duration(span['low'])} to {'never' if span['high'] is None else format_duration(span['high'])}"


def took(span: dict[str, float | None]) -> str:
    """Median and ends of a forecast span in one phrase."""
    return f"{middle(span)} ({ends(span)})" if ends(span) else middle(span)
