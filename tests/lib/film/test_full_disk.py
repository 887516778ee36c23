# SPDX-License-Identifier: GPL-3.0-or-later
"""Images on a full disk: one line, and the image that was there before.

OpenImageIO itself reports success.
"""

import contextlib
import subprocess
import sys
import zlib

import numpy as np
import OpenImageIO
import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.files.atomic import replace_files
from etalon.lib.film import exr
from etalon.lib.film.exr import RADIANCE, read_exr, write_exr
from etalon.lib.film.pictures import is_whole_png, write_png

SIZES = range(4, 304, 15)  # KiB


@pytest.fixture
def images(rng):
    """Three float channels, and the pixels of a picture."""
    return {name: rng.random((100, 120)) for name in "RGB"}, rng.integers(0, 256, (100, 120, 3)).astype(np.uint8)


def write(folder, images):
    """Two images as results."""
    with replace_files(folder) as beside:
        write_exr(beside / "a.exr", images[0], RADIANCE)
        write_png(beside / "a.png", images[1])


def cut(monkeypatch, share):
    """Have image files end after a share of their bytes once they are closed.

    There is no error, as on a full disk.
    """
    create = OpenImageIO.ImageOutput.create

    class Output:
        def __init__(self, path):
            self.path, self.file = path, create(path)

        def __getattr__(self, name):
            return getattr(self.file, name)

        def close(self):
            good = self.file.close()
            with open(self.path, "rb+") as file:
                file.truncate(int(share * file.seek(0, 2)))
            return good

    class Module:
        ImageOutput = type("ImageOutput", (), {"create": staticmethod(Output)})

        def __getattr__(self, name):
            return getattr(OpenImageIO, name)

    monkeypatch.setattr(exr, "OpenImageIO", Module())
    monkeypatch.setattr("etalon.lib.film.pictures.OpenImageIO", Module())


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.9, 0.999])
def test_a_float_image_that_is_cut_short_is_an_error(tmp_path, monkeypatch, images, share):
    cut(monkeypatch, share)
    with pytest.raises(EtalonError, match=r"a\.exr: cannot be written \(it does not read back"):
        write_exr(tmp_path / "a.exr", images[0], RADIANCE)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.9, 0.999])
def test_a_picture_that_is_cut_short_is_an_error(tmp_path, monkeypatch, images, share):
    cut(monkeypatch, share)
    with pytest.raises(EtalonError, match=r"a\.png: cannot be written \(it does not read back"):
        write_png(tmp_path / "a.png", images[1])


def test_a_float_image_with_other_pixels_is_an_error(tmp_path, monkeypatch, images):
    monkeypatch.setattr(exr, "_checksum", lambda path, names: zlib.crc32(b""))
    with pytest.raises(EtalonError, match="does not read back"):
        write_exr(tmp_path / "a.exr", images[0], RADIANCE)


def test_a_picture_with_a_changed_byte_is_not_whole(tmp_path, images):
    write_png(tmp_path / "a.png", images[1])
    content = (tmp_path / "a.png").read_bytes()
    assert is_whole_png(content)
    assert not is_whole_png(content[:1000] + b"?" + content[1001:])


@contextlib.contextmanager
def small_disk(folder, kib):
    """A file system of that size in `folder`; skips where this user may not make one."""
    if not sys.platform.startswith("linux"):
        pytest.skip("tmpfs is Linux's")
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kib}k", "tmpfs", str(folder)], capture_output=True)
    if made.returncode:
        pytest.skip("mounting a file system needs root")
    try:
        yield folder
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def test_twenty_sizes_of_disk_hold_both_images_or_none(tmp_path, images):
    held = []
    for kib in SIZES:
        with small_disk(tmp_path, kib) as disk:
            said = ""
            try:
                write(disk / "out", images)
            except EtalonError as error:
                said = str(error)
            held.append(not said)
            if said:
                assert "make room" in said
                assert ".unfinished" not in said
                assert list(disk.iterdir()) == []
            else:
                np.testing.assert_array_equal(read_exr(disk / "out" / "a.exr")["G"], images[0]["G"].astype(np.float32))
    assert held == sorted(held)
    assert {False, True} == set(held)
    assert len(held) == 20
