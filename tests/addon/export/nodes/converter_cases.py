# SPDX-License-Identifier: GPL-3.0-or-later
"""More cases of node_cases.py: Converter and Color nodes, procedural textures."""

import bpy
from etalon.tests.addon.export.nodes.node_cases import first_color, lifted, linear, second_color, uv
from etalon.tests.addon.export.nodes.node_cells import FACING, node

VECTOR_MATH = [item.identifier for item in bpy.types.ShaderNodeVectorMath.bl_rna.properties["operation"].enum_items]
GRADIENTS = [item.identifier for item in bpy.types.ShaderNodeTexGradient.bl_rna.properties["gradient_type"].enum_items]
NOISES = [item.identifier for item in bpy.types.ShaderNodeTexNoise.bl_rna.properties["noise_type"].enum_items]
FEATURES = [item.identifier for item in bpy.types.ShaderNodeTexVoronoi.bl_rna.properties["feature"].enum_items]
METRICS = [item.identifier for item in bpy.types.ShaderNodeTexVoronoi.bl_rna.properties["distance"].enum_items]
CURVED = ((0.0, 0.1), (0.3, 0.7), (0.8, 0.4), (1.0, 1.2))


def shifted(tree, scale=2.6, location=(-1.3, -1.1, 0.37)):
    """Coordinates on both sides of zero, off the axes."""
    return node(
        tree, "Mapping", {"Vector": uv(tree), "Scale": (scale,) * 3, "Location": location, "Rotation": (0.4, 0.3, 0.2)}
    )


def grey(tree, value):
    """A value plus 4, as a colour."""
    return node(tree, "Math", {"Value": value, "Value_001": 4.0})


def vector_math(operation):
    def build(tree):
        inputs = {
            "Vector": shifted(tree),
            "Vector_001": second_color(tree),
            "Vector_002": (0.3, 0.9, 0.5),
            "Scale": 0.7,
        }
        made = node(tree, "VectorMath", operation=operation)
        for name, value in inputs.items():
            socket = next(s for s in made.node.inputs if s.identifier == name)
            if socket.enabled:
                if isinstance(value, bpy.types.NodeSocket):
                    tree.links.new(value, socket)
                else:
                    socket.default_value = value
        out = next(s for s in made.node.outputs if s.enabled)
        return grey(tree, out) if out.name == "Value" else lifted(tree, out)

    return build


def separated(kind, mode, output):
    def build(tree):
        options = {"mode": mode} if mode else {}
        return grey(
            tree, node(tree, kind, {"Color" if mode else "Vector": first_color(tree)}, output=output, **options)
        )

    return build


def combined(mode):
    def build(tree):
        inputs = {"Red": linear(tree, 0.9, 0.02), "Green": linear(tree, 0.7, 0.2, axis=1), "Blue": 0.6}
        return node(tree, "CombineColor", inputs, mode=mode)

    return build


def map_range(interpolation, clamp=True):
    def build(tree):
        inputs = {"Value": linear(tree, 1.4, -0.2), "From Min": 0.1, "From Max": linear(tree, 0.4, 0.6, axis=1)}
        inputs |= {"To Min": 1.3, "To Max": -0.4}
        made = node(tree, "MapRange", inputs, interpolation_type=interpolation, clamp=clamp)
        if interpolation == "STEPPED":
            made.node.inputs["Steps"].default_value = 3.0
        return grey(tree, made)

    return build


def vector_map_range(interpolation):
    def build(tree):
        made = node(tree, "MapRange", data_type="FLOAT_VECTOR", interpolation_type=interpolation)
        sockets = {s.identifier: s for s in made.node.inputs}
        tree.links.new(shifted(tree), sockets["Vector"])
        sockets["From_Min_FLOAT3"].default_value = (-1.0, 0.2, -0.3)
        sockets["To_Max_FLOAT3"].default_value = (0.4, -2.0, 1.5)
        return lifted(tree, next(s for s in made.node.outputs if s.enabled))

    return build


def clamped(kind):
    return lambda tree: node(
        tree,
        "Clamp",
        {"Value": linear(tree, 3, -1), "Min": 0.9, "Max": 0.3 if kind == "RANGE" else 1.4},
        clamp_type=kind,
    )


def hue_saturation(tree):
    inputs = {"Hue": linear(tree, 1.3, -0.2), "Saturation": 1.4, "Value": 0.8, "Fac": 0.7, "Color": first_color(tree)}
    return node(tree, "HueSaturation", inputs)


def bright_contrast(tree):
    return node(tree, "BrightContrast", {"Color": first_color(tree), "Bright": 0.1, "Contrast": linear(tree, 2, -0.5)})


def gamma(tree):
    return lifted(tree, node(tree, "Gamma", {"Color": first_color(tree), "Gamma": linear(tree, 2, 0.3)}))


def inverted(tree):
    return lifted(tree, node(tree, "Invert", {"Color": first_color(tree), "Fac": linear(tree, 1.4, -0.2)}))


def black_and_white(tree):
    return grey(tree, node(tree, "RGBToBW", {"Color": first_color(tree)}))


def blackbody(tree):
    return node(
        tree,
        "Blackbody",
        {
            "Temperature": node(
                tree, "Math", {"Value": linear(tree, 12.5, 0.3), "Value_001": 1000.0}, operation="MULTIPLY"
            )
        },
    )


def normal_node(output):
    """The Normal node, of a direction that is not of unit length."""

    def build(tree):
        made = node(tree, "Normal", {"Normal": shifted(tree)})
        made.default_value = (0.4, -0.7, 0.9)
        if output == "Dot":
            return grey(tree, made.node.outputs["Dot"])
        return lifted(tree, node(tree, "VectorMath", {"Vector": shifted(tree), "Vector_001": made}))

    return build


def rotated(kind, invert=False):
    def build(tree):
        made = node(
            tree,
            "VectorRotate",
            {"Vector": shifted(tree), "Center": (0.2, 0.1, -0.3)},
            rotation_type=kind,
            invert=invert,
        )
        for name, value in (("Axis", (0.3, -0.5, 0.8)), ("Angle", 0.7), ("Rotation", (0.4, 0.8, -0.3))):
            if name in made.node.inputs and made.node.inputs[name].enabled:
                made.node.inputs[name].default_value = value
        return lifted(tree, made)

    return build


def bend(curve):
    curve.points[0].location, curve.points[-1].location = CURVED[0], CURVED[-1]
    for point in CURVED[1:-1]:
        curve.points.new(*point)


def curves(kind, extend):
    def build(tree):
        inputs = {"RGBCurve": {"Color": first_color(tree), "Fac": 0.8}, "VectorCurve": {"Vector": first_color(tree)},
                  "FloatCurve": {"Value": linear(tree, 1.6, -0.3)}}[kind]  # fmt: skip
        made = node(tree, kind, inputs)
        mapping = made.node.mapping
        mapping.extend = extend
        bend(mapping.curves[0])
        if kind == "RGBCurve":
            bend(mapping.curves[3])
        mapping.update()
        return grey(tree, made) if kind == "FloatCurve" else lifted(tree, made)

    return build


def pattern(kind, inputs=None, output=None, **options):
    """A texture node over shifted coordinates; its value or its colour plus 4."""

    def build(tree):
        made = node(tree, kind, output=output, **options)
        for name, value in (inputs or {}).items():
            made.node.inputs[name].default_value = value
        if "Vector" in made.node.inputs and made.node.inputs["Vector"].enabled:
            tree.links.new(shifted(tree), made.node.inputs["Vector"])
        if "W" in made.node.inputs and made.node.inputs["W"].enabled:
            tree.links.new(linear(tree, 2.2, -0.9), made.node.inputs["W"])
        return grey(tree, made) if made.type == "VALUE" else lifted(tree, made)

    return build


def snapped_white_noise(dimensions, output):
    """White noise of whole numbers: of anything else the bits are the renderer's own."""

    def build(tree):
        made = node(tree, "TexWhiteNoise", output=output, noise_dimensions=dimensions)
        if "Vector" in made.node.inputs and made.node.inputs["Vector"].enabled:
            scaled = node(tree, "VectorMath", {"Vector": shifted(tree), "Scale": 3.0}, operation="SCALE")
            tree.links.new(node(tree, "VectorMath", {"Vector": scaled}, operation="FLOOR"), made.node.inputs["Vector"])
        if "W" in made.node.inputs and made.node.inputs["W"].enabled:
            tree.links.new(
                node(tree, "Math", {"Value": linear(tree, 4.3, -1.1)}, operation="FLOOR"), made.node.inputs["W"]
            )
        return made

    return build


OCTAVES = {"Scale": 3.0, "Detail": 3.4, "Roughness": 0.6, "Lacunarity": 2.3, "Distortion": 0.0}
CELLS = {"Scale": 2.7}
CONVERTED = {
    **{f"vector math {name}": vector_math(name) for name in VECTOR_MATH},
    **{f"separate XYZ {name}": separated("SeparateXYZ", "", name) for name in "XYZ"},
    **{
        f"separate {mode} {name}": separated("SeparateColor", mode, name)
        for mode in ("RGB", "HSV", "HSL")
        for name in ("Red", "Green", "Blue")
    },
    **{f"combine {mode}": combined(mode) for mode in ("RGB", "HSV", "HSL")},
    "combine XYZ": lambda t: node(t, "CombineXYZ", {"X": linear(t, 1, 0.1), "Y": 0.3, "Z": linear(t, 2, 0.3, axis=1)}),
    **{f"map range {name}": map_range(name) for name in ("LINEAR", "STEPPED", "SMOOTHSTEP", "SMOOTHERSTEP")},
    "map range free": map_range("LINEAR", clamp=False),
    **{f"map range vector {name}": vector_map_range(name) for name in ("LINEAR", "SMOOTHSTEP", "SMOOTHERSTEP")},
    **{f"clamp {kind}": clamped(kind) for kind in ("MINMAX", "RANGE")},
    "hue saturation": hue_saturation,
    "bright contrast": bright_contrast,
    "gamma": gamma,
    "invert": inverted,
    "black and white": black_and_white,
    "blackbody": blackbody,
    **{f"normal {output}": normal_node(output) for output in ("Normal", "Dot")},
    **{f"rotate {kind}": rotated(kind) for kind in ("AXIS_ANGLE", "X_AXIS", "Y_AXIS", "Z_AXIS", "EULER_XYZ")},
    "rotate back": rotated("AXIS_ANGLE", invert=True),
}
CURVED_CASES = {
    f"{kind} {extend}": curves(kind, extend)
    for kind in ("RGBCurve", "VectorCurve", "FloatCurve")
    for extend in ("EXTRAPOLATED", "HORIZONTAL")
}
PATTERNS = {
    **{f"gradient {kind}": pattern("TexGradient", gradient_type=kind) for kind in GRADIENTS},
    **{
        f"wave {kind} {direction}": pattern(
            "TexWave", {"Scale": 0.7}, wave_type=kind, **{f"{kind.lower()}_direction": direction}
        )
        for kind in ("BANDS", "RINGS")
        for direction in ("X", "Y", "Z", "DIAGONAL" if kind == "BANDS" else "SPHERICAL")
    },
    **{
        f"wave {profile}": pattern(
            "TexWave", {"Distortion": 1.5, "Scale": 0.6, "Phase Offset": 0.3}, wave_profile=profile
        )
        for profile in ("SIN", "SAW", "TRI")
    },
    **{
        f"magic {depth}": pattern("TexMagic", {"Scale": 1.3, "Distortion": 1.2}, output="Color", turbulence_depth=depth)
        for depth in range(11)
    },
    "magic value": pattern("TexMagic", output="Fac"),
    **{
        f"brick {output}": pattern(
            "TexBrick",
            {"Scale": 1.1, "Color1": (0.8, 0.2, 0.1, 1), "Mortar Size": 0.05, "Mortar Smooth": 0.4, "Bias": 0.1},
            output=output,
            squash=1.3,
            squash_frequency=3,
        )
        for output in ("Color", "Fac")
    },
    **{
        f"noise {d} {output}": pattern("TexNoise", OCTAVES, output=output, noise_dimensions=d)
        for d in ("1D", "2D", "3D", "4D")
        for output in ("Fac", "Color")
    },
    **{
        f"noise {kind}": pattern(
            "TexNoise",
            {**OCTAVES, "Offset": 0.4, "Gain": 1.3}
            if kind in ("HYBRID_MULTIFRACTAL", "RIDGED_MULTIFRACTAL")
            else OCTAVES,
            output="Fac",
            noise_type=kind,
        )
        for kind in NOISES
    },
    "noise distorted": pattern("TexNoise", {**OCTAVES, "Distortion": 0.7}, output="Color"),
    "noise raw": pattern("TexNoise", OCTAVES, output="Fac", normalize=False),
    **{
        f"white noise {d} {output}": snapped_white_noise(d, output)
        for d in ("1D", "2D", "3D", "4D")
        for output in ("Value", "Color")
    },
    **{
        f"voronoi {d} {feature}": pattern(
            "TexVoronoi",
            CELLS,
            voronoi_dimensions=d,
            feature=feature,
            output="Radius" if feature == "N_SPHERE_RADIUS" else "Distance",
        )
        for d in ("1D", "2D", "3D", "4D")
        for feature in FEATURES
    },
    **{
        f"voronoi {d} {output}": pattern("TexVoronoi", CELLS, voronoi_dimensions=d, output=output)
        for d in ("2D", "3D", "4D")
        for output in ("Color", "Position")
    },
    "voronoi 1D Color": pattern("TexVoronoi", CELLS, voronoi_dimensions="1D", output="Color"),
    "voronoi 1D W": pattern("TexVoronoi", CELLS, voronoi_dimensions="1D", output="W"),
    **{f"voronoi {metric}": pattern("TexVoronoi", CELLS, distance=metric) for metric in METRICS},
    **{
        f"voronoi fractal {feature}": pattern(
            "TexVoronoi", {**CELLS, "Detail": 1.6, "Roughness": 0.6}, feature=feature, normalize=True
        )
        for feature in FEATURES
        if feature != "N_SPHERE_RADIUS"
    },
}
EXTRA = {name: (build, FACING) for name, build in {**CONVERTED, **CURVED_CASES, **PATTERNS}.items()}
