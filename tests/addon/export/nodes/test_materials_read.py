# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials as lobes: how trees flatten, which output counts, and what sockets become."""

import re

import bpy
import numpy as np
import pytest
from etalon.addon.export.materials import read_material
from etalon.addon.export.nodes.images import ImageTable
from etalon.lib.scene import expressions as ex
from etalon.lib.scene import materials as mt
from etalon.lib.scene.rays import COUNTS
from etalon.lib.textures.evaluate import evaluate
from etalon.lib.textures.images import ImageSet
from etalon.lib.textures.requirements import requirements
from etalon.tests.addon.export.nodes.node_cells import Points, glowing, node
from etalon.tests.addon.export.nodes.reading import bumped, lobes, principled, refused, textured


@pytest.fixture(scope="module", autouse=True)
def _empty_file():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


def constant(value):
    return (
        ex.Constant(pytest.approx(value))
        if isinstance(value, float)
        else ex.Constant(tuple(pytest.approx(v) for v in value))
    )


def test_glossy_sockets_and_defaults():
    (lobe,) = lobes(lambda t: node(t, "BsdfGlossy", {"Color": (0.8, 0.5, 0.2, 1), "Roughness": 0.3}))
    assert lobe.weight == ex.ONE
    assert lobe.closure.distribution == "MULTI_GGX"
    assert lobe.closure.color == constant((0.8, 0.5, 0.2))
    assert lobe.closure.roughness == constant(0.3)
    assert lobe.closure.anisotropy == ex.ZERO


@pytest.mark.parametrize("distribution", ["BECKMANN", "GGX", "MULTI_GGX"])
def test_glossy_distributions(distribution):
    (lobe,) = lobes(lambda t: node(t, "BsdfGlossy", distribution=distribution))
    assert lobe.closure.distribution == distribution


@pytest.mark.parametrize(
    ("settings", "tangent"),
    [
        (None, mt.Tangent("RADIAL", "Z")),
        ({"direction_type": "RADIAL", "axis": "X"}, mt.Tangent("RADIAL", "X")),
        ({"direction_type": "UV_MAP", "uv_map": "Brushed"}, mt.Tangent("UV", uv_map="Brushed")),
    ],
)
def test_anisotropy_brings_its_tangent(settings, tangent):
    def build(tree):
        inputs = {"Anisotropy": 0.4, "Rotation": 0.25}
        if settings:
            inputs["Tangent"] = node(tree, "Tangent", **settings)
        return node(tree, "BsdfGlossy", inputs)

    (lobe,) = lobes(build)
    assert (lobe.closure.anisotropy, lobe.closure.rotation) == (constant(0.4), constant(0.25))
    assert lobe.closure.tangent == tangent
    needs = requirements([mt.Material("Gold", (lobe,))])
    assert needs.generated == (tangent.kind == "RADIAL")
    assert needs.uv_maps == ({"Brushed"} if tangent.kind == "UV" else set())


def test_isotropic_lobes_ask_nothing_of_the_geometry():
    (lobe,) = lobes(lambda t: node(t, "BsdfGlossy", {"Tangent": node(t, "NewGeometry", output="Incoming")}))
    assert requirements([mt.Material("Gold", (lobe,))]).generated is False


def test_a_tree_of_mixes_becomes_weights():
    def build(tree):
        inner = node(
            tree, "MixShader", {"Fac": 0.25, "Shader": node(tree, "BsdfDiffuse"), "Shader_001": node(tree, "Emission")}
        )
        outer = node(tree, "MixShader", {"Fac": 0.4, "Shader": inner, "Shader_001": node(tree, "BsdfTransparent")})
        return node(tree, "AddShader", {"Shader": outer, "Shader_001": node(tree, "BsdfGlossy")})

    found = {type(lobe.closure): lobe.weight for lobe in lobes(build)}
    assert found == {
        mt.Diffuse: constant(0.45),
        mt.Emission: constant(0.15),
        mt.Transparent: constant(0.4),
        mt.Glossy: ex.ONE,
    }


@pytest.mark.parametrize(
    ("factor", "kept"), [(0.0, mt.Diffuse), (-3.0, mt.Diffuse), (1.0, mt.Emission), (7.0, mt.Emission)]
)
def test_a_branch_without_weight_is_not_read(factor, kept):
    """Not even when it holds what is not simulated: Cycles drops it too."""

    def build(tree):
        shaders = {mt.Diffuse: node(tree, "BsdfDiffuse"), mt.Emission: node(tree, "Emission")}
        both = [shaders[kept] if which is kept else node(tree, "BsdfPrincipled") for which in shaders]
        return node(tree, "MixShader", {"Fac": factor, "Shader": both[0], "Shader_001": both[1]})

    assert [type(lobe.closure) for lobe in lobes(build)] == [kept]


@pytest.mark.parametrize("kind", ["Glass", "Refraction"])
def test_smooth_interfaces(kind):
    (lobe,) = lobes(lambda t: node(t, "Bsdf" + kind, {"Roughness": 0.003, "IOR": 1.25}))
    assert type(lobe.closure).__name__ == kind
    assert lobe.closure.ior == ex.Constant(1.25)


def test_shared_nodes_stay_shared():
    """One image feeding two sockets is one expression, so that it is sampled once."""

    def build(tree):
        image = bpy.data.images.new("shared", 2, 2)
        texture = node(tree, "TexImage", image=image)
        return node(tree, "BsdfGlossy", {"Color": texture, "Roughness": texture})

    (lobe,) = lobes(build)
    assert lobe.closure.roughness.color is lobe.closure.color
    assert requirements([mt.Material("", (lobe,))]).uv_maps == {""}


def test_an_empty_tree_is_black_and_no_tree_is_diffuse():
    empty = glowing("Empty", lambda t: node(t, "BsdfDiffuse"))
    empty.node_tree.links.clear()
    assert read_material(empty, ImageTable(), []).lobes == ()
    if bpy.app.version < (5, 0):
        empty.use_nodes = False
        empty.diffuse_color = (0.5, 0.25, 1.0, 1.0)
        (lobe,) = read_material(empty, ImageTable(), []).lobes
        assert lobe.closure == mt.Diffuse(ex.Constant((0.5, 0.25, 1.0)))


def test_the_output_for_cycles_counts():
    material = glowing("Two outputs", lambda t: node(t, "BsdfDiffuse"))
    tree = material.node_tree
    eevee = tree.nodes.new("ShaderNodeOutputMaterial")
    eevee.target = "EEVEE"
    tree.links.new(node(tree, "BsdfPrincipled"), eevee.inputs[0])
    mine = tree.nodes.new("ShaderNodeOutputMaterial")
    mine.target = "CYCLES"
    tree.links.new(node(tree, "Emission"), mine.inputs[0])
    (lobe,) = read_material(material, ImageTable(), []).lobes
    assert type(lobe.closure) is mt.Emission


SINCE_5_3 = pytest.mark.skipif(bpy.app.version < (5, 3), reason="Blender has these sockets from 5.3 on")


@SINCE_5_3
def test_stretched_glass():
    """As on the Glossy BSDF: what is not stretched reads no tangent."""
    sockets = {"Roughness": 0.5, "Anisotropy": 0.4, "Rotation": 0.25}
    (lobe,) = lobes(lambda t: node(t, "BsdfGlass", {**sockets, "Tangent": node(t, "Tangent", axis="X")}))
    assert (lobe.closure.anisotropy, lobe.closure.rotation) == (constant(0.4), constant(0.25))
    assert lobe.closure.tangent == mt.Tangent("RADIAL", "X")
    assert requirements([mt.Material("Gold", (lobe,))]).generated
    for smooth in ({**sockets, "Anisotropy": 0.0}, {**sockets, "Roughness": 0.0}):
        (lobe,) = lobes(lambda t, inputs=smooth: node(t, "BsdfGlass", inputs))
        assert (lobe.closure.anisotropy, lobe.closure.rotation) == (ex.ZERO, ex.ZERO)


def test_anisotropic_stretches_transmission_since_5_3():
    """Principled: alpha over and times sqrt(1 - 0.9 a).

    Glass, Glossy: alpha over and times 1 + a for a below 0.
    """
    (lobe,) = lobes(principled(Transmission_Weight=1.0, Anisotropic=0.6, Roughness=0.5))
    root = (1.0 - 0.9 * 0.6) ** 0.5
    expected = root - 1.0 if bpy.app.version >= (5, 3) else 0.0
    assert lobe.closure.anisotropy == constant(expected)


@SINCE_5_3
def test_dispersion_is_scale_over_abbe_number():
    def read(scale, abbe):
        sockets = {"Transmission Dispersion Scale": scale, "Transmission Dispersion Abbe Number": abbe}
        return lobes(principled(Transmission_Weight=1.0, Roughness=0.0, **sockets))[0].closure.dispersion

    assert read(0.5, 20.0) == constant(0.025)
    for scale, abbe in ((0.0, 20.0), (-1.0, 20.0), (1.0, 0.0), (1.0, -20.0)):
        assert read(scale, abbe) == ex.ZERO


@SINCE_5_3
def test_textured_dispersion_of_multiscatter_glass_is_refused():
    def build(tree, **more):
        scale = node(tree, "LayerWeight")
        return node(
            tree, "BsdfPrincipled", {"Transmission Weight": 1.0, "Transmission Dispersion Scale": scale}, **more
        )

    (refusal,) = refused(build)
    assert "Principled BSDF), sockets 'Transmission Dispersion' (textured)" in refusal
    assert refused(lambda tree: build(tree, distribution="GGX")) == []


def test_a_filter_width_at_its_default_in_single_precision_is_read():
    (lobe,) = lobes(lambda t: bumped(t, 0.1))
    assert isinstance(lobe.closure.normal, ex.Bump)


def displaced(build, **inputs):
    material = glowing("Gold", build)
    tree = material.node_tree
    (out,) = (n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    height = node(tree, "TexGradient", output="Fac")
    tree.links.new(node(tree, "Displacement", {"Height": height, **inputs}), out.inputs["Displacement"])
    material.displacement_method = "BUMP"
    return material


def test_displacement_that_only_bumps_turns_every_normal():
    refusals = []
    material = displaced(
        lambda t: node(t, "AddShader", {"Shader": node(t, "BsdfDiffuse"), "Shader_001": node(t, "BsdfGlossy")})
    )
    first, second = read_material(material, ImageTable(), refusals).lobes
    assert refusals == []
    assert isinstance(first.closure.normal, ex.SurfaceNormal)
    assert isinstance(first.closure.normal.normal, ex.Bump)
    assert second.closure.normal == first.closure.normal


@pytest.mark.skipif(bpy.app.version < (5, 2), reason="Displacement and Bump is read from Blender 5.2 on")
def test_displacement_and_bump_gives_the_surface_its_normal():
    material, refusals = displaced(lambda t: node(t, "BsdfDiffuse"), Height=0.5), []
    material.displacement_method = "BOTH"
    (lobe,) = read_material(material, ImageTable(), refusals).lobes
    assert isinstance(lobe.closure.normal, ex.SurfaceNormal)
    assert isinstance(lobe.closure.normal.normal, ex.Undisplaced)


def test_a_bump_node_over_a_displacement_keeps_the_normal_of_the_surface():
    (lobe,) = read_material(displaced(lambda t: bumped(t, 0.1)), ImageTable(), []).lobes
    assert isinstance(lobe.closure.normal, ex.Bump)
    assert isinstance(lobe.closure.normal.normal, ex.SurfaceNormal)


def test_what_reads_the_plain_normal_is_refused_beside_a_bump():
    refusals = []
    material = displaced(lambda t: node(t, "BsdfDiffuse", {"Color": node(t, "NewGeometry", output="Normal")}))
    read_material(material, ImageTable(), refusals)
    (refusal,) = map(str, refusals)
    assert "a normal as coordinates beside a displacement" in refusal


@pytest.mark.parametrize("transparent", [False, True])
def test_opaque_shadows_of_transparent_surfaces_are_read(transparent):
    material, refusals = glowing("Gold", lambda t: node(t, "BsdfTransparent")), []
    material.use_transparent_shadow = transparent
    assert read_material(material, ImageTable(), refusals).transparent_shadows == transparent
    assert refusals == []


@pytest.mark.parametrize("damaged", [False, True])
def test_a_file_that_is_not_there_or_damaged_is_magenta_and_named(tmp_path, damaged):
    path = tmp_path / "rug.png"
    path.write_bytes(b"not a picture")
    image = bpy.data.images.load(str(path))
    if not damaged:
        path.unlink()
    table = ImageTable()
    read = read_material(glowing("Rug", textured(image=image)), table, [])
    assert read.lobes[0].closure.color == ex.Constant((1.0, 0.0, 1.0))
    (missing,) = table.missing
    fault = "cannot be read" if damaged else "is not there"
    assert missing == f"image '{image.name}': file '{path}' {fault}"


def test_a_node_without_an_image_is_magenta_and_named():
    table, material = ImageTable(), glowing("Rug", textured(image=None))
    read = read_material(material, table, [])
    assert read.lobes[0].closure.color == ex.Constant((1.0, 0.0, 1.0))
    assert list(table.missing) == [f"material '{material.name}': node 'Image Texture' has no image"]


def test_images_are_collected_once():
    table = ImageTable()
    first, second = (bpy.data.images.new(name, 2, 2) for name in ("one", "two"))
    for image in (first, second, first):
        read_material(glowing("Gold", textured(image=image)), table, [])
    assert [image.name for image in table.images] == [first.name, second.name]
    assert table.images[0].pixels.shape == (2, 2, 4)


def shared_shaders(tree, factor):
    """40 Mix Shaders, each of which takes the one before twice: 2^40 ways to the closures."""
    last = node(tree, "AddShader", {"Shader": node(tree, "BsdfDiffuse"), "Shader_001": node(tree, "Emission")})
    for _ in range(40):
        last = node(tree, "MixShader", {"Fac": factor(tree), "Shader": last, "Shader_001": last})
    return last


def layer_facing(tree):
    return node(tree, "LayerWeight", output="Facing")


@pytest.mark.parametrize("factor", [lambda tree: 0.3, layer_facing])
def test_a_shader_in_use_many_times_is_read_once_with_the_sum_of_its_weights(factor):
    read, glow = lobes(lambda tree: shared_shaders(tree, factor))
    assert isinstance(read.closure, mt.Diffuse)
    assert isinstance(glow.closure, mt.Emission)
    assert glow.weight is read.weight or glow.weight.value == read.weight.value
    points = Points({"UV": np.zeros((3, 4))}, (1.0, False))
    assert evaluate(read.weight, points, ImageSet(())) == pytest.approx(1.0, abs=1e-12)


def test_weights_of_a_shared_shader_add_up():
    def build(tree):
        once, other = node(tree, "BsdfDiffuse"), node(tree, "Emission")
        inner = node(tree, "MixShader", {"Fac": 0.25, "Shader": once, "Shader_001": other})
        return node(tree, "MixShader", {"Fac": 0.5, "Shader": inner, "Shader_001": once})

    read, glow = lobes(build)
    assert read.weight == ex.Constant(0.875)
    assert glow.weight == ex.Constant(0.125)


def chain(kind, length, **properties):
    def build(tree):
        last = node(tree, "TexCoord", output="UV")
        for _ in range(length):
            last = node(tree, kind, {"Vector": last}, **properties)
        return node(tree, "Emission", {"Color": last})

    return build


def test_a_chain_of_nodes_may_be_long():
    """Each Vector Rotate of Euler angles is three nodes of an expression."""
    (read,) = lobes(chain("VectorRotate", 99, rotation_type="EULER_XYZ"))
    points = Points({"UV": np.full((3, 4), 0.25)})
    assert evaluate(read.closure.color, points, ImageSet(())) == pytest.approx(0.25, abs=1e-6)


def test_a_chain_that_is_too_long_is_refused_in_one_line():
    (refusal,) = refused(chain("VectorRotate", 150, rotation_type="X_AXIS"))
    assert re.fullmatch(
        r"material '.*': node 'Vector Rotate.*' \(Vector Rotate\), behind a chain of 100 nodes, .*", refusal
    )


@pytest.mark.parametrize(("output", "power"), [("Quadratic", 0), ("Linear", 1), ("Constant", 2)])
@pytest.mark.parametrize("smooth", [0.0, 2.0, -1.0])
def test_a_light_falloff_node_is_a_power_of_the_length_faded_near_the_light(output, power, smooth):
    """Of a strength of 3: times length^2 / (smooth + length^2) where Smooth is above 0."""
    inputs = {"Strength": 3.0, "Smooth": smooth}
    (lobe,) = lobes(lambda t: node(t, "Emission", {"Strength": node(t, "LightFalloff", inputs, output=output)}))
    points = Points({"UV": np.zeros((3, 3))})
    points.tally = np.zeros((len(COUNTS), 3))
    points.tally[COUNTS.index("RAY_LENGTH")] = length = np.array([0.5, 1.0, 7.0])
    expected = 3.0 * length**power * length**2 / (max(smooth, 0.0) + length**2)
    assert np.allclose(evaluate(lobe.closure.strength, points, ImageSet([])), expected)
