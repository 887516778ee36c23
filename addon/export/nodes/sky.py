# SPDX-License-Identifier: GPL-3.0-or-later
"""Sky Textures: a table of radiance that Blender itself renders, and the sun's disc.

A sky is given to both renderers, as an image would be, so Cycles is asked for it: once, at the directions of a
table's texels. Cycles keeps the sky of its scattering models in a table too, and the one here has its texels. Root
mean square of the error, measured at random directions, relative to the mean radiance: 3e-6 from Blender 5.0 on (2e-4
where a sun at the horizon is redder than colours can be), 2e-5 before, where a formula fades the ground out. Preetham
and Hosek/Wilkie are formulas alone: 9e-5, and 1 % at most, right at the sun. The disc is the formula of Cycles with its
two colours measured: 1e-3 at most except at the very limb.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from itertools import pairwise
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from ....lib.errors import EtalonError
from ....lib.files.ownership import temporary_folder
from ....lib.film.exr import read_exr
from ....lib.scene import expressions as ex
from ....lib.scene.images import Image
from ....lib.scene.scene import Scene
from ....lib.scene.sky import Sky, SunDisc
from ....lib.textures.images import ImageSet
from ....lib.textures.sky import limb_darkening, place_in_table, table_directions, toward
from ....lib.vectors import normalize
from ...host.quiet import quiet
from .textures import refuse_mapping
from .tree import Scope, TreeReader

_DIRECTION = ex.Coordinates("GENERATED")
_ANALYTIC = ("PREETHAM", "HOSEK_WILKIE")
_SINCE_5 = bpy.app.version >= (5, 0, 0)
# Width and height: Cycles' own table, whose lower half is new in 5.0; before, three rows to one of its own hold the fading ground.
_TABLE = (512, 256) if _SINCE_5 else (512, 768)
_ANALYTIC_TABLE = (1024, 512)
_EARTH = 6.36e6  # metres
_LEAST_SIDE = 4  # of an image that Blender renders
_SENSOR = 3.0  # mm; with it, lenses from 1 to 5000 mm see suns of all sizes down to the least
_LEAST_SUN = 0.001  # radians

Settings = tuple[tuple[str, Any], ...]


@dataclass(frozen=True)
class PendingImage(Image):
    """An image that takes a render to get; `render` gives its RGB.

    The render cannot run while the scene is exported from another one.
    """

    render: Callable[[], np.ndarray]


def read_sky(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    """Read a Sky Texture node.

    Its images are pending; `render_skies` has them rendered.
    """
    refuse_mapping(reader, node, scope)
    vector = reader.read_or(node.inputs[0], scope, _DIRECTION)  # with a sun's disc, Blender takes no Vector
    settings = _settings(node)
    if node.sky_type in _ANALYTIC:
        x, y, _ = node.sun_direction
        azimuth, shape = math.atan2(y, x), _ANALYTIC_TABLE
    else:
        elevation, azimuth = _sun_place(node.sun_elevation, node.sun_rotation)
        shape = _TABLE
    table = _pending(reader, f"{node.name}, the sky", shape, partial(_table, settings, shape, azimuth))
    if node.sky_type in _ANALYTIC or not node.sun_disc or elevation <= -_dip(node) - 0.5 * node.sun_size:
        return Sky(vector, table, azimuth)
    remedy = "switch Sun Disc off and add a sun lamp"
    if not reader.is_world:
        reader.refuse(node, scope, ", Sun Disc outside of a world,", "switch Sun Disc off")
    if elevation < 0.5 * node.sun_size:
        reader.refuse(node, scope, ", Sun Disc cut by the horizon,", remedy)
    if node.sun_size < _LEAST_SUN:
        reader.refuse(node, scope, f", Sun Size below {math.degrees(_LEAST_SUN):.2f} degrees,", remedy)
    line = partial(_centre_line, settings, shape, elevation, azimuth, node.sun_size)
    disc = _pending(reader, f"{node.name}, the sun", (1, 2), line)
    return Sky(vector, table, azimuth, SunDisc(elevation, node.sun_size, disc, covers=not _SINCE_5))


def render_skies(scene: Scene) -> Scene:
    """`scene` with the images of its skies, which Cycles renders in a scene of its own.

    Call it outside of any render. Raises EtalonError where Cycles cannot render.
    """
    return replace(scene, images=tuple(_filled(image) for image in scene.images))


def _filled(image: Image) -> Image:
    if not isinstance(image, PendingImage):
        return image
    return Image(image.name, _opaque(image.render()), image.encoding)


def _pending(reader: TreeReader, name: str, shape: tuple[int, int], render: Callable[[], np.ndarray]) -> int:
    nothing = np.broadcast_to(np.float32(np.nan), (shape[1], shape[0], 4))
    return reader.images.place(PendingImage(name, nothing, "LINEAR", render))


def _settings(node: bpy.types.Node) -> Settings:
    """All that makes a Sky Texture node what it is, whatever the version calls it."""
    common = bpy.types.ShaderNode.bl_rna.properties
    own = (p for p in node.bl_rna.properties if p.identifier not in common and not p.is_readonly)
    values = ((p.identifier, getattr(node, p.identifier)) for p in own)
    return tuple((name, value if isinstance(value, str | int | float) else tuple(value)) for name, value in values)


def _sun_place(elevation: float, rotation: float) -> tuple[float, float]:
    """The sun's elevation and azimuth, radians.

    The elevation is within +-90 degrees. The azimuth counts from +x towards +y: rotation 0 is +y, and it turns to +x.
    """
    elevation = math.remainder(elevation, 2.0 * math.pi)
    if abs(elevation) > 0.5 * math.pi:
        elevation, rotation = math.copysign(math.pi, elevation) - elevation, rotation + math.pi
    return elevation, 0.5 * math.pi - rotation


def _dip(node: bpy.types.Node) -> float:
    """How far below level the horizon is, radians, seen from the node's altitude.

    Before Blender 5.0 it is level.
    """
    return math.acos(_EARTH / (_EARTH + max(node.altitude, 0.0))) if _SINCE_5 else 0.0


@lru_cache(maxsize=4)
def _table(settings: Settings, shape: tuple[int, int], azimuth: float) -> np.ndarray:
    """The sky without its sun at the texels of a table, (height, width, 3)."""
    with _scene(shape) as (scene, node), _image(table_directions(*shape, azimuth)) as directions:
        _set(node, (*settings, ("sun_disc", False)))  # with it, the node takes no Vector
        tree = node.id_data
        window, texel = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "TexImage"))
        texel.image, texel.interpolation = directions, "Closest"
        tree.links.new(window.outputs["Window"], texel.inputs["Vector"])
        tree.links.new(texel.outputs["Color"], node.inputs[0])
        return _rendered(scene)


@lru_cache(maxsize=4)
def _centre_line(
    settings: Settings, shape: tuple[int, int], elevation: float, azimuth: float, diameter: float
) -> np.ndarray:
    """The sun's undarkened radiance at its lower and upper edge, (2, 1, 3).

    It is linear in the elevation between them.
    """
    toward_sun, up = (np.array(toward(elevation + turn, azimuth)) for turn in (0.0, 0.5 * math.pi))
    right = np.cross(toward_sun, up)
    step = math.tan(0.125 * diameter)  # half a pixel: the four in the middle are looked at
    with _scene((_LEAST_SIDE, _LEAST_SIDE)) as (scene, node):
        _set(node, settings)
        camera = scene.camera
        camera.matrix_world = Matrix(np.stack((right, up, -toward_sun), axis=1).tolist()).to_4x4()
        camera.data.sensor_width = _SENSOR
        camera.data.lens = 0.5 * _SENSOR / (_LEAST_SIDE * step)
        seen = _rendered(scene)[1:3, 1:3].reshape(4, 3).T
    y, x = (place.ravel() for place in np.mgrid[-step:step:2j, -step:step:2j])
    direction = normalize(toward_sun[:, None] + right[:, None] * x + up[:, None] * y)
    if _SINCE_5:  # before, the sun hides the sky
        sky = ImageSet((Image("", _opaque(_table(settings, shape, azimuth)), "LINEAR"),))
        seen = seen - sky.sample(0, *place_in_table(direction, azimuth), extension="EXTEND")[:3]
    share = np.arctan(np.hypot(x, y)) / (0.5 * diameter)
    low, high = (seen / limb_darkening(share)).reshape(3, 2, 2).mean(axis=2).T
    rise = (np.arcsin(direction[2]) - elevation).reshape(2, 2).mean(axis=1)
    slope = (high - low) / (rise[1] - rise[0])
    return np.stack([low + slope * (edge - rise[0]) for edge in (-0.5 * diameter, 0.5 * diameter)])[:, None]


def _set(node: bpy.types.Node, settings: Settings) -> None:
    for name, value in settings:
        setattr(node, name, value)


def _rendered(scene: bpy.types.Scene) -> np.ndarray:
    """Render the image that Cycles shows, (height, width, 3), row 0 at the bottom.

    Raises EtalonError where Cycles cannot render it.
    """
    with temporary_folder() as folder:
        path = folder / "sky.exr"
        scene.render.filepath = str(path)
        with quiet():
            try:
                bpy.ops.render.render(write_still=True, scene=scene.name)
            except RuntimeError as error:
                reason = str(error).strip().splitlines()[-1].removeprefix("Error: ")
                raise EtalonError(f"Sky Texture: Cycles cannot render it ({reason}); try F12 in Blender") from error
        channels = read_exr(path)
    return np.stack([channels[c] for c in "RGB"], axis=2)[::-1]


@contextmanager
def _scene(size: tuple[int, int]) -> Iterator[tuple[bpy.types.Scene, bpy.types.Node]]:
    """Yield a scene of a camera and a world that is a Sky Texture node, and the node.

    Both are removed afterwards. One sample goes through each pixel's centre; the rest of a new scene's settings are
    neutral as they come.
    """
    data, name = bpy.data, "etalon sky"
    made: list[bpy.types.ID] = []
    try:
        made.append(scene := data.scenes.new(name))
        made.append(lens := data.cameras.new(name))
        made.append(camera := data.objects.new(name, lens))
        made.append(world := data.worlds.new(name))
        scene.collection.objects.link(camera)
        scene.camera, scene.world = camera, world
        world.cycles.sampling_method = "NONE"  # spares the map of where light is
        cycles, render = scene.cycles, scene.render
        render.engine = "CYCLES"
        cycles.device, cycles.samples, cycles.pixel_filter_type = "CPU", 1, "BOX"
        cycles.use_adaptive_sampling = cycles.use_denoising = False
        render.resolution_x, render.resolution_y = size
        render.resolution_percentage = 100
        if hasattr(render.image_settings, "media_type"):
            render.image_settings.media_type = "IMAGE"
        render.image_settings.file_format, render.image_settings.color_mode = "OPEN_EXR", "RGB"
        render.image_settings.color_depth = "32"
        if not _SINCE_5:
            world.use_nodes = True
        tree = world.node_tree
        tree.nodes.clear()
        chain = [tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexSky", "Background", "OutputWorld")]
        for source, sink in pairwise(chain):
            tree.links.new(source.outputs[0], sink.inputs[0])
        yield scene, chain[0]
    finally:
        data.batch_remove(made)


@contextmanager
def _image(texels: np.ndarray) -> Iterator[bpy.types.Image]:
    """An image of floats (height, width, 3), row 0 at the bottom, which is removed afterwards."""
    height, width = texels.shape[:2]
    image = bpy.data.images.new("etalon sky", width, height, float_buffer=True, is_data=True)
    try:
        image.alpha_mode = "NONE"
        image.pixels.foreach_set(_opaque(texels).ravel())
        yield image
    finally:
        bpy.data.images.remove(image)


def _opaque(pixels: np.ndarray) -> np.ndarray:
    """RGB (height, width, 3) with an alpha of 1, float32."""
    return np.dstack((pixels, np.ones(pixels.shape[:2]))).astype(np.float32)
