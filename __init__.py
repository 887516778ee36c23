# SPDX-License-Identifier: GPL-3.0-or-later
"""Étalon: a reference integrator beside Cycles, and the verdict on where the two agree.

`lib` computes light and never imports bpy; `addon` talks to Blender and computes no light.
This file is Blender's way in and, at the same time, the root of the pip package: it imports
nothing at module level, so that `import etalon` works where there is no Blender.
"""

__version__ = "0.1.0"


def register() -> None:
    """Register the extension with Blender."""
    from .addon import registration

    registration.register()


def unregister() -> None:
    """Take the extension out of Blender again."""
    from .addon import registration

    registration.unregister()
