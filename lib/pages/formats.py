# SPDX-License-Identifier: GPL-3.0-or-later
"""Shares and durations as a person writes them.

They are the same on the terminal, in the panel and on pages.
"""

from __future__ import annotations

import math


def format_percent(value: float, sign: bool = True) -> str:
    """A share as a percentage with three significant digits.

    'unbounded' where it is not finite.

    >>> format_percent(0.0123), format_percent(0.01, sign=False), format_percent(float("inf"))
    ('+1.23 %', '1 %', 'unbounded')
    """
    if not math.isfinite(value):
        return "unbounded"
    return f"{100 * value:+.3g} %" if sign else f"{100 * value:.6g} %"


def format_part(value: float) -> str:
    """A part of something as a percentage without a plus sign.

    'unbounded' where it is not finite.

    >>> format_part(0.98765)
    '98.8 %'
    """
    return f"{100 * value:.3g} %" if math.isfinite(value) else "unbounded"


def format_bound(bound: float) -> str:
    """A bound as a percentage that is not below it, of two significant digits.

    >>> format_bound(0.01301), format_bound(0.2), format_bound(0.0)
    ('1.4 %', '20 %', '0 %')
    """
    if not math.isfinite(bound) or bound == 0.0:
        return "0 %" if bound == 0.0 else "unbounded"
    step = 10.0 ** (math.floor(math.log10(bound)) - 1)
    return f"{100 * step * math.ceil(bound / step * (1 - 1e-9)):.6g} %"


def format_duration(seconds: float) -> str:
    """Seconds in the unit that a person would use.

    >>> format_duration(5), format_duration(150), format_duration(2e9)
    ('5 s', '2.5 min', 'years')
    """
    for limit, unit, size in ((100, "s", 1), (6000, "min", 60), (172800, "h", 3600)):
        if seconds < limit:
            return f"{seconds / size:.2g} {unit}" if seconds / size < 10 else f"{seconds / size:.0f} {unit}"
    return f"{seconds / 86400:.0f} days" if seconds < 1e8 else "years"


def format_gigabytes(size: float) -> str:
    """Bytes in GB of 10^9 bytes.

    >>> format_gigabytes(16.4e9), format_gigabytes(64e6)
    ('16.4 GB', '0.064 GB')
    """
    return f"{size / 1e9:.3g} GB"
