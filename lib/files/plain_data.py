# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures as JSON.

They have plain types only and no number that is not finite, and there is one way of writing the file.
"""

from __future__ import annotations

import json
import math
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np


def make_plain(value: Any) -> Any:
    """`value` in JSON's own types.

    Arrays become lists, enumerations their values, numbers that are not finite None, everything else text.
    """
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, dict):
        return {str(key): make_plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [make_plain(entry) for entry in value]
    if isinstance(value, (np.ndarray, np.generic)):
        return make_plain(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, (bool, int, str)) else str(value)


def write_json(path: Path, figures: Any) -> None:
    """Write plain `figures` as UTF-8.

    Raises ValueError where a number is not finite, OSError where the file cannot be written.
    """
    text = json.dumps(figures, indent=1, ensure_ascii=False, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")
