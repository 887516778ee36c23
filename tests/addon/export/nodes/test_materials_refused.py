# SPDX-License-Identifier: GPL-3.0-or-later
"""What materials hold that is not simulated: every refusal by name."""

import bpy
import numpy as np
import pytest
from etalon.tests.addon.export.nodes.node_cells import glowing, node
from etalon.tests.addon.export.nodes.reading import bumped, colored, principled, refused


@pytest.fixture(scope="module", autouse=True)
def _empty_file():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


def bump(tree):
    return node(tree, "Bump")


def mapped_inside(tree):
    texture = node(tree, "TexChecker")
    texture.node.texture_mapping.scale = (2, 1, 1)
    return texture


def with_alpha(settings):
    def build(tree):
        image = bpy.data.images.new("leaf", 2, 2, alpha=True)
        for name, value in settings.items():
            setattr(image, name, value)
        image.pixels.foreach_set(np.full(16, 0.5, np.float32))
        return node(tree, "BsdfDiffuse", {"Color": node(tree, "TexImage", image=image)})

    return build


def tinted_greys(tree):
    image = bpy.data.images.new("rug", 2, 2)
    image.colorspace_settings.name = "Linear CIE-XYZ D65"
    image.pixels.foreach_set(np.full(16, 0.5, np.float32))
    return node(tree, "BsdfDiffuse", {"Color": node(tree, "TexImage", image=image)})


def high_dynamic_range(tree):
    image = bpy.data.images.new("rug", 2, 2, float_buffer=True)
    image.colorspace_settings.name = "Rec.2100-PQ"
    return node(tree, "BsdfDiffuse", {"Color": node(tree, "TexImage", image=image)})


def broken_texels(tree):
    image = bpy.data.images.new("rug", 2, 2, float_buffer=True)
    image.pixels.foreach_set(np.full(16, np.nan, np.float32))
    return node(tree, "BsdfDiffuse", {"Color": node(tree, "TexImage", image=image)})


def tiled(tree):
    return node(
        tree, "BsdfDiffuse", {"Color": node(tree, "TexImage", image=bpy.data.images.new("tiles", 2, 2, tiled=True))}
    )


def dead_alpha(tree):
    image = bpy.data.images.new("leaf", 2, 2, alpha=True)
    image.pixels.foreach_set(np.full(16, 0.5, np.float32))
    texture = node(tree, "TexImage", image=image)
    node(tree, "Math", {"Value": texture.node.outputs["Alpha"]})
    return node(tree, "BsdfDiffuse", {"Color": texture})


def normal_node(direction, normal=(0.0, 0.0, 1.0)):
    def build(tree):
        made = node(tree, "Normal", {"Normal": normal})
        made.default_value = direction
        return made.node.outputs["Dot"]

    return build


def inside_group(tree):
    group = bpy.data.node_groups.new("Brass", "ShaderNodeTree")
    group.interface.new_socket("Out", in_out="OUTPUT", socket_type="NodeSocketShader")
    group.links.new(node(group, "BsdfRayPortal"), group.nodes.new("NodeGroupOutput").inputs[0])
    use = tree.nodes.new("ShaderNodeGroup")
    use.node_tree = group
    return use.outputs[0]


def film_that_varies(tree):
    return node(tree, "BsdfPrincipled", {"Thin Film Thickness": node(tree, "LayerWeight")})


FILMS = (
    {"Principled BSDF), sockets 'Thin Film' (textured) above a diffuse base": film_that_varies}
    if bpy.app.version >= (5, 0, 0)
    else {"Principled BSDF), socket 'Thin Film Thickness' in Blender before 5.0": principled(Thin_Film_Thickness=200.0)}
)


REFUSED = {
    "node 'Bump' (Bump), socket 'Filter Width' (linked), is not simulated; unlink Filter Width": lambda t: bumped(
        t, node(t, "Value")
    ),
    "group 'Group', node 'Ray Portal BSDF'": inside_group,
    **FILMS,
    "Principled BSDF), socket 'IOR' (textured)": lambda t: node(t, "BsdfPrincipled", {"IOR": node(t, "LayerWeight")}),
    "Glass BSDF), socket 'IOR' (textured)": lambda t: node(t, "BsdfGlass", {"Roughness": 0.5, "IOR": node(t, "LayerWeight")}),
    "Pixel Size of a Wireframe node in its emission": lambda t: node(
        t, "Emission", {"Color": node(t, "Wireframe", use_pixel_size=True)}
    ),
    "a Bevel node in its emission": lambda t: node(t, "Emission", {"Color": node(t, "Bevel")}),
    "a Bevel node in its subsurface scattering": lambda t: node(t, "SubsurfaceScattering", {"Normal": node(t, "Bevel")}),
    "a Bevel node in the height of a bump": lambda t: node(
        t, "BsdfDiffuse", {"Normal": node(t, "Bump", {"Height": node(t, "Bevel")})}
    ),
    "ambient occlusion in its emission": lambda t: node(t, "Emission", {"Color": node(t, "AmbientOcclusion")}),
    "ambient occlusion in its subsurface scattering": lambda t: node(
        t, "SubsurfaceScattering", {"Color": node(t, "AmbientOcclusion")}
    ),
    "ambient occlusion in what lets light straight through": lambda t: node(
        t, "BsdfTransparent", {"Color": node(t, "AmbientOcclusion")}
    ),
    "Gabor Texture": colored(lambda t: node(t, "TexGabor")),
    "socket 'Tangent' (linked)": lambda t: node(t, "BsdfGlossy", {"Anisotropy": 0.5, "Tangent": bump(t)}),
    "output 'Camera'": colored(lambda t: node(t, "TexCoord", output="Camera")),
    "output 'Window'": colored(lambda t: node(t, "TexCoord", output="Window")),
    "output 'Reflection'": colored(lambda t: node(t, "TexCoord", output="Reflection")),
    "Attribute), type Object": colored(lambda t: node(t, "Attribute", attribute_type="OBJECT", attribute_name="x")),
    "output 'Random Per Island'": colored(lambda t: node(t, "NewGeometry", output="Random Per Island")),
    "whose direction has no length": colored(normal_node((0.0, 0.0, 0.0))),
    "whose input has no length": colored(normal_node((0.0, 0.0, 1.0), (0.0, 0.0, 0.0))),
    "object 'Null'": colored(lambda t: node(t, "TexCoord", output="Object", object=bpy.data.objects.new("Null", None))),
    "option 'From Instancer'": colored(lambda t: node(t, "TexCoord", output="UV", from_instancer=True)),
    "built-in texture mapping (scale)": colored(mapped_inside),
    "image 'rug' (colour space Linear CIE-XYZ D65, tinted greys)": tinted_greys,
    "image 'rug' (texels that are not finite)": broken_texels,
    "image 'tiles' (tiled, not saved)": tiled,
    "output 'Alpha', whose links lead nowhere": dead_alpha,
}  # fmt: skip


if bpy.app.version >= (5, 1):
    REFUSED["image 'leaf' (alpha Premul of an image that Blender keeps"] = with_alpha({"alpha_mode": "PREMUL"})


if bpy.app.version >= (5, 0):
    REFUSED["image 'rug' (colour space Rec.2100-PQ, of floats)"] = high_dynamic_range


@pytest.mark.parametrize("named", REFUSED)
def test_what_is_not_simulated_is_refused_by_name(named):
    for image in list(bpy.data.images):
        bpy.data.images.remove(image)
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    (refusal,) = refused(REFUSED[named])
    assert refusal.startswith("material '")
    assert named in refusal


def test_displacement_by_another_node_is_refused():
    material = glowing("Gold", lambda t: node(t, "BsdfDiffuse"))
    material.displacement_method = "DISPLACEMENT"
    tree = material.node_tree
    (out,) = (n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    tree.links.new(node(tree, "Value"), out.inputs["Displacement"])
    (refusal,) = refused(material)
    assert "socket 'Displacement'" in refusal


def test_all_refusals_come_together():
    found = refused(
        lambda t: node(t, "AddShader", {"Shader": node(t, "BsdfRayPortal"), "Shader_001": node(t, "BsdfHair")})
    )
    assert len(found) == 2
