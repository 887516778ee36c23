# SPDX-License-Identifier: GPL-3.0-or-later
"""Color, Vector and Converter nodes with all inputs in -3..3.

What Cycles shows there is their definition. Each case is one cell of a picture without noise. Its 256 points have
inputs of their own, read from the texels of small float images: half of them multiples of 0.5, where equalities, zeros
and ends of intervals lie, half of them random.
"""

import zlib

import bpy
import numpy as np
import pytest
from etalon.tests.addon.export.nodes.node_cases import BLENDS, COORDINATES, MATH
from etalon.tests.addon.export.nodes.node_cells import (
    CELL,
    FACING,
    Points,
    cycles_luminance,
    glowing,
    node,
    predicted,
    prepare,
    quad,
    read_tabulated,
    rendered,
    through_emission,
)

pytestmark = pytest.mark.compares_with_cycles

END = 3.0
VECTOR_MATH = [item.identifier for item in bpy.types.ShaderNodeVectorMath.bl_rna.properties["operation"].enum_items]
MODES = ("RGB", "HSV", "HSL")


class Inputs:
    """Sockets of a tree whose content is known texel by texel.

    They are colours and values, each another set of numbers.
    """

    def __init__(self, tree, numbers):
        self._tree, self._numbers = tree, numbers

    def color(self):
        texels = self._numbers.uniform(-END, END, (CELL, CELL, 4))
        texels[: CELL // 2] = np.round(2.0 * texels[: CELL // 2]) / 2.0 + 0.0  # no -0
        texels[..., 3] = 1.0
        image = bpy.data.images.new("inputs", CELL, CELL, float_buffer=True, alpha=False, is_data=True)
        image.pixels.foreach_set(texels.astype(np.float32).ravel())
        coordinates = node(self._tree, "TexCoord", output="UV")
        return node(self._tree, "TexImage", {"Vector": coordinates}, image=image, interpolation="Closest")

    def value(self):
        return node(self._tree, "SeparateXYZ", {"Vector": self.color()})


def link(tree, made, **sockets):
    """Link `sockets`, and return the first output that is on.

    They are named by identifier, with underscores for blanks.
    """
    there = {s.identifier: s for s in made.inputs}
    for name, source in sockets.items():
        tree.links.new(source, there.get(name) or there[name.replace("_", " ")])
    return next(s for s in made.outputs if s.enabled)


def added(tree, kind, **properties):
    return node(tree, kind, **properties).node


def mix(kind, blend="MIX", **options):
    def build(tree, inputs):
        made = added(tree, "Mix", data_type=kind, **({"blend_type": blend} if kind == "RGBA" else {}), **options)
        suffix = {"FLOAT": "Float", "VECTOR": "Vector", "RGBA": "Color"}[kind]
        content = inputs.value if kind == "FLOAT" else inputs.color
        by_vector = options.get("factor_mode") == "NON_UNIFORM"
        sockets = {"Factor_Vector" if by_vector else "Factor_Float": inputs.color() if by_vector else inputs.value()}
        return link(tree, made, **sockets, **{f"A_{suffix}": content(), f"B_{suffix}": content()})

    return build


def math(operation, **options):
    def build(tree, inputs):
        made = added(tree, "Math", operation=operation, **options)
        return link(tree, made, **{s.identifier: inputs.value() for s in made.inputs if s.enabled})

    return build


def vector_math(operation):
    def build(tree, inputs):
        made = added(tree, "VectorMath", operation=operation)
        content = {
            s.identifier: inputs.value() if s.type == "VALUE" else inputs.color() for s in made.inputs if s.enabled
        }
        return link(tree, made, **content)

    return build


def every_input(kind, **properties):
    """A node with all inputs that are on linked, each to values or colours as its type says."""

    def build(tree, inputs):
        made = added(tree, kind, **properties)
        for socket in made.inputs:
            if socket.enabled:
                tree.links.new(inputs.value() if socket.type == "VALUE" else inputs.color(), socket)
        return next(s for s in made.outputs if s.enabled)

    return build


def separated(mode, output):
    def build(tree, inputs):
        made = added(tree, "SeparateColor", mode=mode)
        tree.links.new(inputs.color(), made.inputs[0])
        return made.outputs[output]

    return build


def ramp(output="Color", **settings):
    def build(tree, inputs):
        made = added(tree, "ValToRGB")
        for name, value in settings.items():
            setattr(made.color_ramp, name, value)
        made.color_ramp.elements[0].color, made.color_ramp.elements[1].color = (
            (0.9, 0.1, 0.2, 0.3),
            (0.1, 0.3, 0.8, 0.9),
        )
        tree.links.new(inputs.value(), made.inputs[0])
        return made.outputs[output]

    return build


def curves(kind, extend):
    def build(tree, inputs):
        made = added(tree, kind)
        made.mapping.extend = extend
        for k, curve in enumerate(made.mapping.curves):
            low = curve.points[0].location[0]
            curve.points[0].location, curve.points[-1].location = (low + 0.1 * k, 0.1), (1.0 - 0.1 * k, 0.7)
            curve.points.new(0.4, 0.9 - 0.2 * k)
        made.mapping.update()
        content = {"FloatCurve": "Value", "VectorCurve": "Vector", "RGBCurve": "Color"}[kind]
        return link(tree, made, **{content: inputs.value() if kind == "FloatCurve" else inputs.color()})

    return build


CASES = {
    **{f"mix {kind}": mix(kind) for kind in ("FLOAT", "VECTOR")},
    **{f"mix {kind} free": mix(kind, clamp_factor=False) for kind in ("FLOAT", "VECTOR")},
    "mix VECTOR by a vector": mix("VECTOR", factor_mode="NON_UNIFORM"),
    "mix VECTOR by a vector free": mix("VECTOR", factor_mode="NON_UNIFORM", clamp_factor=False),
    **{f"blend {name}": mix("RGBA", name) for name in BLENDS},
    **{f"blend {name} free": mix("RGBA", name, clamp_factor=False) for name in BLENDS},
    **{f"blend {name} clamped": mix("RGBA", name, clamp_result=True) for name in BLENDS},
    **{f"math {name}": math(name) for name in MATH},
    "math ADD clamped": math("ADD", use_clamp=True),
    **{f"vector math {name}": vector_math(name) for name in VECTOR_MATH},
    **{
        f"map range {kind} {name} {clamp}": every_input(
            "MapRange", data_type=kind, interpolation_type=name, clamp=clamp
        )
        for kind in ("FLOAT", "FLOAT_VECTOR")
        for name in ("LINEAR", "STEPPED", "SMOOTHSTEP", "SMOOTHERSTEP")
        for clamp in (False, True)
    },
    **{f"clamp {kind}": every_input("Clamp", clamp_type=kind) for kind in ("MINMAX", "RANGE")},
    **{f"combine {mode}": every_input("CombineColor", mode=mode) for mode in MODES},
    "combine XYZ": every_input("CombineXYZ"),
    **{f"separate {mode} {k}": separated(mode, k) for mode in MODES for k in range(3)},
    "hue saturation": every_input("HueSaturation"),
    "bright contrast": every_input("BrightContrast"),
    "gamma": every_input("Gamma"),
    "invert": every_input("Invert"),
    "black and white": every_input("RGBToBW"),
    "colour to value": lambda tree, inputs: link(tree, added(tree, "Math"), Value=inputs.color()),
    "blackbody": every_input("Blackbody"),
    **{
        f"rotate {kind} {invert}": every_input("VectorRotate", rotation_type=kind, invert=invert)
        for kind in ("AXIS_ANGLE", "X_AXIS", "Y_AXIS", "Z_AXIS")
        for invert in (False, True)
    },
    "rotate EULER_XYZ": every_input("VectorRotate", rotation_type="EULER_XYZ"),
    **{
        f"mapping {kind}": every_input("Mapping", vector_type=kind) for kind in ("POINT", "TEXTURE", "VECTOR", "NORMAL")
    },
    "ramp CONSTANT": ramp(color_mode="RGB", interpolation="CONSTANT"),
    "ramp LINEAR": ramp(color_mode="RGB", interpolation="LINEAR"),
    "ramp LINEAR alpha": ramp("Alpha", color_mode="RGB", interpolation="LINEAR"),
    **{
        f"{kind} {extend}": curves(kind, extend)
        for kind in ("RGBCurve", "VectorCurve", "FloatCurve")
        for extend in ("EXTRAPOLATED", "HORIZONTAL")
    },
}
# Points that may fall on the other side of a step by rounding: at the angle of total reflection the root's argument is 0.
ROUNDED = {"vector math REFRACT": 1}
# Cycles fits the colours of black bodies in numbers of six digits.
COARSE = {"blackbody": 5e-4}


@pytest.fixture(scope="module")
def cells(tmp_path_factory):
    """Case -> what Cycles shows, what we predict."""
    builds = {name: (lambda tree, _, build=build: build(tree)) for name, build in COORDINATES.items()} | CASES
    side = int(np.ceil(np.sqrt(len(builds))))
    scene = prepare("ORTHO", side * CELL, side * CELL)
    scene.camera.data.ortho_scale = side
    scene.camera.location = (side / 2, side / 2, 10)
    numbers = np.random.default_rng(zlib.crc32(__name__.encode()))
    materials = {}
    for index, (name, build) in enumerate(builds.items()):
        mesh = quad(name, (index % side + 0.5, index // side + 0.5, 0), *FACING)
        shown = through_emission(lambda tree, build=build: build(tree, Inputs(tree, numbers)))
        materials[name] = glowing(name, shown)
        mesh.materials.append(materials[name])
    picture = rendered(scene, tmp_path_factory.mktemp("outside"))
    shown = {}
    for index, name in enumerate(builds):
        row, column = index // side * CELL, index % side * CELL
        shown[name] = picture[:, row : row + CELL, column : column + CELL].reshape(3, -1)
    points = Points({kind: shown[kind] for kind in COORDINATES})
    with cycles_luminance():
        return {name: (shown[name], predicted(materials[name], points, read_tabulated)) for name in CASES}


@pytest.mark.parametrize("name", CASES)
def test_node_takes_inputs_outside_the_unit_range_as_cycles_does(cells, name):
    shown, got = cells[name]
    assert np.ptp(shown) > 0.0
    got = np.where(np.isfinite(got).all(axis=0), got, 0.0)  # Cycles drops such a sample
    error = (np.abs(got - shown) / (0.5 + np.abs(shown).max(axis=0))).max(
        axis=0
    )  # inputs of 3 cancel in single precision
    assert np.sort(error)[-1 - ROUNDED.get(name, 0)] < COARSE.get(name, 1e-5), error.argmax()
