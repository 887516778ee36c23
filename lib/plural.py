# SPDX-License-Identifier: GPL-3.0-or-later
"""A count with its noun, in every text of the product."""

from __future__ import annotations


def plural(count: int, noun: str, several: str = "") -> str:
    """A count with its noun, which takes an s, or is `several`, where the count is not 1.

    >>> plural(1, "region"), plural(0, "region"), plural(12000, "sample"), plural(2, "sample per pixel", "samples per pixel")
    ('1 region', '0 regions', '12,000 samples', '2 samples per pixel')
    """
    return f"{count:,} {noun}" if count == 1 else f"{count:,} {several or noun + 's'}"
