# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that the camera does not see as they are: holdouts and shadow catchers.

The camera sees black in place of a holdout, and what a shadow catcher shows is not compared. All other light goes on as
if they were ordinary objects.
"""

from __future__ import annotations

from dataclasses import replace

import bpy

from ...lib.scene import expressions as ex
from ...lib.scene.materials import Material, Transparent

_TO_OTHER_RAYS = ex.Math("SUBTRACT", ex.ONE, ex.RayFlag("CAMERA"), ex.ZERO)


def is_holdout(instance: bpy.types.DepsgraphObjectInstance, layer: bpy.types.ViewLayer) -> bool:
    """Whether the object is a holdout.

    It is where it, or a collection of the view layer that has it or its instancer, is one.
    """
    return instance.object.is_holdout or (instance.parent or instance.object).holdout_get(view_layer=layer)


def is_catcher(instance: bpy.types.DepsgraphObjectInstance, layer: bpy.types.ViewLayer) -> bool:
    """Whether the object is a shadow catcher.

    It is where it or its instancer is one, unless it is a holdout, too.
    """
    both = (instance.object, instance.parent or instance.object)
    return any(one.is_shadow_catcher for one in both) and not is_holdout(instance, layer)


def hold_out(material: Material) -> Material:
    """The material on a holdout, which camera rays do not meet.

    They meet only what lets them straight through. Cycles drops all other closures for such rays
    (`surface_shader_apply_holdout`). The film is opaque, so that black stays in their place.
    """
    lobes = tuple(
        lobe
        if isinstance(lobe.closure, Transparent)
        else replace(lobe, weight=ex.Math("MULTIPLY", lobe.weight, _TO_OTHER_RAYS, ex.ZERO))
        for lobe in material.lobes
    )
    return replace(material, name=f"{material.name} (holdout)", lobes=lobes)
