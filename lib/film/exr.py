# SPDX-License-Identifier: GPL-3.0-or-later
"""Float images on disk: OpenEXR, 32 bits per channel, with channels of any name."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import OpenImageIO

from ..errors import EtalonError
from .film import Film


def write_exr(path: Path | str, channels: dict[str, np.ndarray]) -> None:
    """Write `channels`, name -> (height, width) array, as float32; a reader finds them under the same names.

    "R", "G", "B" make the picture that viewers show; "error.R" is channel R of a layer "error". The file is written beside its
    place and renamed. Raises EtalonError where it cannot be written, ValueError where the arrays differ in shape.
    """
    path = Path(path)
    names = list(channels)
    if len({np.shape(channel) for channel in channels.values()}) != 1:
        raise ValueError(f"{path}: channels of different shapes")
    height, width = np.shape(channels[names[0]])
    count = len(names)
    pixels = np.empty((height, width, count), np.float32)
    for k, name in enumerate(names):
        pixels[..., k] = channels[name]
    spec = OpenImageIO.ImageSpec(width, height, count, "float")
    spec.channelnames = names
    spec.attribute("compression", "zip")
    beside = path.with_name(f".unfinished-{os.getpid()}-{path.name}")
    try:
        file = OpenImageIO.ImageOutput.create(str(beside))
        good = file is not None and file.open(str(beside), spec) and file.write_image(pixels) and file.close()
        if not good:
            raise _failure(path, file, "cannot be written", "make room or name another folder")
        os.replace(beside, path)
    except OSError as error:
        raise EtalonError(f"{path}: cannot be written ({error.strerror}); name another folder") from error
    finally:
        beside.unlink(missing_ok=True)


def write_film(path: Path | str, film: Film) -> None:
    """Write a film's radiance (R, G, B), its standard error (error.R ...) and the finite samples of each pixel (samples).

    Pixels with non-finite samples are NaN; the standard error is NaN everywhere after a single replicate.
    """
    moments = film.moments
    error = moments.standard_error
    channels = {name: moments.mean[..., c] for c, name in enumerate("RGB")}
    channels |= {f"error.{name}": error[..., c] for c, name in enumerate("RGB")}
    write_exr(path, channels | {"samples": moments.n * film.samples - film.nonfinite})


def read_exr(path: Path | str) -> dict[str, np.ndarray]:
    """Channels of an image file, name -> (height, width) float32 array, row 0 on top; EtalonError where it cannot be read."""
    file = OpenImageIO.ImageInput.open(str(path))
    if file is None:
        raise _failure(path, file, "cannot be read", "check the path, or write it again")
    try:
        names = file.spec().channelnames
        pixels = file.read_image(0, 0, 0, len(names), "float")
    finally:
        file.close()
    if pixels is None:
        raise _failure(path, file, "cannot be read", "write it again")
    return {name: np.ascontiguousarray(pixels[..., i]) for i, name in enumerate(names)}


def _failure(path: Path | str, file: object, what: str, remedy: str) -> EtalonError:
    reason = (file.geterror() if file is not None else OpenImageIO.geterror()).strip().splitlines()
    return EtalonError(f"{path}: {what} ({reason[0] if reason else 'no reason given'}); {remedy}")
