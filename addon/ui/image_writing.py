# SPDX-License-Identifier: GPL-3.0-or-later
"""The images that Image editors show.

Threads write them, and Blender loads them when they are ready.
"""

from __future__ import annotations

import threading
from pathlib import Path

import bpy

from ...lib.comparison.compare import Comparison
from ...lib.comparison.interim import Interim
from ...lib.errors import EtalonError
from ...lib.film.parts import Part
from ...lib.report.views import View, write_interim, write_views

LABELS = {
    View.REFERENCE: "Reference",
    View.CYCLES: "Cycles",
    View.DIFFERENCE: "Difference",
    View.SIGNIFICANCE: "Significance",
    View.VERDICT: "Verdict",
}
_MARK = "etalon_view"


class Writer:
    """Writes the images of one comparison into `folder`, in threads.

    `count` grows when they have changed. `error` says why they could not be written the last time; it is empty where
    they could. `part` is the part of the light that the next images show; None: all of it.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.part: Part | None = None
        self.count = 0
        self.error = ""
        self._thread: threading.Thread | None = None

    @property
    def is_busy(self) -> bool:
        """Whether images are being written."""
        return self._thread is not None and self._thread.is_alive()

    def write(self, comparison: Comparison) -> None:
        """Start to write all images of a comparison that is concluded."""
        self._thread = threading.Thread(
            target=self._write, args=(comparison, self.part), name="etalon images", daemon=True
        )
        self._thread.start()

    def write_interim(self, interim: Interim) -> None:
        """Write the images as they are now; called by the thread of the job."""
        self.error = ""
        try:
            write_interim(interim, self.folder, self.part)
        except (EtalonError, OSError) as error:
            self.error = str(error)
        self.count += 1

    def _write(self, comparison: Comparison, part: Part | None) -> None:
        self.error = ""
        try:
            write_views(comparison, self.folder, part)
        except (EtalonError, OSError) as error:
            self.error = str(error)
        self.count += 1


def image_of(view: View) -> bpy.types.Image | None:
    """Blender's image of a view, if there is one in this file."""
    return next((image for image in bpy.data.images if image.get(_MARK) == view.name), None)


def view_of(image: bpy.types.Image | None) -> View | None:
    """The view that an image shows; None for other images."""
    name = image.get(_MARK) if image is not None else None
    return View[name] if name in View.__members__ else None


def load_view(view: View, folder: Path) -> bpy.types.Image | None:
    """The image of a view, loaded from `folder`, or loaded again.

    None where it has no file yet.
    """
    path = folder / view.value
    if not path.is_file():
        return None
    image = image_of(view)
    if image is None:
        image = bpy.data.images.load(str(path))
        image.name, image[_MARK] = f"Étalon {LABELS[view]}", view.name
    elif bpy.path.abspath(image.filepath) != str(path):
        image.filepath = str(path)
    image.colorspace_settings.name = "Linear Rec.709"
    image.reload()
    return image


def reload_views(folder: Path) -> None:
    """Load again the images that are in use, whose files have changed."""
    for view in View:
        if image_of(view) is not None:
            load_view(view, folder)
