# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials and worlds: from Blender's node trees to lobes and radiance."""

from __future__ import annotations

from typing import NamedTuple

import bpy

from ...lib.blender_versions import Versions
from ...lib.effects.facts import adds_nothing
from ...lib.effects.masks import flags_in
from ...lib.errors import Refusal
from ...lib.scene import expressions as ex
from ...lib.scene.layers import BeneathLayer
from ...lib.scene.materials import Diffuse, Displacement, Emission, Material, Specular, Transparent, WeightedClosure
from ...lib.scene.rays import COUNTS, COUNTS_OF_ALL_RAYS, COUNTS_OF_EMISSION, RAY_NAMES, SEEN, STEADY_FLAGS
from ...lib.scene.sky import Sky
from ...lib.scene.volumes import Volume
from ...lib.scene.world import World
from ...lib.textures.fold import Folder, inputs, is_constant, walk
from ...lib.wavefront.refuse import misused_rays
from .nodes.displacement import read_bump, read_displacement, refuse_beside_bump
from .nodes.images import OCCLUSION_DISTANCE, ImageTable
from .nodes.shaders import make_shader_reader, make_volume_reader
from .nodes.tree import Scope, TreeReader, valid_link
from .nodes.values import VALUES
from .nodes.volumes import read_volume
from .properties.declared import refuse_undeclared

_GREY = Diffuse(ex.Constant((0.8, 0.8, 0.8)))
_INDEX, _HALF = ex.Constant(1.5), ex.Constant(0.5)
DEFAULT_MATERIAL = (
    Material(
        "",
        (
            WeightedClosure(Specular("MULTI_GGX", _INDEX, ex.WHITE, _HALF)),
            WeightedClosure(_GREY, BeneathLayer(_INDEX, ex.WHITE, _HALF, ex.ONE, "MULTI_GGX")),
        ),
    )
    if bpy.app.version >= (5, 0, 0)
    else Material("", (WeightedClosure(_GREY),))
)
"""What Cycles shows where a face has no material: grey, and from Blender 5.0 on a Principled BSDF as it comes."""

# Before, Cycles bumps the displaced normal of flat faces (4.5), or the smooth one (5.0).
_BUMPS_ON_UNDISPLACED = Versions("5.2")

_NO_TABLE = (16, 8)
_LEAST_TABLE = (256, 128)
_LARGEST_TABLE = (4096, 2048)


def read_material(material: bpy.types.Material, images: ImageTable, refusals: list[Refusal]) -> Material:
    """Read the material as lobes.

    What is not simulated is appended to `refusals`, and images are added to `images`.
    """
    if not _uses_nodes(material):
        r, g, b, _ = material.diffuse_color
        return Material(material.name, (WeightedClosure(Diffuse(ex.Constant((r, g, b)))),))
    owner = f"material '{material.name}'"
    refuse_undeclared(owner, "material", material, refusals)
    refuse_undeclared(owner, "material.cycles", material.cycles, refusals)
    read = _read_tree(
        material.node_tree, owner, False, images, refusals, material.displacement_method, material.pass_index
    )
    lobes, volume = read.lobes, read.volume
    flags = set().union(*(flags_in(lobe) for lobe in lobes if isinstance(lobe.closure, Emission)))
    _refuse_flags(owner, flags - {*COUNTS_OF_EMISSION}, "its emission", refusals)
    clear = set().union(*(flags_in(lobe) for lobe in lobes if isinstance(lobe.closure, Transparent)))
    _refuse_flags(owner, (clear & {*COUNTS}) - {*COUNTS_OF_ALL_RAYS}, "what lets light straight through", refusals)
    misused = misused_rays(lobe for lobe in lobes if not adds_nothing(lobe))
    refusals.extend(Refusal(owner, *one) for one in dict.fromkeys(misused))
    return Material(
        material.name,
        tuple(lobes),
        # Cycles takes no notice of the switch beside a volume (scene/shader.cpp).
        transparent_shadows=material.use_transparent_shadow or volume is not None,
        volume=volume,
        only_bounds=volume is not None and not read.has_surface,
        displacement=read.displacement,
    )


def read_world(world: bpy.types.World | None, images: ImageTable, refusals: list[Refusal]) -> World:
    """Read the world's radiance as an expression of direction; black without a world.

    `images` and `refusals` are as for read_material.
    """
    if world is None:
        return World(ex.BLACK, _NO_TABLE)
    owner = f"world '{world.name}'"
    refuse_undeclared(owner, "world", world, refusals)
    refuse_undeclared(owner, "world.cycles", world.cycles, refusals)
    refuse_undeclared(owner, "world.cycles_visibility", world.cycles_visibility, refusals)
    rays = sum(bit for name, bit in RAY_NAMES.items() if bit & SEEN and getattr(world.cycles_visibility, name))
    if not _uses_nodes(world):
        r, g, b = world.color
        return World(ex.Constant((r, g, b)), _NO_TABLE, rays)
    folder = Folder()
    radiance = ex.BLACK
    read = _read_tree(world.node_tree, owner, True, images, refusals)
    for lobe in read.lobes:
        assert isinstance(lobe.closure, Emission)
        strength = ex.ValueToColor(ex.Math("MULTIPLY", lobe.weight, lobe.closure.strength, ex.ZERO))
        glow = ex.Mix(ex.ONE, lobe.closure.color, strength, blend="MULTIPLY")
        radiance = glow if radiance is ex.BLACK else ex.Mix(ex.ONE, radiance, glow, blend="ADD")
    radiance = folder(radiance)
    if not all(isinstance(leaf, ex.Constant | ex.RayFlag) for leaf in walk(radiance) if not inputs(leaf)):
        _refuse_flags(owner, flags_in(World(radiance)), "a world that depends on the direction", refusals)
    return World(radiance, _table_resolution(radiance, images), rays, read.volume)


def read_occlusion_distance(world: bpy.types.World | None) -> float:
    """The distance in metres that an Ambient Occlusion node's Distance of 0 stands for, whether or not the world is seen."""
    return OCCLUSION_DISTANCE if world is None else world.light_settings.distance


def _refuse_flags(owner: str, flags: set[str], where: str, refusals: list[Refusal]) -> None:
    """Append the kinds of rays that light may not depend on.

    Cycles' light samples have no such kind, so that its image depends on how it samples.
    """
    for flag in sorted(flags - set(STEADY_FLAGS)):
        output = flag.replace("_", " ").title() if flag in COUNTS else f"Is {flag.title()} Ray"
        what = f"'{output}' of a Light Path node in {where}"
        refusals.append(Refusal(owner, what, "use Is Camera Ray or ray visibility"))


def _uses_nodes(owner: bpy.types.Material | bpy.types.World) -> bool:
    """Whether the node tree counts; from Blender 5.0 on it always does where there is one."""
    return owner.node_tree is not None and (bpy.app.version >= (5, 0, 0) or owner.use_nodes)


class _Tree(NamedTuple):
    """The lobes of a surface or world, and its volume and displacement if linked.

    It also says whether there is any lobe that Cycles would keep.
    """

    lobes: list[WeightedClosure]
    has_surface: bool
    volume: Volume | None
    displacement: Displacement | None = None


def _read_tree(
    tree: bpy.types.NodeTree,
    owner: str,
    is_world: bool,
    images: ImageTable,
    refusals: list[Refusal],
    method: str = "",
    pass_index: int = 0,
) -> _Tree:
    output = tree.get_output_node("CYCLES")
    if output is None:
        return _Tree([], False, None)
    scope = Scope()
    values = TreeReader(owner, is_world, images, refusals, VALUES, pass_index)
    values.check(output, scope)
    surface, displacement = output.inputs["Surface"], output.inputs.get("Displacement")
    moved = None
    if displacement is not None and valid_link(displacement):
        values.surface_normal, moved = _read_displacement(values, displacement, scope, method)
    lobes = make_shader_reader(values).lobes(surface, scope)
    volume = read_volume(make_volume_reader(values), output.inputs["Volume"], scope)
    if values.surface_normal is not None:
        refusals.extend(refuse_beside_bump(owner, lobes))
    for key, (node, where) in values.alpha_expected.items():
        if key not in values.alpha_read:
            values.refuse(node, where, ", output 'Alpha', whose links lead nowhere,", "unlink Alpha")
    # Cycles drops emission that gives no light, and takes what is left of the surface for unlinked.
    dark = bool(lobes) and all(isinstance(lobe.closure, Emission) and adds_nothing(lobe) for lobe in lobes)
    return _Tree(lobes, values.trace(surface, scope).linked and not dark, volume, moved)


def _read_displacement(
    values: TreeReader, socket: bpy.types.NodeSocket, scope: Scope, method: str
) -> tuple[ex.Expression | None, Displacement | None]:
    """Read what a linked displacement does to the shading normal, and to vertices."""
    refused, source = len(values.refusals), values.trace(socket, scope)
    if source.linked and source.socket.node.bl_idname == "ShaderNodeDisplacement":
        values.refuse_linked(source.socket.node, source.scope, "Normal")
    bump = moved = None
    if method == "BOTH" and bpy.app.version not in _BUMPS_ON_UNDISPLACED:
        what, remedy = "Displacement and Bump, before Blender 5.2", "choose Displacement Only or Bump Only"
        values.refusals.append(Refusal(values.owner, what, remedy))
    if method != "DISPLACEMENT":
        bump = read_bump(values, socket, scope)
    if method != "BUMP":
        moved = read_displacement(values, socket, scope, bumps=method == "BOTH")
    if bump is None and moved is None and len(values.refusals) == refused:
        what = f"displacement (node '{socket.node.name}', socket 'Displacement')"
        values.refusals.append(Refusal(values.owner, what, "unlink Displacement, or link a Displacement node"))
    if bump is not None:
        bump = ex.SurfaceNormal(ex.Undisplaced(bump) if method == "BOTH" else bump)
    return bump, moved


def _table_resolution(radiance: ex.Expression, images: ImageTable) -> tuple[int, int]:
    """The size of the largest image in the radiance, within bounds.

    The table only steers where samples go.
    """
    if is_constant(radiance):
        return _NO_TABLE
    indices = [n.image for n in walk(radiance) if isinstance(n, ex.EnvironmentTexture | ex.ImageTexture | Sky)]
    sizes = [images.images[index].pixels.shape[:2] for index in indices]
    width = max([_LEAST_TABLE[0], *(w for _, w in sizes)])
    height = max([_LEAST_TABLE[1], *(h for h, _ in sizes)])
    return min(width, _LARGEST_TABLE[0]), min(height, _LARGEST_TABLE[1])
