# SPDX-License-Identifier: GPL-3.0-or-later
"""Normal maps, bumps, geometry outputs and mesh attributes against Cycles.

The test compares what a node gives at each pixel's centre, as colour.
"""

import itertools

import bpy
import numpy as np
import pytest
from etalon.lib.surfaces.surface import SurfacePoints, SurfaceTables
from etalon.lib.textures.evaluate import Evaluator
from etalon.lib.textures.images import ImageSet
from etalon.tests.addon.export.nodes.node_cells import glowing, node
from mathutils import Euler, Matrix

BENT = Matrix.LocRotScale((0.1, -0.2, 0.0), Euler((0.3, -0.4, 0.5)), (1.2, 0.8, 0.6))
MIRRORED = Matrix.LocRotScale((0.1, -0.2, 0.0), Euler((0.3, -0.4, 0.5)), (-1.2, 0.8, 0.6))
EVEN = Matrix.LocRotScale((0.1, -0.2, 0.0), Euler((0.3, -0.4, 0.5)), (1.1, 1.1, 1.1))
COLOR = (0.65, 0.4, 0.9, 1.0)
OFFSET = 4.0


def lifted(tree, socket):
    return node(tree, "Mix", {"Factor_Float": 1.0, "A_Color": socket, "B_Color": (OFFSET,) * 3 + (1.0,)},
                output="Result_Color", data_type="RGBA", blend_type="ADD")  # fmt: skip


def uv(tree):
    return node(tree, "TexCoord", output="UV")


def waves(tree):
    """A height with slopes of its own along both coordinates."""
    scaled = node(tree, "VectorMath", {"Vector": uv(tree), "Vector_001": (7.0, 5.0, 0.0)}, operation="MULTIPLY")
    return node(tree, "VectorMath", {"Vector": node(tree, "VectorMath", {"Vector": scaled}, operation="SINE"), "Vector_001": (0.3, 0.2, 0.0)},
                operation="DOT_PRODUCT", output="Value")  # fmt: skip


def mapped(space="TANGENT", strength=1.0, **options):
    return lambda t: node(t, "NormalMap", {"Color": COLOR, "Strength": strength}, space=space, **options)


def bump(**options):
    def build(tree):
        made = node(
            tree,
            "Bump",
            {"Height": waves(tree), "Strength": options.get("strength", 1.0)},
            invert=options.get("invert", False),
        )
        made.node.inputs["Distance"].default_value = 0.7
        if options.get("over"):
            tree.links.new(mapped()(tree), made.node.inputs["Normal"])
        return made

    return build


def attribute(name, output):
    return lambda t: node(t, "Attribute", attribute_name=name, output=output)


def color_attribute(name, output="Color"):
    return lambda t: node(t, "VertexColor", layer_name=name, output=output)


SPACES = [item.identifier for item in bpy.types.ShaderNodeNormalMap.bl_rna.properties["space"].enum_items]
CASES = {
    **{f"normal map {space} {strength}": mapped(space, strength) for space in SPACES for strength in (1.0, 0.4)},
    "normal map named": mapped(uv_map="UVMap"),
    **{f"geometry {output}": (lambda t, o=output: node(t, "NewGeometry", output=o))
       for output in ("Normal", "True Normal", "Incoming", "Position")},
    "coordinates normal": lambda t: node(t, "TexCoord", output="Normal"),
    "fresnel of a map": lambda t: node(t, "Fresnel", {"IOR": 1.6, "Normal": mapped("OBJECT", 1.0)(t)}),
    **{f"layer weight {output} of a map": (
        lambda t, o=output: node(t, "LayerWeight", {"Blend": 0.3, "Normal": mapped("OBJECT", 0.7)(t)}, output=o))
       for output in ("Fresnel", "Facing")},
    **{f"attribute {name} {output}": attribute(name, output)
       for name in ("points", "corners", "faces", "vectors", "whole", "UVMap", "none") for output in ("Color", "Fac", "Alpha")},
    **{f"color attribute {name!r} {output}": color_attribute(name, output)
       for name in ("", "points", "bytes", "none") for output in ("Color", "Alpha")},
}  # fmt: skip
BUMPS = {"plain": bump(), "weak": bump(strength=0.4), "inverted": bump(invert=True), "over a map": bump(over=True)}


def sheet(studio, smooth, rng):
    """A curved sheet of 6 x 6 quads with a bent UV map and attributes of every kind."""
    x, y = (g.ravel() for g in np.meshgrid(np.linspace(-1, 1, 7), np.linspace(-1, 1, 7)))
    z = 0.25 * np.sin(2.0 * x + 0.5) * np.cos(1.5 * y)
    faces = [(k, k + 1, k + 8, k + 7) for k in (7 * j + i for j in range(6) for i in range(6))]
    mesh = studio.mesh("sheet", np.stack([x, y, z], axis=1), faces)
    mesh.shade_smooth() if smooth else mesh.shade_flat()
    layer = mesh.uv_layers.new(name="UVMap")
    for loop in mesh.loops:
        a, b, _ = mesh.vertices[loop.vertex_index].co
        layer.data[loop.index].uv = (0.5 + 0.4 * a + 0.1 * b, 0.45 + 0.35 * b - 0.05 * a * b)
    for name, kind, domain, field in (
        ("points", "FLOAT_COLOR", "POINT", "color"),
        ("bytes", "BYTE_COLOR", "CORNER", "color"),
        ("corners", "FLOAT", "CORNER", "value"),
        ("faces", "FLOAT_COLOR", "CORNER", "color"),
        ("vectors", "FLOAT_VECTOR", "POINT", "vector"),
        ("whole", "INT", "FACE", "value"),
    ):
        held = mesh.attributes.new(name, kind, domain)
        width = {"color": 4, "vector": 3, "value": 1}[field]
        numbers = rng.random((len(held.data), width)).ravel()
        held.data.foreach_set(field, (numbers * 9).astype(np.int32) if kind == "INT" else numbers.astype(np.float32))
    mesh.color_attributes.render_color_index = 1
    return mesh


def compare(studio, rays, hits, build, smooth, matrix, rng):
    """What Cycles shows and what the expression gives, (3, k).

    These are at the pixels that meet the sheet.
    """
    mesh = sheet(studio, smooth, rng)
    mesh.materials.append(glowing("glow", lambda t: node(t, "Emission", {"Color": lifted(t, build(t))})))
    studio.add("sheet", mesh, matrix)
    studio.look_down(2.0)
    scene = studio.export()
    (lobe,) = scene.materials[0].lobes
    shown, got = seen(studio, scene, lobe.closure.color, rays, hits)
    return shown, got - OFFSET


def seen(studio, scene, expression, rays, hits):
    """What Cycles shows less the offset, and what `expression` gives, (3, k).

    These are at the pixels that meet a face.
    """
    image = studio.cycles().transpose(2, 0, 1)
    origin, direction = rays(scene.camera)
    index, weights, distance = hits(scene.mesh, origin, direction)
    met = index >= 0
    position = (origin + direction * np.where(met, distance, 0.0))[:, met]
    triangle = index[met]
    corner = [scene.mesh.vertices[:, scene.mesh.triangles[k, triangle]] for k in range(3)]
    ng = np.cross(corner[1] - corner[0], corner[2] - corner[0], axis=0)
    ng /= np.linalg.norm(ng, axis=0)
    points = SurfacePoints(
        SurfaceTables(scene.mesh), triangle, weights[1][met], weights[2][met], position, ng, -direction[:, met]
    )
    assert met.sum() > 200
    got = np.broadcast_to(Evaluator(points, ImageSet(scene.images))(expression), position.shape)
    return image[:, met] - OFFSET, got


@pytest.mark.usefixtures("_normal_of_unit_length")
@pytest.mark.parametrize("name", CASES)
def test_node_gives_what_cycles_shows(name, studio, rays, hits, rng):
    matrices = (BENT, MIRRORED) if "TANGENT 1" in name else (BENT,)
    for shading, matrix in itertools.product((True, False), matrices):
        shown, got = compare(studio, rays, hits, CASES[name], shading, matrix, rng)
        bpy.data.objects.remove(bpy.data.objects["sheet"])
        usual = 2e-4 if "bytes" in name or "''" in name else 5e-5  # Cycles decodes bytes of colour by a polynomial
        assert np.median(np.abs(shown - got).max(axis=0)) < usual
        # Pixels whose ray meets an edge between triangles fall to either side.
        assert np.mean(np.abs(shown - got).max(axis=0) > 20.0 * usual) < 0.02


@pytest.mark.parametrize("name", BUMPS)
def test_bump_is_the_limit_of_cycles_differences(name, studio, rays, hits, rng):
    """Cycles takes differences over the pixel's footprint.

    They are close to the slopes for heights that are smooth across it.
    """
    for shading, matrix in ((True, EVEN), (False, BENT)):
        shown, got = compare(studio, rays, hits, BUMPS[name], shading, matrix, rng)
        bpy.data.objects.remove(bpy.data.objects["sheet"])
        assert np.median(np.abs(shown - got).max(axis=0)) < (0.02 if bpy.app.version < (5, 0, 0) else 4e-3)


@pytest.mark.parametrize("space", ["OBJECT", "WORLD"])
def test_displacement_that_only_bumps(space, studio, rays, hits, rng):
    """Cycles shows the turned normal as the geometry's.

    The reference carries it in its closures.
    """

    def displaced(material):
        tree = material.node_tree
        (out,) = (n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
        inputs = {"Height": waves(tree), "Midlevel": 0.2, "Scale": 0.6}
        tree.links.new(node(tree, "Displacement", inputs, space=space), out.inputs["Displacement"])
        material.displacement_method = "BUMP"
        return material

    mesh = sheet(studio, True, rng)
    mesh.materials.append(displaced(glowing("plain", lambda t: node(t, "BsdfDiffuse"))))
    studio.add("sheet", mesh, BENT)
    studio.look_down(2.0)
    scene = studio.export()
    (lobe,) = scene.materials[0].lobes
    shine = glowing(
        "glow", lambda t: node(t, "Emission", {"Color": lifted(t, node(t, "NewGeometry", output="Normal"))})
    )
    mesh.materials[0] = displaced(shine)
    shown, got = seen(studio, scene, lobe.closure.normal, rays, hits)
    assert np.median(np.abs(got - np.array([[0.0], [0.0], [1.0]])).max(axis=0)) > 0.1
    assert np.median(np.abs(shown - got).max(axis=0)) < (0.02 if bpy.app.version < (5, 0, 0) else 4e-3)
