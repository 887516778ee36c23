# SPDX-License-Identifier: GPL-3.0-or-later
"""Float images on disk: OpenEXR, 32 bits per channel, with channels of any name."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO

from ..errors import EtalonError
from ..files.atomic import replace_file
from .film import Film

# Rows of an image in one piece: a multiple of what OpenEXR compresses together.
_ROWS = 64
_REMEDY = "make room or name another folder"
# Primaries and white of Rec. 709 (ITU-R BT.709-6, item 1.3), as OpenEXR orders them: red, green, blue, white, each x and y.
REC709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)


@dataclass(frozen=True)
class Meaning:
    """What the numbers of an image file are, which the file says in its attributes.

    `unit` is that of the channels, `comment` a sentence for people, `colour` the identifier of the colour space (Color Interop Forum), or
    'data' for numbers that are no colours. `chromaticities` are written for colours alone.
    """

    unit: str
    comment: str
    colour: str


RADIANCE = Meaning(
    "W m^-2 sr^-1",
    "R, G, B: radiance, scene-linear Rec. 709, in W m^-2 sr^-1 as Blender counts it. error.R, error.G, error.B: its standard error, "
    "in the same unit. samples: finite samples of each pixel.",
    "lin_rec709_scene",
)
DIFFERENCE = Meaning(
    "1", "R, G, B: (Cycles - reference) / reference, without unit; NaN where pixels are not compared.", "data"
)


def write_exr(path: Path | str, channels: dict[str, np.ndarray], meaning: Meaning) -> None:
    """Write `channels`, name -> (height, width) array, to an OpenEXR file as float32.

    A reader finds them under the same names.

    The attributes of the file say what the numbers are.

    "R", "G", "B" make the picture that viewers show; "error.R" is channel R of a layer "error". The file is written
    beside its place and renamed. Raises EtalonError where it cannot be written, ValueError where the arrays differ in
    shape.
    """
    shapes = {np.shape(channel) for channel in channels.values()}
    if len(shapes) != 1:
        raise ValueError(f"{path}: channels of different shapes")
    shape = shapes.pop()
    _write(Path(path), list(channels), shape, meaning, lambda part: [channel[part] for channel in channels.values()])


def write_film(path: Path | str, film: Film) -> None:
    """Write a film's radiance, its standard error and the finite samples of each pixel.

    The channels are R, G, B; error.R ...; and samples.

    Pixels with non-finite samples are NaN; the standard error is NaN everywhere after a single replicate.
    """

    def channels(rows: slice) -> list[np.ndarray]:
        moments = film.moments.part(rows)
        error, finite = moments.standard_error, moments.n * film.samples - film.nonfinite[rows]
        return [*np.moveaxis(moments.mean, 2, 0), *np.moveaxis(error, 2, 0), finite]

    _write(Path(path), [*"RGB", *(f"error.{name}" for name in "RGB"), "samples"], film.shape, RADIANCE, channels)


def _write(
    path: Path,
    names: list[str],
    shape: tuple[int, int],
    meaning: Meaning,
    channels: Callable[[slice], list[np.ndarray]],
) -> None:
    """Write what `channels` gives for the rows that it is asked for, a few at a time."""
    height, width = shape
    spec = OpenImageIO.ImageSpec(width, height, len(names), "float")
    spec.channelnames = names
    spec.attribute("compression", "zip")
    _describe(spec, meaning)
    with replace_file(path) as beside:
        file = OpenImageIO.ImageOutput.create(str(beside))
        good = file is not None and file.open(str(beside), spec)
        written = 0
        for start in range(0, height if good else 0, _ROWS):
            end = min(start + _ROWS, height)
            pixels = np.stack(channels(slice(start, end)), axis=2, dtype=np.float32, casting="same_kind")
            written = zlib.crc32(pixels, written)
            good = good and file is not None and file.write_scanlines(start, end, 0, pixels)
        if not (good and file is not None and file.close()):
            raise _failure(path, file, "cannot be written", _REMEDY)
        if _checksum(beside, names) != written:
            raise EtalonError(f"{path}: cannot be written (it does not read back as written); {_REMEDY}")


def _checksum(beside: Path, names: list[str]) -> int:
    """Return the CRC-32 of the channels in a file.

    OpenImageIO reports that they are written also where the disk is full.
    """
    found, file = 0, OpenImageIO.ImageInput.open(str(beside))
    if file is None:
        OpenImageIO.geterror()  # which it would print at the end of the process
    else:
        spec = file.spec()
        order = [spec.channelnames.index(name) for name in names]  # the file has its own order
        for start in range(0, spec.height, _ROWS):
            pixels = file.read_scanlines(0, 0, start, min(start + _ROWS, spec.height), 0, 0, spec.nchannels, "float")
            found = zlib.crc32(b"" if pixels is None else np.ascontiguousarray(pixels[..., order]), found)
        file.close()
    return found


def _describe(spec: OpenImageIO.ImageSpec, meaning: Meaning) -> None:
    """Set the attributes that say unit and colour space.

    OpenEXR calls ImageDescription "comments".
    """
    spec.attribute("ImageDescription", meaning.comment)
    spec.attribute("unit", meaning.unit)
    spec.attribute("colorInteropID", meaning.colour)
    if meaning.colour != "data":
        spec.attribute("chromaticities", OpenImageIO.TypeDesc("float[8]"), REC709)


def read_exr(path: Path | str) -> dict[str, np.ndarray]:
    """Read the channels of an image file, name -> (height, width) float32 array.

    Row 0 is on top. Raises EtalonError where the file cannot be read.

    The channels of all its parts, where the file has several.
    """
    file = OpenImageIO.ImageInput.open(str(path))
    if file is None:
        raise _failure(path, file, "cannot be read", "check the path, or write it again")
    channels: dict[str, np.ndarray] = {}
    try:
        part = 0
        while file.seek_subimage(part, 0):
            names = file.spec().channelnames
            pixels = file.read_image(part, 0, 0, len(names), "float")
            if pixels is None:
                raise _failure(path, file, "cannot be read", "write it again")
            channels |= {name: pixels[..., i] for i, name in enumerate(names)}
            part += 1
    finally:
        file.close()
    return channels


def _failure(path: Path | str, file: Any, what: str, remedy: str) -> EtalonError:
    reason = (file.geterror() if file is not None else OpenImageIO.geterror()).strip().splitlines()
    if file is not None:
        file.close()  # Windows removes no open file
    return EtalonError(f"{path}: {what} ({reason[0] if reason else 'no reason given'}); {remedy}")
