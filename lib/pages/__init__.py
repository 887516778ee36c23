# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts that all HTML pages share.

They are one Jinja environment, one base template, one style, and one way to write numbers. page.py renders a template,
formats.py formats shares and durations, base.html and style.css are what all pages share.
"""

from .page import render_page

__all__ = ["render_page"]
