# SPDX-License-Identifier: GPL-3.0-or-later
"""Étalon: an independent reference beside Cycles, and a verdict on where the two agree.

    import etalon

    comparison = etalon.compare("kitchen.blend", etalon.Settings(time=60))
    print(comparison.verdict.outcome)

The same import works where Étalon is installed by pip, and inside Blender where it is an extension.
`help(etalon.compare)` and the other functions have examples. The names come from api.py, at their first use:
importing this file imports neither Blender nor NumPy.

`lib` computes light and never imports bpy; `addon` talks to Blender and computes no light. This file is Blender's way
in, too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .lib.version import VERSION

if TYPE_CHECKING:
    from .api import (
        BatchResult,
        Comparison,
        Cost,
        CostOptions,
        EtalonError,
        Film,
        FitSettings,
        Identification,
        Outcome,
        Plan,
        ProbeOptions,
        ProbeResult,
        Refused,
        RenderOptions,
        Settings,
        Target,
        batch,
        compare,
        cost,
        fit,
        plan,
        probe,
        render,
    )

__version__ = VERSION

__all__ = [
    "BatchResult",
    "Comparison",
    "Cost",
    "CostOptions",
    "EtalonError",
    "Film",
    "FitSettings",
    "Identification",
    "Outcome",
    "Plan",
    "ProbeOptions",
    "ProbeResult",
    "Refused",
    "RenderOptions",
    "Settings",
    "Target",
    "__version__",
    "batch",
    "compare",
    "cost",
    "fit",
    "plan",
    "probe",
    "render",
]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'etalon' has no attribute '{name}'")
    from . import api

    return getattr(api, name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])


def register() -> None:
    """Register the extension with Blender."""
    from . import public_name
    from .addon.ui import registration

    registration.register()
    public_name.publish(__name__)


def unregister() -> None:
    """Remove the extension from Blender again."""
    from . import public_name
    from .addon.ui import registration

    public_name.withdraw()
    registration.unregister()
