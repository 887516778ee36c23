# SPDX-License-Identifier: GPL-3.0-or-later
"""The software that a comparison was made with."""

from __future__ import annotations

import platform

import numpy as np
import scipy

from ..version import VERSION


def versions() -> dict[str, str]:
    """What a report says about the software it was made with."""
    return {
        "etalon": VERSION,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "system": platform.platform(),
    }
