# SPDX-License-Identifier: GPL-3.0-or-later
"""The name `etalon` for scripts inside Blender.

An extension is called bl_ext.REPOSITORY.etalon there. While it is on, `import etalon` gives a module that has the
public names and nothing else. It is not a package: if it were, `import etalon.lib` would load every file a second time,
and errors raised by one copy would not be caught by the other's classes. No path is changed, and an `etalon` that is
installed by pip keeps its name.
"""

from __future__ import annotations

import importlib
import importlib.util
import sys
from types import ModuleType
from typing import Any

NAME = "etalon"


class PublicName(ModuleType):
    """A module that takes the public names of a package, each at its first use.

    `package` is the package's name.
    """

    def __init__(self, package: str) -> None:
        root = importlib.import_module(package)
        super().__init__(NAME, root.__doc__)
        self.__spec__ = importlib.util.spec_from_loader(NAME, loader=None)
        self.__all__ = root.__all__
        self.package = package

    def __getattr__(self, name: str) -> Any:
        if name not in vars(self).get("__all__", ()):
            raise AttributeError(f"module '{NAME}' has no attribute '{name}'")
        value = getattr(importlib.import_module(self.package), name)
        setattr(self, name, value)
        return value

    def __dir__(self) -> list[str]:
        return sorted(self.__all__)


def publish(package: str) -> None:
    """Make the package of that name importable as `etalon`.

    Another package that can be imported by that name keeps it.
    """
    if NAME not in sys.modules and importlib.util.find_spec(NAME) is None:
        sys.modules[NAME] = PublicName(package)


def withdraw() -> None:
    """Remove the name again, if it is the one that `publish` made."""
    if isinstance(sys.modules.get(NAME), PublicName):
        del sys.modules[NAME]
