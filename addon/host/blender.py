# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender as a Python module: importing it, and what to install where that fails."""

from __future__ import annotations

import importlib
from typing import Any

from ...lib.errors import EtalonError
from .libraries import explain_import
from .quiet import quiet


def load_blender() -> Any:
    """Import bpy and return it.

    Raises EtalonError, which says what to install, where bpy or a system library is missing.
    """
    try:
        with quiet():
            return importlib.import_module("bpy")
    except ModuleNotFoundError as error:
        if error.name != "bpy":
            raise
        raise EtalonError(
            "Blender is not installed for this Python; use Python 3.11 or 3.13 and run `pip install bpy`, "
            "or render a scene saved as .npz, which needs no Blender"
        ) from error
    except ImportError as error:
        raise EtalonError(f"Blender cannot start: {explain_import(error) or error}") from error
