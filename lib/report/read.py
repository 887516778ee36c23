# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading a verdict.json back.

Only files of this version are read: what an older one lacks cannot be made up.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from ..errors import EtalonError
from .document import CHANGES, FORMAT, VERSION


def read_verdict(path: Path) -> dict[str, Any]:
    """The figures of a verdict.json, as verdict.schema.json describes them.

    Raises EtalonError where it cannot be read, is something else, or is of another version; of an older one it says what has changed since.
    """
    try:
        figures = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise EtalonError(f"{path}: cannot be read ({error.strerror}); compare again") from error
    except ValueError as error:
        raise EtalonError(f"{path}: is not JSON ({error}); compare again") from error
    if not isinstance(figures, dict) or figures.get("format") != FORMAT:
        raise EtalonError(f"{path}: is no verdict of etalon's; name the verdict.json that etalon compare wrote")
    version = figures.get("version")
    if version == VERSION:
        return figures
    if isinstance(version, int) and version < VERSION:
        since = " ".join(change for number, change in CHANGES.items() if number > version)
        raise EtalonError(
            f"{path}: is of version {version}, and this is read as version {VERSION}; compare again. {since}"
        )
    raise EtalonError(f"{path}: is of version {version}, and only version {VERSION} is known here; update etalon")
