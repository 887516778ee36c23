# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of texture nodes and of what feeds them.

These are coordinates, mappings, images and checkers.
"""

from __future__ import annotations

import bpy

from ....lib.blender_versions import Versions
from ....lib.scene import expressions as ex
from ....lib.scene.converters import VectorMath
from ....lib.scene.pointiness import POINTINESS
from ....lib.textures.tiles import FIRST, tile_corner
from .images import MISSING, Entry
from .tree import Scope, TreeReader, valid_link

_SURFACE_COORDINATES = {
    "Generated": ex.Coordinates("GENERATED"),
    "Normal": ex.Coordinates("NORMAL"),
    "UV": ex.Coordinates("UV"),
    "Object": ex.Coordinates("OBJECT"),
}
_GEOMETRY = {
    "Position": ex.Coordinates("POSITION"),
    "Normal": ex.Coordinates("SHADING_NORMAL"),
    "True Normal": ex.Coordinates("TRUE_NORMAL"),
    "Incoming": ex.Coordinates("INCOMING"),
    "Backfacing": ex.Backfacing(),
    "Pointiness": ex.Attribute(POINTINESS, "FACTOR"),
}
_OBJECT_INFO = {"Object Index": "INDEX"}
_DIRECTION = ex.Coordinates("GENERATED")
_WORLD_COORDINATES = {"Generated": _DIRECTION, "Object": _DIRECTION}
# Under these names Cycles shows something of its own, or ends the process ("P", "generated_transform").
_CYCLES_NAMES = (
    "P",
    "N",
    "uv",
    "generated",
    "generated_transform",
    "tangent",
    "tangent_sign",
    "undisplaced_tangent",
    "undisplaced_tangent_sign",
    "vertex_color",
    "undeformed",
    "undisplaced",
    "undisplaced_N",
    POINTINESS,
    "random_per_island",
    "particle",
    "ptex_face_id",
    "ptex_uv",
)
# Of these, which mean something in volumes and hair, Cycles up to 5.2 shows 0 even where the mesh has such an attribute.
_VOLUME_NAMES = (
    "density",
    "color",
    "flame",
    "heat",
    "temperature",
    "velocity",
    "velocity_x",
    "velocity_y",
    "velocity_z",
    "shadow_transparency",
    "curve_intercept",
    "curve_length",
    "curve_random",
    "point_random",
    "radius",
)
_VOLUME_NAMES_TAKEN = Versions(None, "5.2")
# Smart is cubic in Cycles but for Open Shading Language.
_INTERPOLATIONS = {"Linear": "LINEAR", "Closest": "CLOSEST", "Cubic": "CUBIC", "Smart": "CUBIC"}
_NEUTRAL_MAPPING = {
    "translation": (0.0, 0.0, 0.0),
    "rotation": (0.0, 0.0, 0.0),
    "scale": (1.0, 1.0, 1.0),
    "mapping_x": "X",
    "mapping_y": "Y",
    "mapping_z": "Z",
}


def _coordinates(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    known = _WORLD_COORDINATES if reader.is_world else _SURFACE_COORDINATES
    if output not in known:
        reader.refuse(node, scope, f", output '{output}',", f"use {', '.join(known)}")
    elif output == "Object" and node.object is not None:
        reader.refuse(node, scope, f", object '{node.object.name}',", "clear its Object field")
    elif output in ("Generated", "UV") and node.from_instancer:
        reader.refuse(node, scope, ", option 'From Instancer',", "switch it off")
    return known.get(output, ex.BLACK)


def _uv_map(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    if reader.is_world:
        reader.refuse(node, scope, " in a world", "use Texture Coordinate, Generated")
    if node.from_instancer:
        reader.refuse(node, scope, ", option 'From Instancer',", "switch it off")
    return ex.Coordinates("UV", node.uv_map)


def _check_name(reader: TreeReader, node: bpy.types.Node, name: str, scope: Scope) -> None:
    """Refuse a name that Cycles gives a meaning of its own, whatever the mesh has under it."""
    own = name in _CYCLES_NAMES or (name in _VOLUME_NAMES and bpy.app.version in _VOLUME_NAMES_TAKEN)
    if own:
        remedy = "use the node that gives it" if name in _CYCLES_NAMES else "rename the attribute"
        reader.refuse(node, scope, f", name '{name}', which Cycles keeps for itself,", remedy)


def _vertex_color(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    if reader.is_world:
        reader.refuse(node, scope, " in a world", "unlink it")
    _check_name(reader, node, node.layer_name, scope)
    if output == "Alpha":  # here, unlike in an Attribute node, nothing has an alpha of 0
        there = ex.Attribute(node.layer_name, "PRESENCE")
        return ex.Math("MULTIPLY", ex.Attribute(node.layer_name, "ALPHA"), there, ex.ZERO)
    return ex.Attribute(node.layer_name)


def _attribute(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    if reader.is_world or node.attribute_type != "GEOMETRY":
        kind = "in a world" if reader.is_world else f"type {node.attribute_type.replace('_', ' ').title()}"
        reader.refuse(node, scope, f", {kind},", "choose the type Geometry on a surface")
    elif not node.attribute_name:
        reader.refuse(node, scope, " without a name", "name an attribute of the mesh")
    else:
        _check_name(reader, node, node.attribute_name, scope)
    return ex.Attribute(node.attribute_name, {"Fac": "FACTOR", "Alpha": "ALPHA"}.get(output, "COLOR"))


def _object_info(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    if reader.is_world:
        reader.refuse(node, scope, " in a world", "unlink it")
    if output == "Material Index":
        return ex.Constant(float(reader.pass_index))
    return ex.ObjectInfo(_OBJECT_INFO.get(output, output.upper()))


def _wireframe(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    if reader.is_world:
        reader.refuse(node, scope, " in a world", "unlink it")
    size = reader.read(node.inputs["Size"], scope)
    return ex.Wireframe(ex.Math("MULTIPLY", size, ex.PixelWidth(), ex.ZERO) if node.use_pixel_size else size)


def _geometry(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    known = {} if reader.is_world else _GEOMETRY
    if output not in known:
        reader.refuse(node, scope, f", output '{output}',", f"use {', '.join(_GEOMETRY)} of a surface")
    return known.get(output, ex.BLACK)


def _normal_map(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    if reader.is_world:
        reader.refuse(node, scope, " in a world", "unlink it")
    if getattr(node, "base", "DISPLACED") != "DISPLACED":
        reader.refuse(node, scope, ", base Original,", "choose Displaced")
    strength, color = (reader.read(node.inputs[name], scope) for name in ("Strength", "Color"))
    invert = getattr(node, "convention", "OPENGL") == "DIRECTX"
    return ex.NormalMap(color, strength, node.space, node.uv_map, invert)


def _bump(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    if reader.is_world:
        reader.refuse(node, scope, " in a world", "unlink it")
    height, strength, distance = (reader.read(node.inputs[name], scope) for name in ("Height", "Strength", "Distance"))
    normal = reader.read(node.inputs["Normal"], scope) if valid_link(node.inputs["Normal"]) else reader.surface_normal
    if not valid_link(node.inputs["Height"]):
        return normal or ex.Coordinates("SHADING_NORMAL")
    # The slope is that of the height itself; the neutral state has Cycles take a difference over a small share of a pixel.
    if "Filter Width" in node.inputs:  # since Blender 4.5
        reader.refuse_linked(node, scope, "Filter Width")
    return ex.Bump(height, strength, distance, normal, node.invert)


def _mapping(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    parts = {socket.identifier: socket for socket in node.inputs}
    kind = node.vector_type
    location = reader.read(parts["Location"], scope) if kind in ("POINT", "TEXTURE") else ex.BLACK
    return ex.Mapping(
        reader.read(parts["Vector"], scope),
        location,
        reader.read(parts["Rotation"], scope),
        reader.read(parts["Scale"], scope),
        kind=kind,
    )


def refuse_mapping(reader: TreeReader, node: bpy.types.Node, scope: Scope) -> None:
    """Old files may carry a hidden mapping inside a texture node, which Cycles applies."""
    for name, neutral in _NEUTRAL_MAPPING.items():
        value = getattr(node.texture_mapping, name)
        if (value if isinstance(neutral, str) else tuple(value)) != neutral:
            reader.refuse(node, scope, f", built-in texture mapping ({name}),", "reset it and use a Mapping node")


def _image_texture(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    refuse_mapping(reader, node, scope)
    box = node.projection == "BOX"
    if box and reader.is_world:
        reader.refuse(node, scope, ", projection Box in a world,", "choose another projection")
    key = (*scope.path, node.as_pointer())
    # Cycles divides alpha out of the colour only where the Alpha output is in use.
    alpha_linked = any(valid_link(link.to_socket) == link for link in node.outputs["Alpha"].links)
    if output == "Alpha":
        reader.alpha_read.add(key)
    missing = ex.Constant(MISSING) if output == "Color" else ex.ONE
    if reader.images.is_missing(node, reader.owner):
        return missing

    def refuse(what: str, remedy: str) -> None:
        reader.refuse(node, scope, what, remedy)

    tiled = node.image.source == "TILED"
    if tiled and node.projection != "FLAT":
        refuse(f", projection {node.projection.title()} of a tiled image,", "choose the projection Flat")
    if tiled:
        tiles = reader.images.add_tiles(node, alpha_linked, refuse)
    else:
        entry = reader.images.add(node, alpha_linked, refuse)
        if entry is None:
            return ex.BLACK if output == "Color" else ex.ZERO
        tiles = {FIRST: entry}
    if any(entry.association == "WEIGHTED" for entry in tiles.values()):
        reader.alpha_expected[key] = (node, scope)
    # A world has no UV map: Cycles shows the image at (0, 0).
    vector = reader.read_or(node.inputs[0], scope, ex.BLACK if reader.is_world else ex.Coordinates("UV"))

    def texture(entry: Entry, vector: ex.Expression) -> ex.Expression:
        return ex.ImageTexture(
            vector,
            entry.index,
            interpolation=_INTERPOLATIONS[node.interpolation],
            extension=node.extension,
            output=output.upper(),
            association=entry.association,
            projection=node.projection,
            normal=ex.Coordinates("NORMAL") if box else None,
            blend=node.projection_blend if box else 0.0,
        )

    if not tiled:
        return texture(entry, vector)
    shown = missing
    for number, entry in tiles.items():
        corner = ex.Constant((*map(float, tile_corner(number)), 0.0))
        within = VectorMath("SUBTRACT", vector, corner, ex.BLACK, ex.ONE)
        shown = ex.Tile(vector, number, texture(entry, within), shown)
    return shown


def _environment_texture(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    refuse_mapping(reader, node, scope)
    if reader.images.is_missing(node, reader.owner):
        return ex.Constant(MISSING)
    entry = reader.images.add(node, False, lambda what, remedy: reader.refuse(node, scope, what, remedy))
    if entry is None:
        return ex.BLACK
    vector = reader.read_or(node.inputs[0], scope, _DIRECTION if reader.is_world else ex.Coordinates("POSITION"))
    return ex.EnvironmentTexture(
        vector, entry.index, _INTERPOLATIONS[node.interpolation], node.projection, entry.association
    )


def _checker(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    refuse_mapping(reader, node, scope)
    return ex.Checker(
        reader.read_or(node.inputs["Vector"], scope, ex.Coordinates("GENERATED")),
        reader.read(node.inputs["Color1"], scope),
        reader.read(node.inputs["Color2"], scope),
        reader.read(node.inputs["Scale"], scope),
        output="COLOR" if output == "Color" else "FACTOR",
    )


TEXTURES = {
    "ShaderNodeTexCoord": _coordinates,
    "ShaderNodeUVMap": _uv_map,
    "ShaderNodeNewGeometry": _geometry,
    "ShaderNodeObjectInfo": _object_info,
    "ShaderNodeWireframe": _wireframe,
    "ShaderNodeNormalMap": _normal_map,
    "ShaderNodeBump": _bump,
    "ShaderNodeVertexColor": _vertex_color,
    "ShaderNodeAttribute": _attribute,
    "ShaderNodeMapping": _mapping,
    "ShaderNodeTexImage": _image_texture,
    "ShaderNodeTexEnvironment": _environment_texture,
    "ShaderNodeTexChecker": _checker,
}
"""Node type by Blender's identifier -> reader."""
