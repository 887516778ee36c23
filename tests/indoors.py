# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes of effect_cases.py put indoors, so that they need many effects."""

from dataclasses import replace

import numpy as np
from etalon.lib.effects.plan import make_plan
from etalon.lib.scene.scene import Transport
from etalon.tests.effect_parts import AROUND
from etalon.tests.scenes import floor


def indoors(the_scene):
    """The scene with a floor of its first material beneath, and two bounces.

    It has a light if it had none, so that it needs many effects.
    """
    mesh, below = the_scene.mesh, floor(2.0, -1.5)
    more = below.triangles.shape[1]

    def longer(table, value=0.0):
        return np.concatenate([table, np.full((*table.shape[:-1], more), value, table.dtype)], axis=-1)

    normals = mesh.corner_normals
    if normals.shape[2]:
        normals = longer(normals)
    vertices = np.concatenate([mesh.vertices, below.vertices], axis=1)
    mesh = replace(
        mesh,
        vertices=vertices,
        triangles=np.concatenate([mesh.triangles, below.triangles + mesh.vertices.shape[1]], axis=1).astype(np.int32),
        material_index=longer(mesh.material_index, 0),
        object_index=longer(mesh.object_index, 0),
        smooth=longer(mesh.smooth, False),
        corner_normals=normals,
        uvs={k: longer(v, 0.25) for k, v in mesh.uvs.items()},
        attributes={k: longer(v, 1.0) for k, v in mesh.attributes.items()},
        generated=vertices.astype(np.float32) if mesh.generated.size else mesh.generated,
    )
    return replace(lit(the_scene), mesh=mesh, transport=Transport(2))


def lit(the_scene):
    """The scene with a light if it has none."""
    plan = make_plan(the_scene)
    shining = ("light sampling", "constant world", "environment world", "emission")
    shines = bool(the_scene.lights) or any(plan.needs(effect) for effect in shining)
    return the_scene if shines else replace(the_scene, world=AROUND)
