# SPDX-License-Identifier: GPL-3.0-or-later
"""The cases of every supported node and setting.

Each has a function that builds it into a tree and returns the socket to show.
"""

import bpy
from etalon.tests.addon.export.nodes.node_cells import BEHIND, FACING, TILTED, node, stored_image

MATH = [item.identifier for item in bpy.types.ShaderNodeMath.bl_rna.properties["operation"].enum_items]
BLENDS = [item.identifier for item in bpy.types.ShaderNodeMix.bl_rna.properties["blend_type"].enum_items]


def uv(tree):
    return node(tree, "TexCoord", output="UV")


def linear(tree, slope, shift, axis=0):
    """A value that grows linearly over the cell: the mean of a vector with two zeros."""
    scale = [0.0, 0.0, 0.0]
    scale[axis] = 3 * slope
    return node(tree, "Mapping", {"Vector": uv(tree), "Scale": scale, "Location": (3 * shift, 0, 0)})


def affine(tree, rotation, scale, location, kind="POINT"):
    inputs = {"Vector": uv(tree), "Rotation": rotation, "Scale": scale}
    if kind in ("POINT", "TEXTURE"):
        inputs["Location"] = location
    return node(tree, "Mapping", inputs, vector_type=kind)


def first_color(tree):
    return affine(tree, (0.3, 0.5, 0.7), (1.2, 1.1, 1.0), (-0.1, 0.1, 0.3))


def second_color(tree):
    return affine(tree, (1.3, -0.5, 0.2), (1.2, -1.1, 1.0), (0.2, 0.4, 0.3))


def mix_colors(tree, factor, a, b, blend="MIX", **options):
    inputs = {"Factor_Float": factor, "A_Color": a, "B_Color": b}
    return node(
        tree,
        "Mix",
        inputs,
        output="Result_Color",
        data_type="RGBA",
        blend_type=blend,
        **options,
    )


def lifted(tree, color):
    """The colour plus 4, so that negative parts show."""
    return mix_colors(tree, 1.0, color, (4, 4, 4, 1), "ADD")


def math_case(operation, **options):
    def build(tree):
        values = {"Value": linear(tree, 8, -4), "Value_001": linear(tree, 6, -3, axis=1), "Value_002": 0.7}
        return node(
            tree, "Math", {"Value": node(tree, "Math", values, operation=operation, **options), "Value_001": 8.0}
        )

    return build


def mix_case(blend, **options):
    return lambda tree: lifted(
        tree, mix_colors(tree, linear(tree, 1.4, -0.2, axis=1), first_color(tree), second_color(tree), blend, **options)
    )


def legacy_mix(tree):
    inputs = {"Fac": linear(tree, 1.4, -0.2), "Color1": first_color(tree), "Color2": second_color(tree)}
    return lifted(tree, node(tree, "MixRGB", inputs, blend_type="SUBTRACT", use_clamp=True))


def float_mix(tree):
    inputs = {"Factor_Float": linear(tree, 2, -0.5), "A_Float": linear(tree, 3, 1, axis=1), "B_Float": 7.0}
    return node(tree, "Mix", inputs, output="Result_Float", data_type="FLOAT", clamp_factor=True)


def vector_mix(tree):
    inputs = {"Factor_Vector": second_color(tree), "A_Vector": first_color(tree), "B_Vector": (1, 2, 3)}
    return lifted(
        tree, node(tree, "Mix", inputs, output="Result_Vector", data_type="VECTOR", factor_mode="NON_UNIFORM")
    )


def ramp_case(output="Color", **settings):
    def build(tree):
        made = node(tree, "ValToRGB", {"Fac": linear(tree, 1.1, -0.05)}, output=output)
        ramp = made.node.color_ramp
        for name, value in settings.items():
            setattr(ramp, name, value)
        first, last = ramp.elements
        first.position, first.color = 0.1, (0.9, 0.1, 0.2, 0.3)
        last.position, last.color = 0.85, (0.1, 0.3, 0.8, 0.9)
        ramp.elements.new(0.4).color = (0.3, 0.8, 0.1, 0.6)
        ramp.elements.new(0.55).color = (0.8, 0.7, 0.1, 0.1)
        return made

    return build


def layer_weight(output):
    return lambda tree: node(tree, "LayerWeight", {"Blend": linear(tree, 1.2, -0.1)}, output=output)


def image_case(image, alpha="unused", **options):
    def build(tree):
        made = node(tree, "TexImage", image=image(), **options)
        vector = node(tree, "Mapping", {"Vector": uv(tree), "Scale": (1.8, 1.8, 1.8), "Location": (-0.4, -0.4, 0)})
        tree.links.new(vector, made.node.inputs[0])
        if alpha == "shown":
            return made.node.outputs["Alpha"]
        if alpha == "used":
            nothing = node(
                tree, "Math", {"Value": made.node.outputs["Alpha"], "Value_001": 1e-30}, operation="MULTIPLY"
            )
            return mix_colors(tree, 1.0, made, nothing, "ADD")
        return made

    return build


def projected_case(image, projection):
    def build(tree):
        made = node(tree, "TexImage", image=image(), projection=projection, interpolation="Closest")
        tree.links.new(affine(tree, (0.3, 0.5, 0.7), (3.2, 3.1, 1.0), (-0.9, -1.4, 1.9)), made.node.inputs[0])
        return made

    return build


def checker(output):
    inputs = {"Scale": 3.3, "Color1": (0.8, 0.2, 0.1, 1), "Color2": (0.1, 0.2, 0.7, 1)}
    return lambda tree: node(tree, "TexChecker", {"Vector": uv(tree), **inputs}, output=output)


def shaders_mixed(tree):
    one = node(tree, "Emission", {"Color": first_color(tree), "Strength": 2.0})
    two = node(tree, "Emission", {"Color": (0.2, 0.7, 0.4, 1)})
    three = node(tree, "Emission", {"Strength": linear(tree, 0.5, 0.1)})
    mixed = node(tree, "MixShader", {"Fac": linear(tree, 1.4, -0.2), "Shader": one, "Shader_001": two})
    return node(tree, "AddShader", {"Shader": mixed, "Shader_001": three})


def half_mixed(tree):
    return node(tree, "MixShader", {"Fac": 0.3, "Shader_001": node(tree, "Emission", {"Strength": linear(tree, 1, 1)})})


def strength_only(tree):
    return linear(tree, 2, 0.1)


def muted_math(tree):
    made = node(tree, "Math", {"Value": linear(tree, 2, 1), "Value_001": 5.0})
    made.node.mute = True
    return made


def muted_mix_shader(tree):
    made = half_mixed(tree)
    tree.links.new(node(tree, "Emission", {"Strength": linear(tree, 3, 1)}), made.node.inputs[1])
    made.node.mute = True
    return made


def rerouted(tree):
    reroute = tree.nodes.new("NodeReroute")
    tree.links.new(first_color(tree), reroute.inputs[0])
    return lifted(tree, reroute.outputs[0])


def grouped(tree):
    """A group doubles a value.

    A colour goes in and is made a value at its input, and the sum comes out as a colour.
    """
    group = bpy.data.node_groups.new("Doubler", "ShaderNodeTree")
    group.interface.new_socket("In", in_out="INPUT", socket_type="NodeSocketFloat")
    group.interface.new_socket("Scale", in_out="INPUT", socket_type="NodeSocketFloat").default_value = 0.0
    group.interface.new_socket("Out", in_out="OUTPUT", socket_type="NodeSocketColor")
    entry, leave = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    product = node(group, "Math", {"Value": entry.outputs[0], "Value_001": entry.outputs[1]}, operation="MULTIPLY")
    group.links.new(product, leave.inputs[0])
    use = tree.nodes.new("ShaderNodeGroup")
    use.node_tree = group
    tree.links.new(mix_colors(tree, 0.25, first_color(tree), (0.3, 0.9, 0.1, 1)), use.inputs[0])
    use.inputs[1].default_value = 2.0
    return use.outputs[0]


def luminance(tree):
    return node(tree, "Math", {"Value": mix_colors(tree, 0.5, first_color(tree), (0.3, 0.9, 0.1, 1)), "Value_001": 1.0})


def backfacing(tree):
    return node(tree, "Math", {"Value": node(tree, "NewGeometry", output="Backfacing"), "Value_001": 1.0})


def image_cases(folder, numbers):
    plain = stored_image(folder, "plain", "png", "Non-Color", "STRAIGHT", True, numbers)
    for extension in ("REPEAT", "EXTEND", "CLIP", "MIRROR"):
        for interpolation in ("Linear", "Closest", "Cubic", "Smart"):
            yield (
                f"image {extension} {interpolation}",
                image_case(plain, extension=extension, interpolation=interpolation),
            )
    for projection in ("SPHERE", "TUBE"):
        yield f"image {projection}", projected_case(plain, projection)
    for suffix, spaces in {
        "png": ("sRGB", "Linear Rec.709"),
        "exr": ("Linear Rec.709", "Non-Color"),
        "16.png": ("sRGB",),
    }.items():
        for space in spaces:
            opaque = stored_image(folder, f"opaque {space}", suffix, space, "STRAIGHT", True, numbers)
            yield f"image {suffix} {space}", image_case(opaque)
            yield f"image {suffix} {space} unlinked", lambda t, get=opaque: node(t, "TexImage", image=get())
            for mode in ("STRAIGHT" if suffix != "exr" else "PREMUL", "CHANNEL_PACKED", "NONE"):
                if suffix == "png" and mode == "STRAIGHT":
                    continue  # Cycles rounds the product with alpha to 8 bits
                image = stored_image(folder, f"{mode} {space}", suffix, space, mode, False, numbers)
                for alpha in ("unused", "used", "shown"):
                    yield f"image {suffix} {space} {mode}, alpha {alpha}", image_case(image, alpha)


def space_cases(folder, numbers):
    """Images in every colour space of this Blender, but those that are in `image_cases`."""
    names = bpy.types.ColorManagedInputColorspaceSettings.bl_rna.properties["name"].enum_items
    usual = ("sRGB", "Linear Rec.709", "Non-Color")
    for space in (item.identifier for item in names if item.identifier not in usual):
        for suffix in ("png", "exr"):
            if suffix == "exr" and space.startswith("Rec.2100"):
                continue  # refused
            image = stored_image(folder, f"in {space}", suffix, space, "NONE", True, numbers)
            yield f"{suffix} in {space}", image_case(image, interpolation="Closest")


CASES = {
    **{f"math {operation}": (math_case(operation), FACING) for operation in MATH},
    "math clamped": (math_case("ADD", use_clamp=True), FACING),
    **{f"mix {blend}": (mix_case(blend), FACING) for blend in BLENDS},
    "mix unclamped": (mix_case("ADD", clamp_factor=False, clamp_result=True), FACING),
    "mix legacy": (legacy_mix, FACING),
    "mix values": (float_mix, FACING),
    "mix vectors": (vector_mix, FACING),
    **{
        f"mapping {kind}": (
            lambda t, k=kind: lifted(t, affine(t, (0.3, 0.5, 0.7), (1.2, -1.1, 0.5), (-0.1, 0.4, 0.3), k)),
            FACING,
        )
        for kind in ("POINT", "TEXTURE", "VECTOR", "NORMAL")
    },
    **{f"checker {output}": (checker(output), FACING) for output in ("Color", "Fac")},
    **{
        f"fresnel {name}": (lambda t: node(t, "Fresnel", {"IOR": linear(t, 2, 0.3)}), side)
        for name, side in (("front", TILTED), ("back", BEHIND))
    },
    **{
        f"layer weight {output} {name}": (layer_weight(output), side)
        for output in ("Fresnel", "Facing")
        for name, side in (("front", TILTED), ("back", BEHIND))
    },
    "wireframe": (lambda t: node(t, "Wireframe", {"Size": 0.3}), FACING),
    "wireframe, linked size": (lambda t: node(t, "Wireframe", {"Size": linear(t, 0.8, -0.2)}), FACING),
    "backfacing front": (backfacing, TILTED),
    "backfacing back": (backfacing, BEHIND),
    "checker unlinked": (lambda t: node(t, "TexChecker", {"Scale": 3.3}), FACING),
    "uv map": (lambda t: node(t, "UVMap", uv_map="UVMap"), FACING),
    "position": (lambda t: lifted(t, node(t, "NewGeometry", output="Position")), FACING),
    "luminance": (luminance, FACING),
    "shaders mixed": (shaders_mixed, FACING),
    "shaders half mixed": (half_mixed, FACING),
    "value as shader": (strength_only, FACING),
    "color as shader": (first_color, FACING),
    "muted math": (muted_math, FACING),
    "muted mix shader": (muted_mix_shader, FACING),
    "reroute": (rerouted, FACING),
    "group": (grouped, FACING),
}
RAMPS = {
    **{f"ramp {i}": ramp_case(interpolation=i) for i in ("LINEAR", "CONSTANT", "EASE", "CARDINAL", "B_SPLINE")},
    **{f"ramp {mode} {hue}": ramp_case(color_mode=mode, hue_interpolation=hue)
       for mode in ("HSV", "HSL") for hue in ("NEAR", "FAR", "CW", "CCW")},
    "ramp alpha": ramp_case("Alpha", interpolation="EASE"),
}  # fmt: skip
COORDINATES = {
    "UV": lambda t: node(t, "TexCoord", output="UV"),
    "GENERATED": lambda t: node(t, "TexCoord", output="Generated"),
    "OBJECT": lambda t: node(t, "TexCoord", output="Object"),
}
