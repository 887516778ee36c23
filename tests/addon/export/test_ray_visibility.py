# SPDX-License-Identifier: GPL-3.0-or-later
"""Ray visibility of objects, lights and worlds, and lights' switches, against Cycles.

It is one scene, with one thing hidden at a time.
"""

import bpy
import numpy as np
import pytest
from etalon.addon.cycles.renderer import CyclesRenderer
from etalon.lib.errors import Refused
from etalon.lib.scene.rays import CAMERA, DIFFUSE, EVERY, GLOSSY, SEEN, TRANSMISSION
from etalon.tests.addon.export.test_visibility import (
    FEW_SAMPLES,
    SAMPLES,
    apart,
    blocks,
    off,
    reference_of,
    shader,
    square,
)
from mathutils import Euler, Matrix


def stage(studio):
    """A grey floor and a rough mirror wall, with things over the floor.

    They are a red card, a glowing panel, a pane of glass, a small lamp, and a sky.
    """
    upright = Euler((np.pi / 2, 0, 0)).to_matrix().to_4x4()
    grey = shader("grey", "BsdfDiffuse", Color=(0.6, 0.6, 0.6, 1))
    red = shader("red", "BsdfDiffuse", Color=(0.9, 0.1, 0.1, 1))
    wall, pane = shader("wall", "BsdfGlossy", Roughness=0.3), shader("pane", "BsdfGlass", Roughness=0.0)
    square(studio, "floor", grey, 4.0)
    square(studio, "wall", wall, 3.0, Matrix.Translation((0, 3, 3)), upright)
    square(studio, "card", red, 0.8, Matrix.Translation((-1.2, 0, 1.0)))
    square(studio, "panel", shader("glow", "Emission", Strength=4.0), 0.6, Matrix.Translation((1.5, 1.0, 2.0)))
    square(studio, "pane", pane, 1.2, Matrix.Translation((-0.8, -2.5, 1.4)), upright)
    lamp = studio.add("lamp", bpy.data.lights.new("lamp", "POINT"), Matrix.Translation((-1.5, 0.3, 2.5)))
    lamp.data.energy, lamp.data.shadow_soft_size = 150.0, 0.1
    studio.camera.location, studio.camera.rotation_euler = (0.0, -9.0, 4.0), (1.2, 0.0, 0.0)
    studio.scene.render.resolution_x, studio.scene.render.resolution_y = 48, 32
    world = bpy.data.worlds.new("sky")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.3, 0.3, 0.3, 1.0)
    studio.scene.world = world
    studio.scene.render.engine, studio.scene.cycles.max_bounces = "CYCLES", 2
    return bpy.data.objects["card"], bpy.data.objects["panel"], lamp, world.cycles_visibility


def hide(number, name):
    return lambda things: setattr(things[number], name, False)


def dim(things):
    """Light that reaches the lamp's own bounces only, where others go on."""
    things[2].data.cycles.max_bounces = 0


def darken(things):
    """A card that is half transparent, but not to shadow rays."""
    things[0].data.materials[0].use_transparent_shadow = False


def flagged(name, blend, of="red"):
    """The card's material, or another, mixed by a flag of the ray with another shader."""

    def change(_):
        tree = bpy.data.materials[of].node_tree
        out, path = tree.nodes["Material Output"], tree.nodes.new("ShaderNodeLightPath")
        mix, other = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new(f"ShaderNode{blend}")
        tree.links.new(path.outputs[f"Is {name} Ray"], mix.inputs[0])
        tree.links.new(out.inputs["Surface"].links[0].from_socket, mix.inputs[1])
        tree.links.new(other.outputs[0], mix.inputs[2])
        tree.links.new(mix.outputs[0], out.inputs["Surface"])

    return change


def sky_by(name):
    """The world's strength by a flag of the ray."""

    def change(_):
        tree = bpy.data.worlds["sky"].node_tree
        path = tree.nodes.new("ShaderNodeLightPath")
        tree.links.new(path.outputs[f"Is {name} Ray"], tree.nodes["Background"].inputs["Strength"])

    return change


FLAGS = ("Camera", "Diffuse", "Glossy", "Singular", "Reflection", "Transmission")
CASES = {
    **{
        f"a card that is clear to {name.lower()} rays": flagged(name, "BsdfTransparent")
        for name in ("Shadow", "Glossy")
    },
    "a wall that glows to the camera beside a card": flagged("Camera", "Emission", "wall"),
    "a card that is translucent to diffuse rays": flagged("Diffuse", "BsdfTranslucent"),
    **{f"a world for {name.lower()} rays": sky_by(name) for name in FLAGS},
    "a half transparent card with an opaque shadow": darken,
    "a card hidden from diffuse rays": hide(0, "visible_diffuse"),
    "a card hidden from glossy rays": hide(0, "visible_glossy"),
    "a card hidden from transmission rays": hide(0, "visible_transmission"),
    "a wall that is a holdout": lambda _: setattr(bpy.data.objects["wall"], "is_holdout", True),
    "a card without shadow": hide(0, "visible_shadow"),
    "a lamp hidden from glossy rays": hide(2, "visible_glossy"),
    "a lamp hidden from diffuse rays": hide(2, "visible_diffuse"),
    "a world hidden from the camera": hide(3, "camera"),
    "a world hidden from diffuse rays": hide(3, "diffuse"),
    "a world hidden from glossy rays": hide(3, "glossy"),
    "a world hidden from transmission rays": hide(3, "transmission"),
    "a lamp without shadows": lambda things: setattr(things[2].data, "use_shadow", False),
    "a lamp of few bounces": dim,
}


@pytest.fixture(scope="module")
def unaware():
    """What the reference shows of the stage before anything is hidden, by what stands there: cases share it."""
    return {}


# Of the default run.
QUICK = ("a card hidden from glossy rays",)
# What little light the card loses or gives there takes more samples to see.
FAINT = ("a card hidden from diffuse rays", "a card hidden from glossy rays")


@pytest.mark.compares_with_cycles
@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=() if case in QUICK else pytest.mark.slow) for case in CASES]
)
def test_what_is_hidden_from_some_rays_is_hidden_as_in_cycles(studio, case, unaware):
    """And the comparison notices a reference that knows nothing of it."""
    things, samples = stage(studio), SAMPLES if case in FAINT else FEW_SAMPLES
    is_broad, is_clear = not ("card" in case or "lamp" in case), "transparent" in case
    if not is_broad:  # the broad panel would make Cycles' image depend on how it is sampled
        bpy.data.objects.remove(things[1])
    if is_clear:
        things[0].data.materials[0] = shader("half", "BsdfTransparent", Color=(0.5, 0.6, 0.7, 1))
    shared = is_broad, is_clear, samples
    if shared not in unaware:
        unaware[shared] = reference_of(studio.export(), samples)
    CASES[case](things)
    theirs = blocks(CyclesRenderer(studio.scene, threads=1), samples)
    assert off(reference_of(studio.export(), samples), theirs) < 1.5
    assert off(unaware[shared], theirs) > 1.9


def test_masks_are_read(studio):
    card, panel, lamp, world = stage(studio)
    card.visible_glossy = card.visible_camera = panel.visible_transmission = lamp.visible_diffuse = False
    world.camera = world.scatter = False
    lamp.data.use_shadow, lamp.data.cycles.max_bounces = False, 3
    read = studio.export()
    rays = {thing.name: thing.rays for thing in read.mesh.objects}
    assert rays["card"] == EVERY & ~(GLOSSY | CAMERA)
    assert rays["panel"] == EVERY & ~TRANSMISSION
    assert rays["floor"] == EVERY
    (light,) = read.lights
    assert (light.rays, light.casts_shadow, light.max_bounces) == (SEEN & ~(CAMERA | DIFFUSE), False, 3)
    assert read.world.rays == SEEN & ~CAMERA


def test_an_instance_hides_as_its_instancer_does(studio):
    inner = bpy.data.collections.new("inner")
    inner.objects.link(bpy.data.objects.new("thing", studio.quad().data))
    empty = studio.add("empty", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", inner
    empty.visible_glossy = False
    assert {thing.name: thing.rays for thing in studio.export().mesh.objects}["thing"] == EVERY & ~GLOSSY


@pytest.mark.compares_with_cycles
def test_an_environment_left_out_of_the_view_layer_is_black(studio):
    _, _, lamp, _ = stage(studio)
    bpy.data.objects.remove(lamp)
    studio.layer.use_sky = False
    exported = studio.export()
    assert apart(studio, exported)[0] < 1.5
    assert not np.any(exported.world.radiance.value)


@pytest.mark.slow
@pytest.mark.compares_with_cycles
def test_a_portal_gives_no_light_and_leaves_the_mean_of_the_world(studio):
    """The comparison notices a reference for which it is a light."""
    _, panel, lamp, _ = stage(studio)
    bpy.data.objects.remove(panel)
    bpy.data.objects.remove(lamp)
    opening = studio.add("opening", bpy.data.lights.new("opening", "AREA"), Matrix.Translation((0.5, 0.3, 2.5)))
    opening.data.energy, opening.data.size = 60.0, 1.5
    unaware = studio.export()
    opening.data.cycles.is_portal = True
    exported = studio.export()
    assert exported.lights == ()
    (finding,) = exported.findings
    assert finding.what == "1 area light is a portal: 'opening'."
    aware, blind = apart(studio, exported, unaware)
    assert aware < 1.5
    assert blind > 1.9


def test_emission_by_the_kind_of_ray_is_refused(studio):
    things = stage(studio)
    flagged("Glossy", "Emission")(things)
    with pytest.raises(Refused, match="'Is Glossy Ray' of a Light Path node in its emission is not simulated"):
        studio.export()
