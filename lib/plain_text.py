# SPDX-License-Identifier: GPL-3.0-or-later
"""Names from untrusted files, made safe.

They then suit a terminal, a folder's name and a spreadsheet.
"""

from __future__ import annotations

import re
import unicodedata
from typing import Any

# Colours are the only sequences of a terminal that programs here send on purpose.
_CONTROL = re.compile(
    "\x1b(?!\\[[0-9;]*m)|[\x00-\x08\x0b\x0c\x0e-\x1a\x1c-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]"
)
_FORMULA = ("=", "+", "-", "@", "\t", "\r")
_RESERVED = re.compile(r"(?:con|prn|aux|nul|com\d|lpt\d)(?:\.|$)", re.IGNORECASE)
_LONGEST = 100


def _escape(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii")


def one_line(text: str) -> str:
    r"""`text` with every line break, control character and invisible mark written as an escape.

    >>> print(one_line("Lamp\n\x1b[2J"))
    Lamp\n\x1b[2J
    """
    return "".join(c if c.isprintable() or unicodedata.category(c) == "Zs" else _escape(c) for c in text)


def escape_controls(text: str) -> str:
    r"""`text` with control characters written as escapes.

    Line breaks, carriage returns, tabs and colours stay.

    >>> print(escape_controls("\x1b[2J"))
    \x1b[2J
    """
    return _CONTROL.sub(lambda found: _escape(found[0]), text)


def folder_name(name: str) -> str:
    """A folder's name made from any text: one folder, below the current one, on every system.

    >>> folder_name("kitchen"), folder_name(".."), folder_name("a/b")
    ('kitchen', 'scene', 'a_b')
    """
    kept = "".join(c if c.isprintable() and c not in '<>:"/\\|?*' else "_" for c in name).strip(". ")
    kept = kept.encode()[:_LONGEST].decode(errors="ignore").strip(". ")
    return f"_{kept}" if _RESERVED.match(kept) else kept or "scene"


def spreadsheet_cell(value: Any) -> Any:
    """`value` for a cell of a CSV file.

    A text that a spreadsheet would run as a formula begins with an apostrophe.

    >>> spreadsheet_cell("=1+1"), spreadsheet_cell("-0.5"), spreadsheet_cell(-0.5)
    ("'=1+1", '-0.5', -0.5)
    """
    if not isinstance(value, str) or not value.lstrip(" ").startswith(_FORMULA):
        return value
    try:
        float(value)
    except ValueError:
        return f"'{value}"
    return value
