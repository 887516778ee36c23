# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadow catchers against Cycles: what they show is set aside, all else is compared."""

import bpy
import numpy as np
import pytest
from etalon.addon.command.assignments import assign
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.job import compare_here
from etalon.lib.effects.light_passes import light_passes
from etalon.lib.effects.plan import make_plan
from etalon.lib.errors import Refused
from etalon.lib.film.light_passes import LightPass
from etalon.lib.film.parts import WORLD, EmitterLight
from etalon.lib.report.document import document
from etalon.lib.report.summary import summarize
from etalon.lib.report.words import sentences
from etalon.lib.settings.comparison import Settings
from etalon.lib.settings.reference import Options
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.addon.export.test_ray_visibility import stage
from etalon.tests.addon.export.test_visibility import FEW_SAMPLES, REPLICATES, SAMPLES, shader, square
from mathutils import Euler, Matrix

UPRIGHT = Euler((np.pi / 2, 0, 0)).to_matrix().to_4x4()


def objects(*names):
    return [bpy.data.objects[name] for name in names]


def catch(*names):
    for thing in objects(*names):
        thing.is_shadow_catcher = True


def glow():
    """A floor that shines by itself as well as by what it reflects."""
    tree = bpy.data.materials["grey"].node_tree
    out, add = tree.nodes["Material Output"], tree.nodes.new("ShaderNodeAddShader")
    shine = tree.nodes.new("ShaderNodeEmission")
    shine.inputs["Strength"].default_value = 0.5
    tree.links.new(out.inputs["Surface"].links[0].from_socket, add.inputs[0])
    tree.links.new(shine.outputs[0], add.inputs[1])
    tree.links.new(add.outputs[0], out.inputs["Surface"])


def veil(studio, distance, catches):
    clear = shader("veil", "BsdfTransparent", Color=(0.5, 0.7, 0.9, 1))
    square(studio, "veil", clear, 1.5, Matrix.Translation((0.5, distance, 1.5)), UPRIGHT).is_shadow_catcher = catches


def plain(studio):
    catch("floor")


def several(studio):
    catch("floor", "wall")


def shining(studio):
    glow()
    catch("floor")


def behind_a_veil(studio):
    veil(studio, -4.0, False)
    catch("floor")


def clear_catcher(studio):
    veil(studio, -4.0, True)


def held_out(studio):
    catch("floor")
    bpy.data.objects["floor"].is_holdout = True


def behind_glass_and_in_a_mirror(studio):
    """The pane hides the card from the camera, and the wall shows it: no camera ray meets it first."""
    catch("card")


def hidden_from_the_camera(studio):
    catch("floor")
    bpy.data.objects["floor"].visible_camera = False


def behind_a_lamp(studio):
    lamp = studio.add("disk", bpy.data.lights.new("disk", "AREA"), Matrix.Translation((1.5, -2.0, 2.0)) @ UPRIGHT)
    lamp.data.energy, lamp.data.size, lamp.visible_camera = 40.0, 1.0, True
    catch("floor")


def by_an_instancer(studio):
    inner = bpy.data.collections.new("inner")
    inner.objects.link(bpy.data.objects.new("thing", bpy.data.objects["card"].data))
    empty = studio.add("empty", None, Matrix.Translation((1.0, -2.0, 1.2)))
    empty.instance_type, empty.instance_collection, empty.is_shadow_catcher = "COLLECTION", inner, True


CASES = {
    case.__name__: case
    for case in (
        plain,
        several,
        shining,
        behind_a_veil,
        clear_catcher,
        held_out,
        behind_glass_and_in_a_mirror,
        hidden_from_the_camera,
        behind_a_lamp,
        by_an_instancer,
    )
}


def blocks(side, samples=SAMPLES):
    """Means (replicates, blocks, 3) of blocks of pixels."""
    return means(np.array([side.render(k, samples).radiance for k in range(REPLICATES)]))


def means(images, size=8):
    """Means (replicates, blocks, 3) of blocks of size x size pixels of images (replicates, height, width, 3)."""
    count, height, width, _ = images.shape
    return images.reshape(count, height // size, size, width // size, size, 3).mean(axis=(2, 4)).reshape(count, -1, 3)


def distance(ours, theirs):
    """The root mean square of the differences in standard errors, over blocks that are not black in both."""
    error = np.sqrt((ours.var(axis=0, ddof=1) + theirs.var(axis=0, ddof=1)) / REPLICATES)
    scale = error + 1e-3 * theirs.mean(axis=0)
    off = ours.mean(axis=0) - theirs.mean(axis=0)
    assert not off[scale == 0.0].any()
    lit = scale > 0.0
    return np.sqrt(((off[lit] / scale[lit]) ** 2).mean()) if lit.any() else 0.0


# Of the default run.
QUICK = ("plain",)


@pytest.mark.compares_with_cycles
@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=() if case in QUICK else pytest.mark.slow) for case in CASES]
)
def test_what_is_beside_catchers_is_as_in_cycles(studio, case):
    """And the comparison notices a reference that takes them for ordinary objects."""
    things = stage(studio)
    bpy.data.objects.remove(things[1])
    unaware = studio.export()
    CASES[case](studio)
    theirs = blocks(CyclesRenderer(studio.scene, threads=1), FEW_SAMPLES)
    aware = blocks(ReferenceRenderer(studio.export(), Options(threads=1)), FEW_SAMPLES)
    if "glass" in case:  # here the mistake is to leave out more than Cycles does
        (card,) = objects("card")
        card.is_shadow_catcher, card.hide_render = False, True
        unaware = studio.export()
    blind = blocks(ReferenceRenderer(unaware, Options(threads=1)), FEW_SAMPLES)
    assert distance(aware, theirs) < 1.5
    assert distance(blind, theirs) > 5.0


@pytest.mark.slow
@pytest.mark.compares_with_cycles
def test_fog_before_a_catcher_is_seen_as_in_cycles(studio):
    """And the comparison notices fog that is a fifth darker."""
    things = stage(studio)
    for thing in things[:2]:
        bpy.data.objects.remove(thing)
    tree = bpy.data.worlds["sky"].node_tree
    node = tree.nodes.new("ShaderNodeVolumeScatter")
    node.inputs["Color"].default_value, node.inputs["Density"].default_value = (0.9, 0.6, 0.3, 1.0), 0.1
    tree.links.new(node.outputs[0], tree.nodes["World Output"].inputs["Volume"])
    studio.scene.cycles.volume_bounces = 1
    catch("floor", "wall", "pane")
    theirs = blocks(CyclesRenderer(studio.scene, threads=1))
    ours = blocks(ReferenceRenderer(studio.export(), Options(threads=1)))
    assert distance(ours, theirs) < 1.5
    assert distance(0.8 * ours, theirs) > 3.0


@pytest.mark.slow
@pytest.mark.compares_with_cycles
@pytest.mark.parametrize("case", [plain, shining, clear_catcher])
def test_passes_beside_catchers_are_as_in_cycles(studio, case):
    """Light passes and emitters; in the environment pass Cycles shows the sky behind the catchers."""
    things = stage(studio)
    bpy.data.objects.remove(things[1])
    case(studio)
    exported = studio.export()
    asked = light_passes(exported, make_plan(exported))
    parts = (*asked, WORLD, EmitterLight("lamp"), LightPass.ENVIRONMENT)
    theirs = parts_of(CyclesRenderer(studio.scene, threads=1).with_passes(parts), parts)
    ours = parts_of(ReferenceRenderer(exported, Options(threads=1)).with_passes(parts), parts)
    assert len(asked) > 3
    for part in parts[:-1]:
        # the noise of a single pass has heavier tails than that of the whole image
        assert distance(ours[part], theirs[part]) < 2.0, part
    assert distance(ours[LightPass.ENVIRONMENT], theirs[LightPass.ENVIRONMENT]) > 50.0
    if case is shining:
        assert LightPass.EMISSION not in asked


def parts_of(side, parts):
    """By part: means (replicates, blocks, 3) of blocks of pixels."""
    images = [side.render(k, SAMPLES).passes for k in range(REPLICATES)]
    return {part: means(np.array([image[part] for image in images])) for part in parts}


def test_catchers_are_read(studio):
    """Of an object or its instancer; a holdout is no catcher, as in Cycles."""
    stage(studio)
    by_an_instancer(studio)
    catch("floor", "wall")
    bpy.data.objects["wall"].is_holdout = True
    caught = {thing.name for thing in studio.export().mesh.objects if thing.catches_shadows}
    assert caught == {"floor", "thing"}
    assign('objects["floor"].is_shadow_catcher=false')
    assert {thing.name for thing in studio.export().mesh.objects if thing.catches_shadows} == {"thing"}


def test_what_catchers_show_is_set_aside_and_said(studio):
    stage(studio)
    assert "shadow catchers" not in {one.check for one in studio.export().findings}
    catch("floor", "wall")
    (said,) = (str(one) for one in studio.export().findings if one.check == "shadow catchers")
    assert "2 objects are shadow catchers: 'floor' and 'wall'. Shown pixels of shadow catchers are set aside" in said
    layer = studio.layer.cycles
    with neutral(studio.scene) as changes:
        assert layer.use_pass_shadow_catcher
        assert changes.settings["view_layer.cycles.use_pass_shadow_catcher"]
    assert not layer.use_pass_shadow_catcher


def test_the_pass_of_catchers_is_held_in_an_animated_scene(studio):
    studio.quad("floor").is_shadow_catcher = True
    path = 'view_layers["ViewLayer"].cycles.use_pass_shadow_catcher'
    studio.scene.keyframe_insert(path, frame=1)
    layer = studio.layer.cycles
    with neutral(studio.scene):
        studio.scene.frame_set(1)
        assert layer.use_pass_shadow_catcher
    studio.scene.frame_set(1)
    assert not layer.use_pass_shadow_catcher


def test_a_scene_whose_lights_alone_have_the_flag_has_no_catcher(studio):
    """Blender sets it on new lights."""
    studio.quad("floor")
    assert studio.add("lamp", bpy.data.lights.new("lamp", "POINT")).is_shadow_catcher
    with neutral(studio.scene) as changes:
        assert "view_layer.cycles.use_pass_shadow_catcher" not in changes.settings
    assert not any(thing.catches_shadows for thing in studio.export().mesh.objects)


@pytest.mark.compares_with_cycles
def test_a_comparison_says_which_part_of_the_image_catchers_fill(studio):
    things = stage(studio)
    bpy.data.objects.remove(things[1])
    catch("floor")
    found = compare_here(studio.scene, Settings(samples=32, replicates=3, threads=1))
    assert found.verdict.outcome is not Outcome.DIFFERENT
    assert found.caught.names == ("floor",)
    assert 0.1 < found.left_out.mean() < 0.6
    assert np.array_equal(found.left_out, found.caught.pixels)
    share = f"{100 * found.left_out.mean():.3g} %"
    line = f"{share} of the image shows the shadow catcher 'floor': shown pixels of shadow catchers are set aside."
    assert line in sentences(found)
    assert line in summarize(found)[1]
    assert not any("unsupported" in said for said in (*sentences(found), *summarize(found)))
    figures = document(found, make_plan(studio.export()), "")["left_out"]
    expected = {"pixels": int(found.left_out.sum()), "objects": ["floor"]}
    assert figures == {"pixels": expected["pixels"], "materials": [], "shadow_catchers": expected}
    assert "floor" not in found.regions.names


def test_an_image_of_a_catcher_alone_is_refused(studio):
    studio.quad("floor", 9.0).is_shadow_catcher = True
    studio.look_down(0.5)
    with pytest.raises(
        Refused, match="'floor': an image that shows little but shadow catchers is not simulated; switch"
    ):
        compare_here(studio.scene, Settings(samples=4, replicates=2, threads=1))
