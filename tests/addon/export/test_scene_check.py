# SPDX-License-Identifier: GPL-3.0-or-later
"""The facts that the export gives the scene check.

Also what Cycles shows where faces overlap in one plane.
"""

import bpy
import numpy as np
import pytest
from etalon.lib.scene_check.check import check_scene
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from mathutils import Euler

HIDING = frozenset({"faces in one plane"})


def findings(studio):
    return {finding.check: finding.what for finding in check_scene(studio.export())}


@pytest.fixture
def lit(studio):
    """A diffuse material for all, and a sun that stands upright."""
    if bpy.app.version < (5, 0, 0):
        studio.plain.use_nodes = True
    tree = studio.plain.node_tree
    tree.nodes.clear()
    diffuse, out = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(diffuse.outputs[0], out.inputs["Surface"])
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy, sun.angle = np.pi, 0.0
    studio.add("sun", sun)
    studio.look_down(2.0)
    return studio


def reference(studio, departures=frozenset()):
    return ReferenceRenderer(studio.export(), Options(departures=departures)).render(0, 4).radiance


@pytest.mark.compares_with_cycles
def test_where_a_rug_lies_in_the_floors_plane_cycles_is_black_as_the_departure_says(lit):
    lit.quad("floor", 1.5)
    lit.quad("rug", 0.5)
    lit.camera.location.x += 0.013  # off the diagonals, on which rays meet either triangle
    shown = lit.cycles(4)
    middle = (slice(9, 23), slice(9, 23))
    departed = reference(lit, HIDING)
    assert reference(lit) == pytest.approx(np.full((32, 32, 3), 0.8), rel=1e-6)
    assert departed[middle].max() == 0.0
    assert shown[middle].mean() < 0.01
    shown[7:25, 7:25] = departed[7:25, 7:25] = 0.0
    assert shown == pytest.approx(departed, rel=1e-5)


@pytest.mark.compares_with_cycles
@pytest.mark.parametrize("lean", [(0.3, 0.03, 0.06), (0.5, 0.2, 0.1)])
def test_in_a_tilted_plane_cycles_lies_between_none_and_all_of_the_departure(lit, lean):
    """Rounding decides which rays meet the other face."""
    for name in ("sheet", "copy"):
        lit.quad(name, 3.0).matrix_world = Euler(lean).to_matrix().to_4x4()
    plain, departed, shown = reference(lit).mean(), reference(lit, HIDING).mean(), lit.cycles(16).mean()
    assert departed == 0.0
    assert 0.1 * plain < shown < 0.9 * plain


def boxes(studio, lean, copies):
    """A box with sides of 2 m, turned, `copies` times in one mesh. Its vertices are where Cycles has them, rounded once."""
    corners = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float)
    corners = (corners @ np.array(Euler(lean).to_matrix()).T).astype(np.float32)
    sides = np.array([(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
    faces = np.concatenate([sides + 8 * k for k in range(copies)])
    return studio.add("box", studio.mesh("box", np.tile(corners, (copies, 1)), faces))


@pytest.mark.compares_with_cycles
@pytest.mark.skipif(bpy.app.version < (5, 2, 0), reason="before Blender 5.2 Cycles rounds otherwise")
@pytest.mark.parametrize("lean", [(0.5, 0.2, 0.1), (0.3, 0.03, 0.06), (0.7, -0.4, 0.2)])
def test_a_tilted_box_that_is_there_twice_shows_what_rounding_says(lit, lean):
    """Light that is hidden on one side comes out on others, after it went through the box."""
    boxes(lit, lean, 2)
    bpy.data.objects["sun"].rotation_euler = (0.9, 0.0, 0.4)
    lit.look_down(4.0)
    cycles = lit.scene.cycles
    cycles.max_bounces = cycles.diffuse_bounces = 12
    shown = lit.cycles(256).reshape(4, 8, 4, 8, 3).mean(axis=(1, 3))
    gap = []
    for names in (frozenset(), HIDING, frozenset({"rounding in one plane"})):
        pixels = ReferenceRenderer(lit.export(), Options(departures=names)).render(0, 256).radiance
        gap.append(np.abs(pixels.reshape(4, 8, 4, 8, 3).mean(axis=(1, 3)) - shown).max() / shown.max())
    assert gap[2] < 0.15
    assert min(gap[:2]) > 0.9


@pytest.mark.compares_with_cycles
@pytest.mark.parametrize("lean", [(0.0, 0.0, 0.0), (0.5, 0.2, 0.1)])
def test_under_lights_in_one_plane_cycles_lies_between_none_and_all_of_the_departure(lit, lean):
    """How Cycles weighs light samples decides how much is lost, and in a tilted plane rounding, too."""
    bpy.data.objects.remove(bpy.data.objects["sun"])
    lit.quad("floor", 8.0)
    panel = bpy.data.lights.new("panel", "AREA")
    panel.size, panel.energy = 4.0, 200.0
    for name in ("first", "second"):
        placed = lit.add(name, panel)
        placed.location.z, placed.rotation_euler = 2.0, lean
    names = frozenset({"lights in one plane"})
    plain, departed, shown = reference(lit).mean(), reference(lit, names).mean(), lit.cycles(16).mean()
    assert departed == pytest.approx(0.5 * plain, rel=0.02)
    assert 1.05 * departed < shown < 0.98 * plain
    assert (
        findings(lit)["overlapping lights"]
        == "Area lights share a plane and an area of it: 'first' and 'second' (16 m²)."
    )


def test_settings_that_are_set_aside_are_named(studio):
    smooth, flat = studio.quad("smooth"), studio.quad("flat", z=1.0)
    smooth.data.shade_smooth()
    studio.add("Bulb", bpy.data.lights.new("Bulb", "POINT")).data.shadow_soft_size = 0.1
    studio.add("Pin", bpy.data.lights.new("Pin", "POINT")).data.shadow_soft_size = 0.0
    found = findings(studio)
    assert "1 smooth object is off on both sides: 'smooth'." in found["shadow terminator offset"]
    assert found["soft falloff"] == "Soft falloff of 1 light is off on both sides: 'Bulb'."
    for thing in (smooth, flat):
        for owner in (thing, thing.cycles):
            for name in ("shadow_terminator_geometry_offset", "shadow_terminator_offset"):
                if hasattr(owner, name):
                    setattr(owner, name, 0.0)
    bpy.data.lights["Bulb"].use_soft_falloff = False
    assert findings(studio) == {}


def test_a_mirrored_object_is_named(studio):
    studio.quad("shoe").scale.x = -1.0
    assert findings(studio) == {"negative scale": "1 object is mirrored by a negative scale: 'shoe'."}
