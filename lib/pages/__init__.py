# SPDX-License-Identifier: GPL-3.0-or-later
"""The ground floor of every HTML page: one Jinja environment, one base template, one style, one way to say numbers.

page.py renders a template, formats.py says shares and durations, base.html and style.css are what all pages share.
"""

from .page import render_page

__all__ = ["render_page"]
