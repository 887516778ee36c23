# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendering of pages: every template extends base.html, and every name in it is escaped."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from ..plural import plural
from .formats import format_bound, format_duration, format_part, format_percent

HERE = Path(__file__).parent


def render_page(
    template: Path, values: Mapping[str, Any], filters: Mapping[str, Callable[..., Any]] | None = None
) -> str:
    """The page that `template` makes of `values`, as text.

    Names in a .blend are untrusted, so whatever is not marked as safe is escaped. A name that the template uses and
    `values` lacks raises jinja2.UndefinedError. Besides `filters` a template has `bound`, `percent`, `part`,
    `duration` and `plural`.
    """
    environment = _environment(template.parent)
    environment.filters.update(filters or {})
    return environment.get_template(template.name).render(values)


def compile_templates(folder: Path) -> None:
    """Compile the templates of a folder, as `render_page` would at its first call."""
    environment = _environment(folder)
    for name in environment.list_templates(["html", "css", "js"]):
        environment.get_template(name)


@cache
def _environment(folder: Path) -> Environment:
    """What reads the templates of a folder; it keeps those that it has compiled, which takes a quarter of a second."""
    environment = Environment(
        loader=FileSystemLoader([folder, HERE]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(
        {
            "bound": format_bound,
            "percent": format_percent,
            "part": format_part,
            "duration": format_duration,
            "plural": plural,
        }
    )
    return environment
