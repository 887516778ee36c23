# SPDX-License-Identifier: GPL-3.0-or-later
"""Questions about what fills the space between faces."""

from __future__ import annotations

from .facts import Facts
from .geometry import Answer
from .surface import named


def volumes(facts: Facts) -> Answer:
    """Whether light is absorbed or emitted on its way between faces."""
    return named(facts.volumes, "light passes the volume of", "light passes from face to face as through a vacuum")


def scattering(facts: Facts) -> Answer:
    """Whether light is scattered between faces."""
    return named(facts.turbid, "light is scattered in the volume of", "no volume scatters light")
