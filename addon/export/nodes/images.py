# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's images as lib.scene.images, each once.

They are read so that their texels are those that Cycles sees.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, replace

import bpy
import numpy as np

from ....lib.blender_versions import Versions
from ....lib.errors import Refusal
from ....lib.scene.images import Image
from ....lib.srgb import srgb_encode
from ....lib.textures.linearize import linearize
from ...host.color_configuration import color_configuration
from ..properties.declared import refuse_undeclared
from .image_files import Still, frame_of_user, numbered_path, path_of_image, read_still, tile_path

_ENCODINGS = {"sRGB": "SRGB", "Linear Rec.709": "LINEAR", "Non-Color": "DATA"}
# Before, Cycles divides the colours of other spaces by alpha even where the two are said to have nothing to do with each other.
_PACKED_IN_ANY_SPACE = Versions("5.0")
# Cycles then multiplies bytes by alpha and floats not, whatever the mode: right for images that Blender keeps and for PNG and OpenEXR
# files with the mode that belongs to the format.
_MODE_IGNORED = Versions(None, "5.0")
# Of floats in these, Blender and Cycles make values of twice and of once the size.
_SCALED = ("Rec.2100-PQ", "Rec.2100-HLG")
_GREY = 1e-4
_SOURCES = ("FILE", "GENERATED", "MOVIE")
_DECODES_MOVIES = bpy.app.ffmpeg.supported
_PREMULTIPLIED_FORMATS = ("OPEN_EXR", "OPEN_EXR_MULTILAYER")
_TYPES = ("IMAGE", "UV_TEST")

OCCLUSION_DISTANCE = 10.0
"""The distance of ambient occlusion without a world, in metres."""

MISSING = (1.0, 0.0, 1.0)
"""What Cycles shows of an image that it cannot read, whatever its colour space; its alpha is 1."""

Refuse = Callable[[str, str], None]


@dataclass(frozen=True)
class Entry:
    """An image in the table, and how its colour relates to its alpha.

    The latter is the `association` of an ImageTexture.
    """

    index: int
    association: str


class ImageTable:
    """Collects the images that materials and world use, and gives each an index.

    It also has what else of the scene node trees depend on.
    """

    def __init__(self, frame: int = 1, occlusion_distance: float = OCCLUSION_DISTANCE) -> None:
        """`frame`: the scene's, which chooses among the files of a sequence and the frames of a movie.

        `occlusion_distance`: the world's distance of ambient occlusion, for which nodes have a 0.
        """
        self._frame = frame
        self.occlusion_distance = occlusion_distance
        self._entries: dict[tuple[int, bool, Still | None], Entry | None] = {}
        self._lacking: dict[tuple[int, Still], bool] = {}
        self._images: list[Image] = []
        self.missing: dict[str, None] = {}
        """What has no image, in the order in which it was met: the files that are not there, and nodes without an image."""

    @property
    def images(self) -> tuple[Image, ...]:
        """All images so far, in the order of their indices."""
        return tuple(self._images)

    def is_missing(self, node: bpy.types.Node, owner: str) -> bool:
        """Whether an image node has no image that can be read.

        Cycles then shows MISSING. What is missing is noted. A file in a colour space that is not read may be missing
        too: what Cycles shows then depends on the release.
        """
        image = node.image
        if image is None:
            self.missing[f"{owner}: node '{node.name}' has no image"] = None
            return True
        image = image.original
        still = self._still(image, node)
        if still is not None:
            return self._lacks(image, still)
        if image.source != "FILE" or image.type not in _TYPES or (image.size[0] and image.size[1]):
            return False
        space = image.colorspace_settings.name  # empty where Blender has never read the file
        if bpy.app.version < (5, 0, 0) and space and space not in _ENCODINGS:
            return False
        self._note(image, path_of_image(image))
        return True

    def add(self, node: bpy.types.Node, alpha_linked: bool, refuse: Refuse) -> Entry | None:
        """The entry of a node's image, read at its first use.

        None where it is refused, by `refuse(what, remedy)`. `alpha_linked` says whether the node's alpha is in use.
        The image must not be one that `is_missing`.
        """
        image = node.image.original
        return self._entry(image, self._still(image, node), alpha_linked, refuse)

    def add_tiles(self, node: bpy.types.Node, alpha_linked: bool, refuse: Refuse) -> dict[int, Entry]:
        """The entries of a tiled image by number of tile.

        Tiles whose file cannot be read are left out, since Cycles shows MISSING there. Tiles that are refused have no
        entry.
        """
        image = node.image.original
        fault = _fault_of_tiles(image)
        if fault:
            refuse(f", image '{image.name}' (tiled, {fault[0]}),", fault[1])
            return {}
        files = {tile.number: Still(tile_path(path_of_image(image), tile.number)) for tile in image.tiles}
        there = {number: still for number, still in files.items() if not self._lacks(image, still)}
        entries = {number: self._entry(image, still, alpha_linked, refuse) for number, still in there.items()}
        return {number: entry for number, entry in entries.items() if entry is not None}

    def _entry(self, image: bpy.types.Image, still: Still | None, alpha_linked: bool, refuse: Refuse) -> Entry | None:
        """The entry of `image`, or of the one file or frame of it that `still` says."""
        key = (image.session_uid, alpha_linked, still)
        if key not in self._entries:
            if still is None:
                self._entries[key] = self._read(image, image, alpha_linked, refuse)
            else:
                with read_still(still, image) as read:
                    self._entries[key] = self._read(read, image, alpha_linked, refuse)
        return self._entries[key]

    def _still(self, image: bpy.types.Image, node: bpy.types.Node) -> Still | None:
        """The file or frame that a sequence or movie shows in `node`; None for other images, and movies that are refused."""
        is_read = image.source == "SEQUENCE" or (image.source == "MOVIE" and _DECODES_MOVIES)
        if image.packed_file is not None or not is_read:
            return None
        frame, path = frame_of_user(node.image_user, self._frame), path_of_image(image)
        return Still(path, frame) if image.source == "MOVIE" else Still(numbered_path(path, frame))

    def _lacks(self, image: bpy.types.Image, still: Still) -> bool:
        """Whether one file or frame of `image` cannot be read, which is noted."""
        key = (image.session_uid, still)
        if key not in self._lacking:
            with read_still(still, image) as read:
                self._lacking[key] = read is None
        if self._lacking[key]:
            self._note(image, still.path)
        return self._lacking[key]

    def _note(self, image: bpy.types.Image, path: str) -> None:
        fault = "cannot be read" if os.path.isfile(path) else "is not there"
        self.missing[f"image '{image.name}': file '{path}' {fault}"] = None

    def _read(self, image: bpy.types.Image, owner: bpy.types.Image, alpha_linked: bool, refuse: Refuse) -> Entry | None:
        """The entry of `image`, which is `owner`, one of its files or one of its frames."""
        name = owner.name
        reason = _unsupported(image)
        if reason:
            refuse(f", image '{name}' ({reason[0]}),", reason[1])
            return None
        changed: list[Refusal] = []
        refuse_undeclared("", "image", owner, changed)
        for refusal in changed:
            refuse(f", image '{name}', {refusal.what},", refusal.remedy)
        if changed:
            return None
        pixels = _load(image)
        if not np.isfinite(pixels).all():
            refuse(f", image '{name}' (texels that are not finite),", "repair the image")
            return None
        space = image.colorspace_settings
        if not space.is_data and np.any(pixels[..., 3] != 1.0):
            fault = _fault_of_alpha(image)
            if fault:
                refuse(f", image '{name}' ({fault[0]}),", fault[1])
                return None
            if _holds_multiplied_codes(image):
                pixels = _codes(image)
        encoding = "DATA" if space.is_data else _ENCODINGS.get(space.name, "LINEAR")
        if space.name not in _ENCODINGS and not space.is_data:
            linear = pixels if image.is_float else linearize(pixels, space.name, color_configuration())
            fault = _fault_of_space(image, pixels, linear)
            if fault:
                refuse(f", image '{name}' (colour space {space.name}, {fault[0]}),", fault[1])
                return None
            pixels = linear
        # Blender decodes floats as it loads them. Cycles takes generated and packed images and movies from Blender, others from the file.
        codes_lost = image.is_float and encoding == "SRGB"
        if codes_lost and _is_kept(image):
            encoding, codes_lost = "LINEAR", False

        texels, association = _associate(Image(name, pixels, encoding), image, codes_lost, alpha_linked)
        return Entry(self.place(texels), association)

    def place(self, image: Image) -> int:
        """The image's index, that of an equal one where there is one."""
        for index, other in enumerate(self._images):
            if (
                other.name == image.name
                and (other.encoding, other.multiplied) == (image.encoding, image.multiplied)
                and np.array_equal(other.pixels, image.pixels)
            ):
                return index
        self._images.append(image)
        return len(self._images) - 1


def _fault_of_tiles(image: bpy.types.Image) -> tuple[str, str] | None:
    """(what, remedy) where the files of a tiled image are not what Cycles reads."""
    if image.packed_file is not None:
        return "packed", "unpack it"
    if image.is_dirty or not image.filepath:
        return "not saved", "save it: Cycles reads the files"
    if tile_path(image.filepath, image.tiles[0].number) is None:
        return f"path '{image.filepath}'", "write <UDIM> or <UVTILE> where its number stands"
    return None


def _unsupported(image: bpy.types.Image) -> tuple[str, str] | None:
    """(what, remedy) where the image is of a kind that is not simulated."""
    if image.source not in _SOURCES or image.type not in _TYPES:
        kind = image.source if image.source not in _SOURCES else image.type
        return f"{kind.lower().replace('_', ' ')}", "use a still image or a sequence of image files"
    if image.source == "MOVIE" and not _DECODES_MOVIES:
        return "movie, in a Blender without FFmpeg", "use a sequence of image files"
    if not image.size[0] or not image.size[1]:  # the colour space is known only once it is loaded
        return "no texels", "restore its file, or choose another image"
    if image.is_dirty and image.source == "FILE" and image.packed_file is None:
        return "changes that are not saved", "save or pack the image: Cycles reads the file"
    return None


def _fault_of_space(image: bpy.types.Image, codes: np.ndarray, linear: np.ndarray) -> tuple[str, str] | None:
    """(what, remedy) where Cycles and its definition disagree on the image's colour space.

    `codes` are the texels as stored, `linear` the same decoded. None where the two agree.
    """
    packed = image.alpha_mode == "CHANNEL_PACKED" and np.any(codes[..., 3] != 1.0)
    if packed and bpy.app.version not in _PACKED_IN_ANY_SPACE:
        return "alpha Channel Packed", "set its Alpha to None"
    if image.is_float and image.colorspace_settings.name in _SCALED:
        return "of floats", f"convert it to {' or '.join(_ENCODINGS)}"
    if not np.isfinite(linear).all():
        return "colours beyond its range", f"convert it to {' or '.join(_ENCODINGS)}"
    grey = not image.is_float and np.all(np.ptp(codes[..., :3], axis=2) == 0.0)
    if grey and np.any(np.ptp(linear[..., :3], axis=2) > _GREY):  # of greys, Cycles keeps one channel
        return "tinted greys", f"convert it to {' or '.join(_ENCODINGS)}"
    return None


def _load(image: bpy.types.Image) -> np.ndarray:
    """Texels (height, width, 4) float32, row 0 at the bottom, as Blender holds them."""
    width, height = image.size
    channels = image.channels
    flat = np.empty(width * height * channels, np.float32)
    image.pixels.foreach_get(flat)
    stored = flat.reshape(height, width, channels)
    if channels == 4:
        return stored
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = stored[..., :3] if channels == 3 else stored[..., :1]
    if channels == 2:
        pixels[..., 3] = stored[..., 1]
    return pixels


def _fault_of_alpha(image: bpy.types.Image) -> tuple[str, str] | None:
    """(what, remedy) where Cycles does not follow the image's alpha mode, or is not known to."""
    mode = image.alpha_mode
    if _is_kept(image):
        natural = "PREMUL" if image.is_float else "STRAIGHT"
        follows = bpy.app.version in _MODE_IGNORED
        fault = f"alpha {mode.title()} of an image that Blender keeps, whose texels follow the mode already when Cycles applies it"
    else:
        natural = "PREMUL" if image.file_format in _PREMULTIPLIED_FORMATS else "STRAIGHT"
        follows = bpy.app.version not in _MODE_IGNORED
        fault = f"alpha {mode.title()}, which Cycles before 5.1 takes for {natural.title()}"
    remedy = f"set its Alpha to {natural.title()}, Channel Packed or None"
    if mode not in ("NONE", "CHANNEL_PACKED", natural) and not follows:
        return fault, remedy
    if _holds_multiplied_codes(image) and image.colorspace_settings.name not in _ENCODINGS:
        return f"alpha {mode.title()} in the colour space {image.colorspace_settings.name}", remedy
    return None


def _is_kept(image: bpy.types.Image) -> bool:
    """Whether Cycles takes the texels from Blender, and not from a file."""
    return image.source in ("GENERATED", "MOVIE") or image.packed_file is not None


def _holds_multiplied_codes(image: bpy.types.Image) -> bool:
    """Whether Cycles reads bytes that have alpha multiplied in."""
    return image.alpha_mode == "PREMUL" and not image.is_float and not _is_kept(image)


def _codes(image: bpy.types.Image) -> np.ndarray:
    """The texels of the image's file as they are stored.

    Blender divides bytes by an alpha that is multiplied in, and rounds.
    """
    plain = image.copy()
    try:
        plain.alpha_mode = "CHANNEL_PACKED"
        return _load(plain)
    finally:
        bpy.data.images.remove(plain)


def _associate(image: Image, settings: bpy.types.Image, codes_lost: bool, alpha_linked: bool) -> tuple[Image, str]:
    """The image with what its alpha mode means applied, and the association.

    Blender holds bytes with straight alpha and floats with alpha multiplied in, whatever the file. Cycles multiplies
    alpha in, and divides it out again after interpolation where it is in use.
    """
    pixels, mode = image.pixels, settings.alpha_mode
    if mode == "NONE":
        pixels[..., 3] = 1.0
    color, alpha = pixels[..., :3], pixels[..., 3:]
    divisor = np.where(alpha == 0, np.float32(1.0), alpha)
    separate = mode in ("NONE", "CHANNEL_PACKED") or image.encoding == "DATA" or np.all(alpha == 1.0)
    multiplied = not separate and (settings.is_float or _holds_multiplied_codes(settings))
    if codes_lost:
        color[:] = divisor * srgb_encode(color / divisor) if multiplied else srgb_encode(color)
    if separate or (multiplied and image.encoding == "LINEAR" and not alpha_linked):
        return image, "SEPARATE"
    return replace(image, multiplied=multiplied), "WEIGHTED" if alpha_linked else "MULTIPLIED"
