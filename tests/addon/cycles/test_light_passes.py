# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' light passes.

They are read without loss, switched on without a trace, and the same parts as the reference's.
"""

import bpy
import numpy as np
import pytest
from etalon.addon.cycles import light_passes as light_passes_of_cycles
from etalon.addon.cycles.renderer import CyclesRenderer
from etalon.addon.job import compare_here, export
from etalon.lib.comparison.parts import WhyNot
from etalon.lib.effects.light_passes import light_passes
from etalon.lib.film.light_passes import LightPass
from etalon.lib.film.parts import EmitterLight
from etalon.lib.report.read import read_verdict
from etalon.lib.settings.comparison import Settings
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.reference_scenes import building

PATCH = 3


def shader(kind, **inputs):
    """What makes a node of one kind with these inputs."""

    def make(tree):
        node = tree.nodes.new(kind)
        for name, value in inputs.items():
            node.inputs[name.replace("_", " ")].default_value = value
        return node.outputs[0]

    return make


def both(kind, first, second, share=0.5):
    """Two shaders, mixed or added."""

    def make(tree):
        node = tree.nodes.new(kind)
        sockets = [socket for socket in node.inputs if socket.type == "SHADER"]
        if kind == "ShaderNodeMixShader":
            node.inputs[0].default_value = share
        for socket, of in zip(sockets, (first, second), strict=True):
            tree.links.new(of(tree), socket)
        return node.outputs[0]

    return make


DIFFUSE = shader("ShaderNodeBsdfDiffuse", Color=(0.7, 0.4, 0.2, 1.0))
GLOSSY = shader("ShaderNodeBsdfAnisotropic", Color=(0.3, 0.6, 0.8, 1.0), Roughness=0.5)
TRANSPARENT = shader("ShaderNodeBsdfTransparent", Color=(0.9, 0.8, 0.7, 1.0))
EMISSION = shader("ShaderNodeEmission", Color=(1.0, 0.5, 0.2, 1.0), Strength=1.5)
SURFACES = {
    "diffuse": DIFFUSE,
    "black": shader("ShaderNodeBsdfDiffuse", Color=(0.0, 0.0, 0.0, 1.0)),
    "black gloss": shader("ShaderNodeBsdfAnisotropic", Color=(0.0, 0.0, 0.0, 1.0), Roughness=0.5),
    "glossy": GLOSSY,
    "mirror": shader("ShaderNodeBsdfAnisotropic", Color=(0.0, 0.6, 0.8, 1.0), Roughness=0.0),
    "mix": both("ShaderNodeMixShader", both("ShaderNodeMixShader", DIFFUSE, GLOSSY, 0.3), TRANSPARENT, 0.4),
    "glow": both("ShaderNodeAddShader", EMISSION, DIFFUSE),
    "coat": shader("ShaderNodeBsdfPrincipled", **{"Base_Color": (0.5, 0.3, 0.1, 1.0), "Coat_Weight": 0.8}),
    "plastic": shader("ShaderNodeBsdfPrincipled", Metallic=0.4, Roughness=0.4),
    "glass": shader("ShaderNodeBsdfGlass", Roughness=0.4, IOR=1.4),
    "clear": shader("ShaderNodeBsdfGlass", Roughness=0.0, IOR=1.4),
    "refraction": shader("ShaderNodeBsdfRefraction", Roughness=0.3, IOR=1.3),
    "translucent": shader("ShaderNodeBsdfTranslucent", Color=(0.2, 0.7, 0.3, 1.0)),
    "transmission": shader("ShaderNodeBsdfPrincipled", Transmission_Weight=0.7, Roughness=0.4),
}


def samples_of_surfaces(names):
    """One patch of each surface in a row under two lamps and a sky.

    A diffuse floor lights them from below.
    """
    scene = building.start("passes", PATCH * (len(names) + 1), PATCH, 3)
    building.world((0.3, 0.4, 0.5))
    paper = building.diffuse("Paper", (0.6, 0.5, 0.4))
    building.rectangle("Floor", paper, (0.0, 0.0, -1.0), (30.0, 0.0, 0.0), (0.0, 8.0, 0.0))
    for k, name in enumerate(names):
        material = building.diffuse(name, (1.0, 1.0, 1.0))
        tree = material.node_tree
        output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
        tree.links.new(SURFACES[name](tree), output.inputs["Surface"])
        place = (k - 0.5 * len(names) + 0.5, 0.0, 0.1 * k)
        building.rectangle(name, material, place, (0.98, 0.1, 0.2), (0.0, 0.98, 0.1))
    building.sphere_light("Ball", (1.0, 0.5, 3.0), 0.4, (5.0, 4.0, 3.0))
    building.area_light("Panel", (-2.0, 0.0, 2.5), (0.0, 0.0, 0.0), (1.0, 1.0), (3.0, 5.0, 4.0))
    building.camera((0.0, 0.0, 8.0), (0.0, 0.0, 0.0), ortho_scale=float(len(names) + 1))
    return scene


def read_properties(scene):
    """All that the view layers say of passes, and the image settings."""
    properties = scene.view_layers[0].bl_rna.properties
    names = [one.identifier for one in properties if one.identifier.startswith("use_pass")]
    image = scene.render.image_settings
    return [[getattr(layer, name) for name in names] for layer in scene.view_layers], {
        name: getattr(image, name) for name in ("file_format", "color_mode", "color_depth", "exr_codec")
    }


def test_the_view_layer_gets_its_passes_back():
    """Those of the user's that were off, those that were on, and the format of images."""
    scene = samples_of_surfaces(["diffuse"])
    layer = scene.view_layers[0]
    layer.use_pass_glossy_direct = layer.use_pass_z = True
    layer.use_pass_glossy_color = layer.use_pass_emit = True
    scene.view_layers.new("Second").use_pass_environment = True
    scene.render.image_settings.file_format = "JPEG"
    before = read_properties(scene)
    CyclesRenderer(scene).with_passes((LightPass.DIFFUSE_DIRECT, LightPass.DIFFUSE_INDIRECT)).render(0, 1)
    assert read_properties(scene) == before


def composited(scene):
    """The links of a compositor.

    It shows the layer's glossy direct pass and one of its light groups.
    """
    scene.view_layers[0].use_pass_glossy_direct = True
    scene.view_layers[0].lightgroups.add(name="Warm")
    if bpy.app.version >= (5, 0, 0):
        tree = scene.compositing_node_group = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        output = tree.nodes.new("NodeGroupOutput")
    else:
        scene.use_nodes = True
        tree = scene.node_tree
        tree.nodes.clear()
        output = tree.nodes.new("CompositorNodeComposite")
    layers, viewer = (tree.nodes.new(kind) for kind in ("CompositorNodeRLayers", "CompositorNodeViewer"))
    for names, node in ((("Glossy Direct", "GlossDir"), output), (("Combined_Warm",), viewer)):
        tree.links.new(next(one for one in layers.outputs if one.name in names), node.inputs[0])
    return tree.links


# Blender 5.3 says that its 6.0 will find the compositor's nodes elsewhere.
@pytest.mark.filterwarnings("ignore:'Scene.compositing_node_group':DeprecationWarning")
def test_compositor_nodes_keep_the_passes_and_light_groups_that_they_use(seed):
    """Other passes are rendered meanwhile.

    The nodes change no image, and their links stay valid.
    """
    scene = samples_of_surfaces(["diffuse", "glossy"])
    plain = CyclesRenderer(scene, seed=seed, threads=1).render(0, 2).radiance
    links = composited(scene)
    before = [(link.from_socket.name, link.to_node.name, link.is_valid) for link in links]
    renderer = CyclesRenderer(scene, seed=seed, threads=1)
    found = renderer.with_passes((LightPass.DIFFUSE_DIRECT, EmitterLight("Ball"))).render(0, 2)
    np.testing.assert_allclose(found.radiance, plain, rtol=1e-6)
    assert [(link.from_socket.name, link.to_node.name, link.is_valid) for link in links] == before
    assert all(valid for *_, valid in before)


def test_black_surfaces_leave_numbers(seed):
    """Cycles divides their light by a colour of 0.

    Both sides have passes that are 0 there, and nothing that is no number.
    """
    scene = samples_of_surfaces(["black", "black gloss"])
    passes = LightPass.DIFFUSE_DIRECT, LightPass.GLOSSY_DIRECT, LightPass.GLOSSY_INDIRECT
    reference = ReferenceRenderer(export(scene), Options(seed=seed, threads=1), passes=passes)
    for renderer in (reference, CyclesRenderer(scene, seed=seed, threads=1).with_passes(passes)):
        found = renderer.render(0, 4)
        assert all(np.isfinite(image).all() for image in found.passes.values())
        start = (found.radiance.shape[1] - PATCH * 2) // 2
        middles = found.passes[LightPass.DIFFUSE_DIRECT][PATCH // 2, start + PATCH // 2 :: PATCH][:1]
        assert (middles == 0.0).all()
        assert not found.passes[LightPass.GLOSSY_DIRECT].any()


def test_passes_are_those_of_the_image_and_add_up_to_it(seed):
    """The combined image is the same with passes and without.

    Their sum is that image to float32 rounding.
    """
    scene = samples_of_surfaces(list(SURFACES))
    renderer = CyclesRenderer(scene, seed=seed)
    whole = renderer.with_passes(tuple(LightPass)).render(0, 16)
    plain = renderer.render(0, 16)
    np.testing.assert_allclose(whole.radiance, plain.radiance, rtol=1e-6)
    total = sum(whole.passes.values())
    scale = np.abs(whole.radiance).max()
    np.testing.assert_allclose(total, whole.radiance, rtol=2e-6, atol=1e-6 * scale)


def test_only_passes_that_can_hold_light_are_asked_for():
    """What the plan rules out is black in Cycles too."""
    scene = samples_of_surfaces(["diffuse", "glossy", "clear"])
    exported = export(scene)
    reference = ReferenceRenderer(exported, Options(threads=1))
    asked = set(light_passes(exported, reference.plan))
    passes = CyclesRenderer(scene).with_passes(tuple(LightPass)).render(0, 16).passes
    assert LightPass.EMISSION not in asked
    for name in set(LightPass) - asked:
        assert not passes[name].any(), name


@pytest.mark.compares_with_cycles
@pytest.mark.slow
def test_the_reference_parts_light_as_cycles_does(seed):
    """Every pass of every surface agrees.

    It does within five standard errors and 1 % of the patch's light.
    """
    scene = samples_of_surfaces(list(SURFACES))
    passes = tuple(LightPass)
    reference = ReferenceRenderer(export(scene), Options(seed=seed), passes=passes)
    cycles = CyclesRenderer(scene, seed=seed).with_passes(passes)
    found = compare_patches(reference, cycles, replicates=8, samples=128)
    assert not found, found


def compare_patches(reference, cycles, replicates, samples):
    """The passes and surfaces that differ, with both means."""
    stacks = []
    for side in (reference, cycles):
        images = [side.render(k, samples).passes for k in range(replicates)]
        stacks.append({name: np.array([patches(image[name]) for image in images]) for name in LightPass})
    differ = {}
    whole = sum(stack.mean(axis=0) for stack in stacks[0].values())
    for name in LightPass:
        mine, theirs = (stack[name] for stack in stacks)
        error = np.sqrt((mine.var(axis=0, ddof=1) + theirs.var(axis=0, ddof=1)) / replicates)
        gap = np.abs(mine.mean(axis=0) - theirs.mean(axis=0))
        for k, surface in enumerate(SURFACES):
            if (gap[k] > 5.0 * error[k] + 0.01 * whole[k]).any():
                differ[f"{surface}, {name}"] = mine.mean(axis=0)[k].round(4), theirs.mean(axis=0)[k].round(4)
    return differ


def patches(image):
    """The mean over the pixel in the middle of each patch, (surfaces, 3)."""
    start = (image.shape[1] - PATCH * len(SURFACES)) // 2
    return image[PATCH // 2, start + PATCH // 2 : start + PATCH * len(SURFACES) : PATCH]


@pytest.mark.slow
def test_a_pass_taken_for_another_is_seen(monkeypatch, seed):
    """The error planted: Cycles' glossy direct light read as its diffuse direct light."""
    scene = samples_of_surfaces(list(SURFACES))
    passes = tuple(LightPass)
    reference = ReferenceRenderer(export(scene), Options(seed=seed), passes=passes)
    cycles = CyclesRenderer(scene, seed=seed).with_passes(passes)
    swapped = dict(light_passes_of_cycles._PROPERTIES)
    swapped[LightPass.GLOSSY_DIRECT], swapped[LightPass.DIFFUSE_DIRECT] = (
        swapped[LightPass.DIFFUSE_DIRECT],
        swapped[LightPass.GLOSSY_DIRECT],
    )
    monkeypatch.setattr(light_passes_of_cycles, "_PROPERTIES", swapped)
    assert compare_patches(reference, cycles, replicates=4, samples=16)


@pytest.mark.compares_with_cycles
def test_a_comparison_reports_the_passes_that_were_asked_for(tmp_path):
    """From the option to verdict.json.

    The passes are those of one family, which the scene can have, and the user's settings are restored.
    """
    scene = samples_of_surfaces(["diffuse", "glossy"])
    before = read_properties(scene)
    settings = Settings(time=None, samples=4, replicates=4, passes="glossy", threads=1)
    comparison = compare_here(scene, settings, tmp_path / "out")
    assert comparison.passes.passes == (LightPass.GLOSSY_DIRECT, LightPass.GLOSSY_INDIRECT)
    figures = read_verdict(tmp_path / "out" / "verdict.json")
    assert [one["name"] for one in figures["passes"]] == ["glossy direct", "glossy indirect"]
    assert "Parts of the light" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert read_properties(scene) == before


@pytest.mark.compares_with_cycles
@pytest.mark.parametrize(("partial", "passes", "why"), [(False, "all", None), (True, "none", WhyNot.UNSUPPORTED)])
def test_the_default_refuses_nothing(partial, passes, why):
    """A diffuse room is compared by pass.

    Beside hair, which is not simulated, it is compared as a whole.
    """
    scene = building.start("default", 8, 8, 6)
    paper = building.diffuse("Paper", (0.8, 0.8, 0.8))
    if partial:
        tree = paper.node_tree
        output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
        tree.links.new(shader("ShaderNodeBsdfHair")(tree), output.inputs["Surface"])
    wall = building.diffuse("Wall", (0.8, 0.8, 0.8))
    building.rectangle("Floor", wall, (0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0))
    building.rectangle("Sheet", paper, (1.5, 1.5, 0.1), (0.5, 0.0, 0.0), (0.0, 0.5, 0.0))
    building.rectangle("Back", wall, (0.0, 2.0, 2.0), (4.0, 0.0, 0.0), (0.0, 0.0, 4.0))
    building.area_light("Panel", (0.0, -1.0, 2.0), (0.0, 0.0, 0.0), (1.0, 1.0), (3.0, 3.0, 3.0))
    building.camera((0.0, 0.0, 8.0), (0.0, 0.0, 0.0), ortho_scale=4.0)
    comparison = compare_here(scene, Settings(time=None, samples=1, replicates=2, threads=1, partial=partial))
    assert (comparison.pass_choice.passes, comparison.pass_choice.why_not) == (passes, why)
    assert (comparison.passes is None) == partial
