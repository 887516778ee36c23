# SPDX-License-Identifier: GPL-3.0-or-later
"""Modules that cannot be imported: what to install."""

from __future__ import annotations

import sys

# What Blender, OpenImageIO and Embree need besides what their wheels bring.
DEBIAN = "libx11-6 libxrender1 libxfixes3 libxi6 libxkbcommon0 libsm6 libice6 libgl1 libgomp1 zlib1g"
FEDORA = "libX11 libXrender libXfixes libXi libxkbcommon libSM libICE libglvnd-glx libgomp zlib"
# How the dynamic linkers of Linux, macOS and Windows begin or end what they say.
_OF_A_LINKER = (
    "shared object",
    "lib.so",
    ".so.",
    ".so:",
    "invalid ELF header",
    "dlopen",
    "Library not loaded",
    "DLL load failed",
)


def explain_import(error: ImportError) -> str:
    """One line on a missing module or system library, with the command that installs it.

    '' for another error.
    """
    if not (isinstance(error, ModuleNotFoundError) or any(words in str(error) for words in _OF_A_LINKER)):
        return ""
    if isinstance(error, ModuleNotFoundError):
        package = (error.name or "a module").partition(".")[0]
        return f"the Python package {package} is not installed; run `{sys.executable} -m pip install --upgrade etalon`"
    reason = " ".join(str(error).split())
    if sys.platform == "win32":
        return f"{reason}; install the Microsoft Visual C++ Redistributable, and install the package again"
    if sys.platform == "darwin":
        return f"{reason}; update macOS, or install the package again"
    return f"{reason}; install the system libraries, on Debian or Ubuntu: apt-get install {DEBIAN}; on Fedora: dnf install {FEDORA}"
